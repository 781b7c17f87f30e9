"""Equilibria without time: the elastica, the torque at which stability is lost, an arch through both its folds."""

from __future__ import annotations

from dataclasses import replace
from math import atan2

import numpy as np

from solver import FIXED, Condition, Curve, End, Frame, Initial, Numerics, PointLoad, Scene, simulate
from solver.arrays import Array
from solver.kernels.rotation import rotate
from validation.elastica import ALPHAS, NAMES, TABLE, exact
from validation.greenhill import CRITICAL
from validation.rods import EJ, GJ, LENGTH, rod_R
from validation.row import Row, against, at_most, observed_order

ZERO = Curve.constant(0.0)
RISE = 0.6
"""Angle (rad) through which half the arch turns."""
FOLDED = 10.0
"""How far the arch's load (EJ/L^2) travels, to and fro."""


def _static(intervals: int, **changes: object) -> Scene:
    fields = {"rod": rod_R(), "initial": Initial.straight(), "start": End.clamp(), "end": End.free(), "t_end": 1.0,
              "output_interval": 1.0, "topology": False, "analysis": "static"} | changes  # fmt: skip
    return Scene(numerics=Numerics(intervals=intervals), **fields)  # type: ignore[arg-type]


def elastica(alpha: float, intervals: int) -> tuple[float, float, float]:
    """w/L, u/L and tip angle of a cantilever under a dead load across its tip."""
    load = Curve.table([0.0, 1.0], [0.0, alpha * EJ / LENGTH**2])
    *_, last = simulate(_static(intervals, points=(PointLoad(LENGTH, force=(load, ZERO, ZERO)),)))
    tangent = rotate(last.orientation[-1:], np.array([[0.0, 0.0, 1.0]]))[0]
    return last.r[-1, 0] / LENGTH, 1.0 - last.r[-1, 2] / LENGTH, atan2(tangent[0], tangent[2])


def falling(torque: float, intervals: int) -> int:
    """Negative modes of the straight rod twisted between clamps by a torque (EJ/L), without thrust."""
    initial = Initial.straight(twist=Curve.table([0.0, LENGTH], [0.0, torque * EJ / GJ]))
    return next(iter(simulate(_static(intervals, initial=initial, end=End.slider())))).negative_modes


def critical_torque(intervals: int) -> float:
    """M L / EJ at which the straight rod is no more stable, by bisection."""
    stable, unstable = 8.9, 9.1
    while unstable - stable > 1e-9:
        middle = 0.5 * (stable + unstable)
        stable, unstable = (stable, middle) if falling(middle, intervals) else (middle, unstable)
    return middle


def arch(condition: Condition) -> list[Frame]:
    """Half an arch, free of stress, whose crown is pressed down along e1 and does not turn."""

    def centreline(s: Array) -> Array:
        angle, radius = RISE * (1.0 - s / LENGTH), LENGTH / RISE
        return radius * np.column_stack([np.cos(angle) - np.cos(RISE), 0.0 * s, np.sin(RISE) - np.sin(angle)])

    crown = End(((condition,), FIXED, FIXED), (FIXED, FIXED, FIXED), frame="lab")
    rod = replace(rod_R(), kappa0=(ZERO, Curve.constant(-RISE / LENGTH), ZERO))
    return list(simulate(_static(60, rod=rod, initial=Initial(centreline), end=crown, t_end=FOLDED,
                                 output_interval=FOLDED / 100)))  # fmt: skip


def _arch_rows() -> list[Row]:
    """Under a given load the arch must pass its folds, on the branch on which its displacement is given."""
    loaded = arch(Condition("load", Curve.table([0.0, FOLDED], [0.0, -FOLDED * EJ / LENGTH**2])))
    start = arch(Condition("rate"))[0].r[-1, 0]
    times = [frame.t for frame in loaded]
    crown = Curve.table(times, [0.0, *(frame.r[-1, 0] - start for frame in loaded[1:])])
    driven = arch(Condition("position", crown))
    force = [-rotate(frame.orientation, frame.f)[-1, 0] / (EJ / LENGTH**2) for frame in driven]
    pairs = list(zip(loaded, driven, force, strict=True))[1:]
    load = np.array([frame.parameter for frame in loaded])
    unstable = [frame.negative_modes for frame in loaded]
    back = np.count_nonzero(np.diff(load) < 0.0)
    apart = max(np.abs(a.r - b.r).max() for a, b, _ in pairs)
    return [
        at_most("arch, load given or displacement given: place", apart, 1e-9),
        at_most("arch, load given or displacement given: load", max(abs(a.parameter - f) for a, _, f in pairs), 1e-8),
        against("arch, frames on the way back that are unstable", np.count_nonzero(unstable), back, 1.0),
        against("arch, negative modes under a given displacement", max(f.negative_modes for f in driven), 0.0, 0.0),
    ]


def rows() -> list[Row]:
    """The table of solver.md 6 by statics: orders, six digits by extrapolation, and the folds."""
    table = []
    for alpha in ALPHAS:
        runs, reference = {n: elastica(alpha, n) for n in (50, 100, 200)}, exact(alpha)
        for i, name in enumerate(NAMES):
            label = f"static elastica alpha={alpha:g} {name}"
            limit = (4 * runs[200][i] - runs[100][i]) / 3
            table.append(against(f"{label}, extrapolated", limit, TABLE[alpha][i], 1e-6))
            errors = [abs(runs[n][i] - reference[i]) for n in (50, 100, 200)]
            for n, coarse, fine in zip((50, 100), errors, errors[1:], strict=False):
                table.append(observed_order(f"{label}, order N={n}/{2 * n}", coarse, fine))
    coarse, fine = critical_torque(80), critical_torque(160)
    table += [
        against("stability is lost at M L/EJ, N=160", fine, CRITICAL, 1e-4 * CRITICAL),
        observed_order("its order in ds", abs(coarse - CRITICAL), abs(fine - CRITICAL)),
        against("stability is lost at M L/EJ, extrapolated", (4 * fine - coarse) / 3, CRITICAL, 1e-6),
    ]
    return table + _arch_rows()
