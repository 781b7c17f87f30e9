"""A run's frames as rows of numbers, which a checkpoint can hold, and back."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from math import isnan
from typing import Any, NamedTuple

import numpy as np

from solver.arrays import Array
from solver.measures.frame import OUTPUTS, Frame

ALONG = tuple(output for output in OUTPUTS if output.along_rod)
NUMBERS = tuple(output for output in OUTPUTS if not output.along_rod)
WIDTH = sum(output.components for output in ALONG)
"""Numbers per node."""


class Columns(NamedTuple):
    """The outputs of frames: `along` (..., nodes, components), `numbers` (..., 1, outputs)."""

    along: Array
    numbers: Array


@cache
def column(name: str) -> slice:
    """Where the components of an output along the rod stand."""
    before = [output.name for output in ALONG].index(name)
    at = sum(output.components for output in ALONG[:before])
    return slice(at, at + ALONG[before].components)


def number(name: str) -> int:
    """Which of `NUMBERS` an output is."""
    return [output.name for output in NUMBERS].index(name)


R, KAPPA, ORIENTATION = column("r"), column("kappa"), column("orientation")
JUDGED = [*range(R.start, R.stop), *range(KAPPA.start, KAPPA.stop)]
"""The components along the rod that a tolerance is for: of r, then of kappa."""
JUDGED_R, JUDGED_KAPPA = slice(0, 3), slice(3, 6)
"""Where they stand among these."""
OMEGA, FORCE, MOMENT = column("omega"), column("f"), column("q")
TWIST, WRITHE = number("Tw"), number("Wr")
BALANCE, ASTRAY, DISSIPATION = number("energy_balance"), number("astray"), number("dissipation")
CURVATURE, STEP = number("max_curvature"), number("dt")
BENDING, TORSION, STRETCHING = (number(f"energy_{name}") for name in ("bending", "torsion", "stretching"))
KINETIC, ADDED_MASS = number("energy_kinetic"), number("energy_added_mass")


def row_of(frame: Frame) -> Array:
    """The time, the numbers and the outputs along the rod of a frame, one after the other."""
    numbers = [frame.t, *(float(getattr(frame, output.name)) for output in NUMBERS)]
    fields = [getattr(frame, output.name) for output in ALONG]
    along = np.concatenate([field.reshape(len(field), -1) for field in fields], axis=1)
    return np.concatenate([numbers, along.ravel()])


def number_of(row: Array, index: int) -> float:
    """The output that is number `index` of `NUMBERS`."""
    return float(row[1 + index])


def along_of(rows: Array) -> Array:
    """The outputs along the rod of many frames (frames, nodes, columns), not copied."""
    return rows[:, 1 + len(NUMBERS) :].reshape(len(rows), -1, WIDTH)


def columns_of(rows: Sequence[Array] | Array, judged: bool) -> Columns:
    """The outputs of many frames (frames, ...), copied: all, or of those along the rod the `JUDGED` components."""
    table, end = np.asarray(rows), 1 + len(NUMBERS)
    along = along_of(table)
    return Columns(along[..., JUDGED] if judged else along.copy(), table[:, None, 1:end].copy())


def frame_of(t: float, columns: Columns) -> Frame:
    """The frame at time `t` (s) of the outputs of one."""
    values: dict[str, Any] = {}
    for output, stored in zip(NUMBERS, columns.numbers[0], strict=True):
        value = float(stored)
        values[output.name] = (0 if isnan(value) else int(value)) if output.type == "i4" else value
    for output in ALONG:
        field = columns.along[:, column(output.name)]
        values[output.name] = np.ascontiguousarray(field if output.axes else field[:, 0])
    return Frame(t=t, **values)
