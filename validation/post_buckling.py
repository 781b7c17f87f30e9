"""A twisted rod between clamps on one axis that has buckled, without axial force: its states at given end distances.

The path is subcritical (Lk falls as z falls), so a rod that is free to slide snaps. Here the ends are held at
a distance z and turned by Lk, each by half of it, so that the rod stays symmetric and does not swing about the axis;
damping brings it to rest, and Lk is sought at which the axial force is zero.
Values for rod R from at least two independent methods, to 2e-8: rod_benchmarks.json.
"""

from __future__ import annotations

import json
from math import pi
from pathlib import Path
from typing import Any

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.optimize import brentq, root_scalar
from scipy.special import j0

from solver import Curve, Frame, Initial, Scene, simulate
from solver.arrays import Array
from validation.rods import LENGTH, driven_clamp, fixed_steps, rod_R
from validation.row import Row, against, observed_order

REFERENCE: dict[str, Any] = json.loads((Path(__file__).parent / "data" / "rod_benchmarks.json").read_text())[
    "clamped_clamped_post_buckling"
]
TURNED, REST = 10.0, 20.0
"""s: the ends are turned within 10 s; 10 s more at a damping of 4 / s leave 1e-9 of the motion."""
STEPS_PER_INTERVAL = 8
"""Steps and intervals are refined together: kappa, integrated in time, keeps an error of order dt^2 at rest."""
MESHES = (40, 80, 160)
LARGEST_ERRORS = 0.5
"""The z / L at which the rod is bent most: there the order shows."""
SOMEWHERE = 1.3
"""turns, where the search for Lk begins."""
QUANTITIES = ("Lk", "Tw", "Wr", "midspan_offset_over_L")


def bent(z: float) -> Initial:
    """A rod in the e1-e3 plane whose ends lie on e3, z L apart, with tangents along e3: its angle is A sin 2 pi s / L.

    z = J_0(A), since that is the mean of cos(A sin x).
    """
    amplitude = brentq(lambda A: j0(A) - z, 0.0, 2.4, xtol=1e-15)
    fine = np.linspace(0.0, LENGTH, 2001)
    angle = amplitude * np.sin(2 * pi * fine / LENGTH)
    across, along = (CubicSpline(fine, f(angle)).antiderivative() for f in (np.sin, np.cos))

    def centreline(s: Array) -> Array:
        return np.stack([across(s), np.zeros_like(s), along(s)], axis=1)

    return Initial(centreline=centreline)


def at_rest(z: float, Lk: float, intervals: int) -> Frame:
    """The rod at rest with its ends z L apart and turned by Lk."""
    ends = []
    for turn in (-pi * Lk, pi * Lk):
        angle = Curve.table([0.0, TURNED], [0.0, turn], "smoothstep")
        ends.append(driven_clamp(Curve.constant(0.0), angle))
    dt = REST / (STEPS_PER_INTERVAL * intervals)
    scene = Scene(
        rod=rod_R(), initial=bent(z), start=ends[0], end=ends[1], t_end=REST, output_interval=REST, damping=4.0,
        numerics=fixed_steps(intervals, dt, rho_inf=0.5),
    )  # fmt: skip
    *_, last = simulate(scene)
    return last


def without_thrust(z: float, intervals: int, near: float) -> dict[str, float]:
    """The state of a rod of so many intervals at end distance z L whose axial force is zero, its Lk sought `near`."""
    frames: dict[float, Frame] = {}

    def thrust(Lk: float) -> float:
        frames[Lk] = at_rest(z, Lk, intervals)
        return float(frames[Lk].f[-1, 2])

    Lk = root_scalar(thrust, x0=near, x1=near + 1e-3, xtol=1e-9, method="secant").root
    frame = frames.get(Lk) or at_rest(z, Lk, intervals)
    offset = float(np.hypot(*frame.r[intervals // 2, :2])) / LENGTH
    return dict(zip(QUANTITIES, (Lk, frame.Tw, frame.Wr, offset), strict=True))


def rows() -> list[Row]:
    """Each quantity extrapolated twice, from three meshes, to 1e-6, and its order where its error is largest."""
    table = []
    for i, z in enumerate(REFERENCE["z_L"]):
        states: list[dict[str, float]] = []
        for n in MESHES:
            states.append(without_thrust(z, n, states[-1]["Lk"] if states else SOMEWHERE))
        for name in QUANTITIES:
            reference, label = REFERENCE[name][i], f"post-buckling z/L={z:g} {name}"
            coarse, middle, fine = (state[name] for state in states)
            once = (4 * middle - coarse) / 3, (4 * fine - middle) / 3
            table.append(against(f"{label}, extrapolated", (16 * once[1] - once[0]) / 15, reference, 1e-6))
            if z == LARGEST_ERRORS:
                table.append(observed_order(f"{label}, order", abs(middle - reference), abs(fine - reference)))
    return table
