"""Elimination within the band, with row pivoting, as LAPACK's gbtrf does it: what the other linear solvers are checked
by. It knows nothing of intervals, searches each column for its pivot, and costs several times as much."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from solver.arrays import Array
from solver.kernels.dispatch import variant
from solver.kernels.kernel import inner, kernel
from solver.kernels.scratch import scratch
from solver.methods.linear.panels import Swaps
from solver.methods.linear.system import System, factor, solve
from solver.methods.space.box.fields import Nodes
from solver.methods.space.box.intervals import MEANS, interval_panel
from solver.methods.space.box.schemes import BOX
from solver.methods.status import CONVERGED, SINGULAR

REACH = 17
"""Diagonals below the main one, and above it: row 6 + 12 j of an interval has the columns 12 j to 12 j + 23."""


class Banded(NamedTuple):
    """`band` (12 n, 3 REACH + 1): the matrix and its factors, row r and column c at [r, c - r + REACH], with room for
    what row exchanges fill in; `swaps` (12 n,) says where each pivot came from. Scratch: `y` (12 n,)."""

    band: Array
    swaps: Swaps
    y: Array

    @classmethod
    def empty(cls, intervals: int) -> Banded:
        """Zeros for a rod of `intervals` intervals."""
        size = 12 * (intervals + 1)
        return cls(np.zeros((size, 3 * REACH + 1)), np.zeros(size, np.int64), np.zeros(size))


@inner
def _enter(block: Array, row: int, column: int, band: Array) -> None:
    """Write a block of the matrix, whose first entry stands at (row, column)."""
    rows, columns = block.shape
    for i in range(rows):
        for k in range(columns):
            band[row + i, column + k - row - i + REACH] = block[i, k]


@variant(factor, Banded)
@kernel
def factor_band(linear: Banded, Y: Array, past: Array, c0: float, h: float, nodes: Nodes,
                system: System) -> int:  # fmt: skip
    """Form the matrix and factor it."""
    band, N = linear.band, len(system.b)
    panel, mean = scratch((12, 24)), scratch((MEANS, 3))
    band[:, :] = 0.0
    _enter(system.start, 0, 0, band)
    for j in range(N):
        interval_panel(j, Y, c0, h, BOX, nodes, system.rows, system.columns, mean, panel, 0)
        _enter(panel, 6 + 12 * j, 12 * j, band)
    _enter(system.end, 6 + 12 * N, 12 * N, band)
    return CONVERGED if _eliminate(band, linear.swaps) else SINGULAR


@inner
def _eliminate(band: Array, swaps: Swaps) -> bool:
    """Factor in place; False if a column has no pivot."""
    size = len(band)
    for k in range(size):
        below, right = min(k + REACH + 1, size), min(k + 2 * REACH + 1, size)
        pivot = k
        for i in range(k + 1, below):
            if abs(band[i, k - i + REACH]) > abs(band[pivot, k - pivot + REACH]):
                pivot = i
        if not abs(band[pivot, k - pivot + REACH]) > 0.0:
            return False
        swaps[k] = pivot
        for c in range(k, right):
            one, other = band[k, c - k + REACH], band[pivot, c - pivot + REACH]
            band[k, c - k + REACH], band[pivot, c - pivot + REACH] = other, one
        for i in range(k + 1, below):
            multiplier = band[i, k - i + REACH] / band[k, REACH]
            band[i, k - i + REACH] = multiplier
            for c in range(k + 1, right):
                band[i, c - i + REACH] -= multiplier * band[k, c - k + REACH]
    return True


@variant(solve, Banded)
@kernel
def solve_band(linear: Banded, system: System, scale: float, b: Array, x: Array) -> None:
    """Forward and backward through the rows."""
    band, y, size = linear.band, linear.y, len(linear.y)
    for i in range(6):
        y[i], y[size - 6 + i] = scale * system.b_start[i], scale * system.b_end[i]
    for j in range(len(b)):
        for k in range(12):
            y[6 + 12 * j + k] = b[j, k]
    for k in range(size):
        pivot = linear.swaps[k]
        y[k], y[pivot] = y[pivot], y[k]
        for i in range(k + 1, min(k + REACH + 1, size)):
            y[i] -= band[i, k - i + REACH] * y[k]
    for k in range(size - 1, -1, -1):
        for c in range(k + 1, min(k + 2 * REACH + 1, size)):
            y[k] -= band[k, c - k + REACH] * y[c]
        y[k] /= band[k, REACH]
    for j in range(len(x)):
        for k in range(12):
            x[j, k] = y[12 * j + k]
