"""The twist at which a ring leaves its plane: sqrt(3) EJ / GJ turns (Michell 1889; Zajac 1962).

A straight rod is twisted and bent to a circle whose ends meet in one clamp, which takes away no more than the ring's
rigid motions. Its static response to a small force across its plane grows like 1 / (Tw_c - Tw) and changes sign
at Tw_c.
"""

from __future__ import annotations

from math import nan, pi, sqrt

import numpy as np
from scipy.interpolate import CubicSpline

from solver import Curve, DistributedLoad, End, Initial, Numerics, Scene
from solver.arrays import Array
from solver.methods.box import BoxMethod
from solver.methods.time.generalized_alpha.newton import CONVERGED
from validation.rods import EJ, GJ, LENGTH, rod_R
from validation.row import Row, observed_order, relative

CRITICAL = sqrt(3.0) * EJ / GJ
STATIC = 1e9
"""A step (s) so long that inertia is below rounding."""
FORCE = 1e-7
"""In EJ / L^3."""
AROUND = (-0.015, -0.01, -0.005, 0.005, 0.01, 0.015)
"""turns from the critical twist, where Newton's iteration still finds the ring at rest near its plane."""
MESHES = (200, 400)
"""At 100 intervals the two unstable shapes, cos and sin, still differ and mix."""


def circle(s: Array) -> Array:
    """A closed circle in the e1-e3 plane that starts along e3."""
    angle, radius = 2 * pi * s / LENGTH, LENGTH / (2 * pi)
    return np.stack([radius * (1.0 - np.cos(angle)), np.zeros_like(s), radius * np.sin(angle)], axis=1)


def wave(s: Array) -> Array:
    """The shape across the plane in which the ring goes unstable: two waves round it."""
    return np.asarray(np.cos(4 * pi * s / LENGTH), dtype=float)


def deflection(turns: float, intervals: int, force: float) -> float:
    """The wave's part (m) in how far the ring leaves its plane, at rest under `force` (N/m) across it in that shape."""
    zero, twist = Curve.constant(0.0), Curve.table([0.0, LENGTH], [0.0, 2 * pi * turns])
    load = DistributedLoad(force=(zero, lambda s: force * wave(s), zero))
    scene = Scene(
        rod=rod_R(), initial=Initial(circle, twist=twist), start=End.clamp(), end=End.clamp(), t_end=STATIC,
        output_interval=STATIC, distributed=(load,), numerics=Numerics(intervals=intervals, dt_max=STATIC),
        topology=False,
    )  # fmt: skip
    method = BoxMethod(scene)
    status, _ = method.try_step(0.0, STATIC)
    if status != CONVERGED:
        return nan
    return float(np.mean(wave(method.s) * method.trial.r[:, 1]))


def stiffness(turns: float, intervals: int) -> float:
    """Force (in EJ / L^3) over deflection (in L): zero at the critical twist."""
    force = FORCE * EJ / LENGTH**3
    pushed, pulled = deflection(turns, intervals, force), deflection(turns, intervals, -force)
    return 2.0 * FORCE * LENGTH / (pushed - pulled)


def critical_twist(intervals: int) -> float:
    """Turns at which the ring of so many intervals leaves its plane."""
    twists = [CRITICAL + turns for turns in AROUND]
    (root,) = CubicSpline(twists, [stiffness(turns, intervals) for turns in twists]).roots(extrapolate=False)
    return float(root)


def rows() -> list[Row]:
    """The critical twist extrapolated from two meshes, and its order."""
    coarse, fine = (critical_twist(n) for n in MESHES)
    return [
        observed_order("ring order in ds", abs(coarse - CRITICAL), abs(fine - CRITICAL)),
        relative("ring critical twist, turns, extrapolated", (4 * fine - coarse) / 3, CRITICAL, 1e-6),
    ]
