"""A straight rod between two clamps that are brought together: after it has buckled, its deflection is the elastica's.

Four quarters of the elastica with modulus k: the clamps come together by 2 L (1 - E/K), the middle goes aside by k L/K,
the force is 16 K^2 EJ/L^2 (Love 1927, art. 263). The rod is compressed too, by the force over EA/L.
"""

from __future__ import annotations

from dataclasses import replace
from math import sqrt

import numpy as np
from scipy.optimize import brentq
from scipy.special import ellipe, ellipk

from solver import Condition, Curve, End, Initial, Numerics, PointLoad, Rod, Scene, simulate
from solver.scene.ends import FIXED
from validation.row import Row, at_most

LENGTH, DIAMETER, E, DENSITY = 1.0, 0.01, 2e9, 1150.0
EJ, EA = E * np.pi * DIAMETER**4 / 64.0, E * np.pi * DIAMETER**2 / 4.0
BROUGHT = (0.05, 0.2, 0.4)
"""By how much the clamps have come together, in rod lengths."""
AIM = 1e-4
"""Of the deflection, in rod lengths."""


def elastica(brought: float) -> tuple[float, float]:
    """Deflection of the middle (m) and force (N) where the clamps have come together by `brought` (m)."""

    def missing(k: float) -> float:
        K, E_k = ellipk(k * k), ellipe(k * k)
        return float(2.0 * LENGTH * (1.0 - E_k / K) + 16.0 * K * K * EJ / LENGTH**2 * LENGTH / EA - brought)

    k = float(brentq(missing, 1e-6, 0.95, xtol=1e-14))
    K = float(ellipk(k * k))
    return k * LENGTH / K, 16.0 * K * K * EJ / LENGTH**2


def scene(seed: float) -> Scene:
    """One clamp comes nearer, and rests at each of `BROUGHT`; `seed` (EJ/L^2): a force on the middle at first."""
    period = 2.0 * np.pi / (22.4 * sqrt(EJ / (DENSITY * np.pi / 4.0 * DIAMETER**2)) / LENGTH**2)
    stops = [0.0, *(x for b in BROUGHT for x in (-b * LENGTH, -b * LENGTH))]
    times = np.cumsum([0.0, *(30.0 * period for _ in stops[1:])])
    moved = Condition("position", Curve.table(times, stops, "smoothstep"))
    nudge = Curve.table([0.0, 25.0 * period, 35.0 * period], [seed * EJ / LENGTH**2] * 2 + [0.0], "smoothstep")
    none = Curve.constant(0.0)
    return Scene(
        rod=Rod.circular(LENGTH, DIAMETER, E, E / 2.6, DENSITY), initial=Initial.straight(), start=End.clamp(),
        end=End((FIXED, FIXED, (moved,)), (FIXED, FIXED, FIXED)), t_end=float(times[-1]),
        output_interval=30.0 * period, damping=2.0 / period,
        points=(PointLoad(0.5 * LENGTH, (nudge, none, none)),), topology=False,
        numerics=Numerics(method="staggered", tolerance=1e-4),
    )  # fmt: skip


def rows() -> list[Row]:
    """By motion, damped, from a seed, and by statics."""
    moving = scene(0.1)
    still = replace(moving, analysis="static", numerics=Numerics(intervals=200, verify=True))
    table = []
    for label, problem in (("dynamic", moving), ("static", still)):
        frames = list(simulate(problem))
        for brought, frame in zip(BROUGHT, frames[2::2], strict=True):
            middle = float(np.abs(frame.r[len(frame.r) // 2, 0]))
            error = abs(middle - elastica(brought * LENGTH)[0]) / LENGTH
            table.append(at_most(f"Euler {label}, clamps {brought:g} L nearer: deflection off", error, AIM))
            force = float(-frame.f[len(frame.f) // 2] @ [0.0, 0.0, 1.0])
            off = abs(force / elastica(brought * LENGTH)[1] - 1.0)
            table.append(at_most(f"Euler {label}, clamps {brought:g} L nearer: force off", off, 1e-3))
    return table
