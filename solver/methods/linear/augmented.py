"""Generalized-alpha in space with rho_inf < 1: the system that carries the auxiliary derivatives A along s.

Per interval the twelve balances with their term h b A_j, and the twelve formulas
h ((1 - gamma) A_j + gamma A_{j+1}) - Delta Z = 0; at s = 0 the six conditions and A_0 + G_0 = 0. A is scaled with the
rows, A = x / (rows h). This is an option for comparison: it costs several times the box scheme.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from solver.arrays import Array
from solver.kernels.copying import copy
from solver.kernels.dispatch import variant
from solver.kernels.kernel import inner, kernel
from solver.kernels.scratch import scratch
from solver.methods.linear.panels import Swaps, close, eliminate, forward_panel
from solver.methods.linear.system import System, factor, solve, take_own_unknowns
from solver.methods.space.box.fields import OMEGA, F, Nodes, V
from solver.methods.space.box.intervals import MEANS, interval_panel, interval_residuals
from solver.methods.space.box.schemes import AT_LEFT_NODE, MINUS_DIFFERENCE
from solver.methods.status import CONVERGED, SINGULAR


class Augmented(NamedTuple):
    """The auxiliary derivatives `A` (n, 12) along s, and the system with 24 unknowns a node, Y and A.

    `panels` (N, 42, 48) with `swaps` (N, 24); `last` (24, 48) with `last_swaps` (24,); residuals `b_start` (18,) and
    `b` (N, 24); `rhs_start`, `rhs` the same shapes; `y` (N, 42); `x` (n, 24).
    """

    A: Array
    panels: Array
    swaps: Swaps
    last: Array
    last_swaps: Swaps
    b_start: Array
    b: Array
    rhs_start: Array
    rhs: Array
    y: Array
    x: Array

    @classmethod
    def empty(cls, intervals: int) -> Augmented:
        """Zeros for a rod of `intervals` intervals."""
        N, n = intervals, intervals + 1
        return cls(np.zeros((n, 12)), np.zeros((N, 42, 48)), np.zeros((N, 24), np.int64), np.zeros((24, 48)),
                   np.zeros(24, np.int64), np.zeros(18), np.zeros((N, 24)), np.zeros(18), np.zeros((N, 24)),
                   np.zeros((N, 42)), np.zeros((n, 24)))  # fmt: skip


@kernel
def wide_residuals(wide: Augmented, Y: Array, past: Array, c0: float, h: float, nodes: Nodes, system: System) -> None:
    """Write the residuals of the wide system; those of the box part, `system.b`, are complete but for A."""
    rows, gamma = system.rows, system.space.gamma
    nothing, at_start = scratch((1, 3)), scratch((1, 12))
    interval_residuals(Y, past, c0, h, AT_LEFT_NODE, nodes, nothing, rows, at_start)
    copy(system.b_start, wide.b_start[:6])
    for k in range(12):
        wide.b_start[6 + k] = at_start[0, k] + rows[k] * h * wide.A[0, k]
    for j in range(len(wide.b)):
        for k in range(12):
            if k < 3:
                change = Y[j + 1, OMEGA + k] - Y[j, OMEGA + k]
            elif k < 6:
                change = Y[j + 1, V + k - 3] - Y[j, V + k - 3]
            elif k < 9:
                change = Y[j + 1, F + k - 6] - Y[j, F + k - 6]
            else:
                change = nodes.q[j + 1, k - 9] - nodes.q[j, k - 9]
            wide.b[j, k] = system.b[j, k] + rows[k] * h * system.space.b * wide.A[j, k]
            carried = h * ((1.0 - gamma) * wide.A[j, k] + gamma * wide.A[j + 1, k])
            wide.b[j, 12 + k] = rows[k] * (carried - change)


@kernel
def wide_panel(j: int, Y: Array, c0: float, h: float, nodes: Nodes, system: System, mean: Array,
               W: Array) -> None:  # fmt: skip
    """Write the tangents of interval j into rows 18 to 41 of W (42, 48)."""
    interval_panel(j, Y, c0, h, system.space, nodes, system.rows, system.columns, mean, W, 18)
    interval_panel(j, Y, c0, h, MINUS_DIFFERENCE, nodes, system.rows, system.columns, mean, W, 30)
    for k in range(12):
        W[18 + k, 12 + k] = system.space.b
        W[30 + k, 12 + k] = 1.0 - system.space.gamma
        W[30 + k, 36 + k] = system.space.gamma


@kernel
def wide_start(Y: Array, c0: float, h: float, nodes: Nodes, system: System, mean: Array,
               W: Array) -> None:  # fmt: skip
    """Write the 18 conditions at s = 0 into the first rows of W (42, 48)."""
    interval_panel(0, Y, c0, h, AT_LEFT_NODE, nodes, system.rows, system.columns, mean, W, 6)
    W[:6, :] = 0.0
    copy(system.start, W[:6, :12])
    for k in range(12):
        W[6 + k, 12 + k] = 1.0


@variant(factor, Augmented)
@kernel
def factor_wide(wide: Augmented, Y: Array, past: Array, c0: float, h: float, nodes: Nodes,
                system: System) -> int:  # fmt: skip
    """Write the residuals that the box scheme has not, and factor panel after panel."""
    wide_residuals(wide, Y, past, c0, h, nodes, system)
    mean = scratch((MEANS, 3))
    for j in range(len(wide.panels)):
        W = wide.panels[j]
        W[:, :] = 0.0
        if j == 0:
            wide_start(Y, c0, h, nodes, system, mean, W)
        else:
            copy(wide.panels[j - 1, 24:, 24:], W[:18, :24])
        wide_panel(j, Y, c0, h, nodes, system, mean, W)
        if not eliminate(W, wide.swaps[j]):
            return SINGULAR
    wide.last[:, :] = 0.0
    copy(wide.panels[len(wide.panels) - 1, 24:, 24:], wide.last[:18, :24])
    copy(system.end, wide.last[18:, :12])
    return CONVERGED if eliminate(wide.last, wide.last_swaps) else SINGULAR


@variant(solve, Augmented)
@kernel
def solve_wide(wide: Augmented, system: System, scale: float, b: Array, x: Array) -> None:
    """Solve for Y's unknowns into `x`, and for all into `wide.x`."""
    end = scratch(6)
    for i in range(6):
        end[i] = scale * system.b_end[i]
    for i in range(18):
        wide.rhs_start[i] = scale * wide.b_start[i]
    for j in range(len(b)):
        for k in range(12):
            wide.rhs[j, k] = b[j, k] + scale * (wide.b[j, k] - system.b[j, k])
            wide.rhs[j, 12 + k] = scale * wide.b[j, 12 + k]
    _substitute(wide, end)
    copy(wide.x[:, :12], x)


@inner
def _substitute(wide: Augmented, b_end: Array) -> None:
    panels, y, x, size = wide.panels, wide.y, wide.x, len(wide.last)
    N, carried = len(panels), len(wide.rhs_start)
    for i in range(carried):
        y[0, i] = wide.rhs_start[i]
    for j in range(N):
        for i in range(size):
            y[j, carried + i] = wide.rhs[j, i]
        forward_panel(panels[j], wide.swaps[j], y[j])
        for i in range(carried):
            if j + 1 < N:
                y[j + 1, i] = y[j, size + i]
            else:
                x[N, i] = y[j, size + i]
    close(wide.last, wide.last_swaps, b_end, x[N])
    for j in range(N - 1, -1, -1):
        for i in range(size - 1, -1, -1):
            total = y[j, i]
            for k in range(size):
                total -= panels[j, i, size + k] * x[j + 1, k]
            for k in range(i + 1, size):
                total -= panels[j, i, k] * x[j, k]
            x[j, i] = total / panels[j, i, i]


@variant(take_own_unknowns, Augmented)
@kernel
def take_auxiliary(wide: Augmented, fraction: float, h: float, system: System) -> None:
    """Subtract the increments of A in the wide solution."""
    for j in range(len(wide.A)):
        for k in range(12):
            wide.A[j, k] -= fraction * wide.x[j, 12 + k] / (system.rows[k] * h)
