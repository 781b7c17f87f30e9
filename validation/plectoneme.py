"""A rod under a pull that is twisted by its end: it throws a loop, which rests on itself and winds up to a plectoneme.

Clauvelin, Audoly & Neukirch, Biophys. J. 96 (2009) 3716: of two strands of bending stiffness B and radius R, wound at
the superhelical angle x,

    F R^2 / B = sin^3 x (cos x tan 2x - sin x / 2),    M = (2 / sin 2x) (B sin^4 x / (2 R) + R F).

The rod is followed through states at rest, from straight on; its contact has no constants. While the plectoneme grows
its moment stays the same.
"""

from __future__ import annotations

from math import cos, pi, radians, sin, tan

import numpy as np

from solver import Condition, Contact, Curve, End, Frame, Initial, Numerics, PointLoad, Rod, Scene, simulate
from solver.scene.ends import FIXED
from validation.row import Row, at_most, relative

LENGTH, E, G, DENSITY = 1.0, 1e7, 5e6, 1500.0
PLECTONEMES = {15.0: (80, 96), 20.0: (60, 96), 25.0: (40, 75)}
"""Of superhelical angles (degrees) the rod's length over its diameter and the intervals: the steeper it is wound, the
shorter are its end loop and its turns."""
GROWN = (0.5, 0.65)
"""By what part of the rod's length its ends have come together while the moment is taken."""
AIM, SECONDS = 0.01, 10.0


def at_rest(x: float, R: float, B: float) -> tuple[float, float]:
    """The pull (N) and the moment (N m) of the plectoneme."""
    F = B / R**2 * sin(x) ** 3 * (cos(x) * tan(2 * x) - 0.5 * sin(x))
    return F, 2.0 / sin(2 * x) * (B * sin(x) ** 4 / (2 * R) + R * F)


def scene(pull: float, B: float, slender: int, intervals: int) -> Scene:
    """The end is turned on and on under the pull; a small force on the middle says where the rod gives way."""
    axial = (Condition("load", Curve.constant(pull)),)
    turned = (Condition("position", Curve.table([0.0, 6.0], [0.0, 72.0 * pi])),)
    none = Curve.constant(0.0)
    return Scene(
        rod=Rod.circular(LENGTH, LENGTH / slender, E, G, DENSITY), initial=Initial.straight(direction=(0.0, 0.0, 1.0)),
        start=End.clamp(), end=End((FIXED, FIXED, axial), (FIXED, FIXED, turned), frame="lab"), t_end=6.0,
        output_interval=.1, points=(PointLoad(0.5 * LENGTH, (Curve.constant(0.3 * B / LENGTH**2), none, none)),),
        numerics=Numerics(intervals=intervals), contact=Contact(), analysis="static",
    )  # fmt: skip


def rows() -> list[Row]:
    """The moment of the growing plectoneme, and that nothing passed through anything on the way."""
    rows = []
    for angle, (slender, intervals) in PLECTONEMES.items():
        B = E * pi * (LENGTH / slender) ** 4 / 64
        F, M = at_rest(radians(angle), 0.5 * LENGTH / slender, B)
        moments, jumps = [], []
        run = simulate(scene(F, B, slender, intervals))
        for frame in run:
            jumps.append(abs(frame.Tw + frame.Wr - frame.Lk))
            together = _together(frame)
            if together > GROWN[1] and frame.contacts:
                break
            if together > GROWN[0] and frame.contacts:
                moments.append(abs(float(frame.q[1, 2])))
        name = f"plectoneme at {angle:g} degrees, N={intervals}"
        rows.append(relative(f"{name}: moment", float(np.mean(moments)), M, AIM))
        rows.append(at_most(f"{name}: |Tw+Wr-Lk| on the way", max(jumps), 1e-6))
        rows.append(at_most(f"{name}: CPU s", run.statistics.cpu_time, SECONDS))
    return rows


def _together(frame: Frame) -> float:
    """By what part of the rod's length its ends have come together."""
    return 1.0 - float(np.linalg.norm(frame.r[-1] - frame.r[0])) / LENGTH
