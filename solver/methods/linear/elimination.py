"""Block elimination: the box scheme's system factored and solved in O(N), by condensation.py; the default."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from solver.arrays import Array
from solver.kernels.dispatch import variant
from solver.kernels.kernel import kernel
from solver.kernels.scratch import scratch, scratch_like
from solver.methods.linear.condensation import (
    LOCAL,
    WIDTH,
    backward,
    condense,
    eliminate_right,
    factor_anew,
    factor_as_before,
    forward,
    keep_multipliers,
    sweep,
)
from solver.methods.linear.panels import Swaps, close, eliminate
from solver.methods.linear.system import System, factor, solve
from solver.methods.space.box.fields import Nodes
from solver.methods.space.box.intervals import MEANS, interval_panel
from solver.methods.space.box.schemes import BOX
from solver.methods.status import CONVERGED, SINGULAR


class Elimination(NamedTuple):
    """Factors, see condensation.py: `swept` (N, 6, 3, 3), `by_swept` (N, 9, 6), `lower` (N, 72) with `swaps` (N, 6),
    `upper` (N, 96), `last` (12, 24) with `last_swaps` (12,). Scratch: `rhs` (N, 12)."""

    swept: Array
    by_swept: Array
    lower: Array
    upper: Array
    swaps: Swaps
    last: Array
    last_swaps: Swaps
    rhs: Array

    @classmethod
    def empty(cls, intervals: int) -> Elimination:
        """Zeros for a rod of `intervals` intervals."""
        N = intervals
        return cls(np.zeros((N, 6, 3, 3)), np.zeros((N, 9, 6)), np.zeros((N, 72)), np.zeros((N, 96)),
                   np.zeros((N, 6), np.int64), np.zeros((12, 24)), np.zeros(12, np.int64),
                   np.zeros((N, 12)))  # fmt: skip


@variant(factor, Elimination)
@kernel
def factor_blocks(linear: Elimination, Y: Array, past: Array, c0: float, h: float, nodes: Nodes,
                  system: System) -> int:  # fmt: skip
    """Factor the system, making each panel when its turn comes."""
    # made here, so that the compiler knows their strides
    carried, panel, left, right = scratch((6, WIDTH)), scratch((12, 24)), scratch((12, LOCAL)), scratch((12, WIDTH))
    swaps, inverse = scratch_like(LOCAL, linear.swaps), scratch(LOCAL)
    mean = scratch((MEANS, 3))
    for m in range(LOCAL):
        swaps[m] = m
    for i in range(6):
        for k in range(12):
            carried[i, k] = system.start[i, k]
    for j in range(len(linear.lower)):
        interval_panel(j, Y, c0, h, BOX, nodes, system.rows, system.columns, mean, panel, 0)
        sweep(panel, linear.swept[j])
        keep_multipliers(carried, panel, linear.by_swept[j])
        for anew in (False, True):
            condense(carried, panel, linear.swept[j], left, right)
            if not anew and factor_as_before(left, swaps, inverse):
                break
            if anew and not factor_anew(left, swaps):
                return SINGULAR
        eliminate_right(left, swaps, right, linear.upper[j], carried)
        lower, kept = linear.lower[j], linear.swaps[j]
        for m in range(12):
            for k in range(LOCAL):
                lower[LOCAL * m + k] = left[m, k]
        for m in range(LOCAL):
            kept[m] = swaps[m]
    for i in range(6):
        for k in range(12):
            linear.last[i, k], linear.last[6 + i, k] = carried[i, k], system.end[i, k]
            linear.last[i, 12 + k], linear.last[6 + i, 12 + k] = 0.0, 0.0
    return CONVERGED if eliminate(linear.last, linear.last_swaps) else SINGULAR


@variant(solve, Elimination)
@kernel
def solve_blocks(linear: Elimination, system: System, scale: float, b: Array, x: Array) -> None:
    """Forward and backward through the intervals."""
    start, end = scratch(6), scratch(6)
    for i in range(6):
        start[i] = scale * system.b_start[i]
        end[i] = scale * system.b_end[i]
    N, y, local = len(b), linear.rhs, scratch(12)
    for j in range(N):
        forward(start, b[j], linear.swept[j], linear.by_swept[j], linear.lower[j], linear.swaps[j],
                y[j], local)  # fmt: skip
    for i in range(6):
        x[N, i] = start[i]
    close(linear.last, linear.last_swaps, end, x[N])
    for j in range(N - 1, -1, -1):
        backward(y[j], linear.swept[j], linear.lower[j], linear.upper[j], x[j + 1], x[j])
