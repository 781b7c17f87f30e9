"""When the paper's cable buckles, loops and touches itself, beside what the paper says."""

from __future__ import annotations

import json
from math import isnan, nan

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from service.cases import parse_case

Array = NDArray[np.float64]

CONTACT_DISTANCE = 6e-3
"""Strands nearer than this (centreline to surface, m) have met: the contact law's force is felt there."""

BENT_FRACTION = 0.02
"""The share of bending in the strain energy from which the cable counts as buckled."""


def milestones(dataset: xr.Dataset) -> list[tuple[str, float, float]]:
    """Name, value in this run (NaN if not reached) and the paper's value, of each milestone.

    Times in s, found on cubic splines through the frames.
    """
    t = dataset.time.values
    if len(t) < 4:
        raise ValueError(f"milestones need a dataset of 4 frames or more, got {len(t)}")
    bending, torsion = dataset.energy_bending.values, dataset.energy_torsion.values
    share = bending / np.maximum(bending + torsion, np.finfo(float).tiny)
    writhe, linking = dataset.Wr.values, dataset.Lk.values
    return [
        ("buckling (s)", first_crossing(t, share, BENT_FRACTION, after=10.0), 16.0),
        ("torsional energy maximum (s)", maximum(t, torsion), 18.0),
        ("mid-span tangent perpendicular (s)", first_crossing(t, midspan_tangent(dataset), 0.0), 25.0),
        ("Wr = 1 (s)", first_crossing(t, writhe, 1.0), 29.0),
        ("first contact (s)", first_crossing(t, distance(dataset), CONTACT_DISTANCE), 29.0),
        ("Wr at 32 s (turns)", value_at(t, writhe, 32.0), 2.0),
        ("Lk at 32 s (turns)", value_at(t, linking, 32.0), 4.0),
    ]


def table(rows: list[tuple[str, float, float]]) -> str:
    """The milestones as text."""
    lines = [f"{'milestone':36}{'this run':>12}{'paper':>10}"]
    for name, value, paper in rows:
        value_text = "not reached" if isnan(value) else f"{value:.3f}"
        lines.append(f"{name:36}{value_text:>12}{paper:>10g}")
    return "\n".join(lines)


def first_crossing(t: Array, values: Array, level: float, after: float = -np.inf) -> float:
    """The first time after `after` at which the spline through the values takes the level; NaN if never."""
    known = np.isfinite(values) & (t >= after)
    if known.sum() < 4:
        return nan
    roots = CubicSpline(t[known], values[known] - level).roots(extrapolate=False)
    return float(roots[0]) if len(roots) else nan


def maximum(t: Array, values: Array) -> float:
    """The time of the largest value, NaN if it is the last one."""
    i = int(np.argmax(values))
    if i in (0, len(t) - 1):
        return nan
    around = slice(max(0, i - 2), i + 3)
    extrema = CubicSpline(t[around], values[around]).derivative().roots(extrapolate=False)
    return float(extrema[np.argmin(np.abs(extrema - t[i]))]) if len(extrema) else float(t[i])


def value_at(t: Array, values: Array, when: float) -> float:
    """The value at a time, NaN beyond the run."""
    return float(CubicSpline(t, values)(when)) if t[0] <= when <= t[-1] else nan


def midspan_tangent(dataset: xr.Dataset) -> Array:
    """The e3 component of the tangent at s = L/2, in time."""
    w, x, y, z = dataset.orientation.interp(s=float(dataset.s[-1]) / 2).values.T
    return np.asarray((w * w - x * x - y * y + z * z) / (w * w + x * x + y * y + z * z), dtype=float)


def distance(dataset: xr.Dataset) -> Array:
    """The smallest distance from a centreline to another strand's surface (m), in time."""
    rod = parse_case(json.loads(dataset.attrs["case"])).rod.build()
    radius = float(np.mean(rod.diameter(dataset.s.values))) / 2
    return np.asarray(dataset.min_gap.values + radius, dtype=float)
