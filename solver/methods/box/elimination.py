"""Block elimination of an almost block diagonal system, O(N): the production solve.

Each interval's panel has the rows carried from the left and the interval's own, and as columns the unknowns of its
two nodes. The left node's columns are eliminated with row pivoting, the remaining rows are carried on. In the manner of
de Boor & Weiss 1980 (SOLVEBLOK) and Diaz, Fairweather & Keast 1983 (COLROW). Backward stable.

The box scheme has 12 unknowns a node and carries 6 rows; as constants they let the compiler unroll, which halves the
time. The same code with 24 unknowns serves generalized-alpha in space, see augmented.py.
"""

from __future__ import annotations

import numpy as np

from solver.kernel import inlined, kernel
from solver.methods.box.augmented import wide_panel, wide_start
from solver.methods.box.fields import Linear, Nodes
from solver.methods.box.intervals import MEANS, interval_panel
from solver.methods.box.space import BOX
from solver.rod import Array, Section


@inlined
def _eliminate_columns(size: int, W: Array, swaps: Array) -> bool:
    """Factor the first `size` columns of W (rows, 2 size) in place; `swaps` (size,) says where each pivot came from."""
    for k in range(size):
        pivot, largest = k, abs(W[k, k])
        for i in range(k + 1, len(W)):
            entry = abs(W[i, k])
            if entry > largest:
                pivot, largest = i, entry
        if not largest > 0.0:
            return False
        swaps[k] = pivot
        if pivot != k:
            for c in range(2 * size):
                W[k, c], W[pivot, c] = W[pivot, c], W[k, c]
        inverse = 1.0 / W[k, k]
        for i in range(k + 1, len(W)):
            if W[i, k] != 0.0:
                multiplier = W[i, k] * inverse
                W[i, k] = multiplier
                for c in range(k + 1, 2 * size):
                    W[i, c] -= multiplier * W[k, c]
    return True


@kernel
def _eliminate(W: Array, swaps: Array) -> bool:
    return bool(_eliminate_columns(12, W, swaps))


@kernel
def _eliminate_wide(W: Array, swaps: Array) -> bool:
    return bool(_eliminate_columns(W.shape[1] // 2, W, swaps))


@kernel
def _forward(W: Array, swaps: Array, y: Array) -> None:
    for k in range(len(swaps)):
        pivot = swaps[k]
        y[k], y[pivot] = y[pivot], y[k]
    for k in range(len(swaps)):
        for i in range(k + 1, len(W)):
            y[i] -= W[i, k] * y[k]


@inlined
def _substitute_columns(size: int, panels: Array, swaps: Array, last: Array, last_swaps: Array, y: Array,
                        b_start: Array, b: Array, b_end: Array, x: Array) -> None:  # fmt: skip
    N, carried = len(panels), len(b_start)
    for i in range(carried):
        y[0, i] = b_start[i]
    for j in range(N):
        for i in range(size):
            y[j, carried + i] = b[j, i]
        _forward(panels[j], swaps[j], y[j])
        for i in range(carried):
            if j + 1 < N:
                y[j + 1, i] = y[j, size + i]
            else:
                x[N, i] = y[j, size + i]
    for i in range(size - carried):
        x[N, carried + i] = b_end[i]
    _forward(last, last_swaps, x[N])
    for i in range(size - 1, -1, -1):
        total = x[N, i]
        for k in range(i + 1, size):
            total -= last[i, k] * x[N, k]
        x[N, i] = total / last[i, i]
    for j in range(N - 1, -1, -1):
        for i in range(size - 1, -1, -1):
            total = y[j, i]
            for k in range(size):
                total -= panels[j, i, size + k] * x[j + 1, k]
            for k in range(i + 1, size):
                total -= panels[j, i, k] * x[j, k]
            x[j, i] = total / panels[j, i, i]


@kernel
def factor(Y: Array, c0: float, h: float, nodes: Nodes, section: Section, system: Linear) -> bool:
    """Factor the system of the iterate `Y` (n, 12), making each panel when its turn comes; False if it is singular."""
    if len(system.wide.A) > 0:
        return bool(_factor_wide(Y, c0, h, nodes, section, system))
    N = len(system.panels)
    W, mean = system.panel, system.mean
    W[:6, :12] = system.start
    W[:6, 12:] = 0.0
    for j in range(N):
        interval_panel(j, Y, c0, h, BOX, nodes, section, system.rows, system.columns, mean, W, 6)
        if not _eliminate(W, system.swaps[j]):
            return False
        for i in range(18):
            for k in range(24):
                system.panels[j, i, k] = W[i, k]
        for i in range(6):
            for k in range(12):
                W[i, k] = W[12 + i, 12 + k]
                W[i, 12 + k] = 0.0
    system.last[:, :] = 0.0
    system.last[:6, :12] = W[:6, :12]
    system.last[6:, :12] = system.end
    return bool(_eliminate(system.last, system.last_swaps))


@kernel
def _factor_wide(Y: Array, c0: float, h: float, nodes: Nodes, section: Section, system: Linear) -> bool:
    wide, mean = system.wide, np.zeros((MEANS, 3))
    for j in range(len(wide.panels)):
        W = wide.panels[j]
        if j == 0:
            wide_start(Y, c0, h, nodes, section, system, mean, W)
        else:
            W[:18, :24] = wide.panels[j - 1, 24:, 24:]
            W[:18, 24:] = 0.0
        wide_panel(j, Y, c0, h, nodes, section, system, mean, W)
        if not _eliminate_wide(W, wide.swaps[j]):
            return False
    wide.last[:, :] = 0.0
    wide.last[:18, :24] = wide.panels[len(wide.panels) - 1, 24:, 24:]
    wide.last[18:, :12] = system.end
    return bool(_eliminate_wide(wide.last, wide.last_swaps))


@kernel
def solve(system: Linear, scale: float, b: Array, x: Array) -> None:
    """Solve with the factors into `x` (n, 12): right-hand side `b` (N, 12), and `scale` times all other residuals."""
    wide = system.wide
    for i in range(6):
        system.rhs_start[i] = scale * system.b_start[i]
        system.rhs_end[i] = scale * system.b_end[i]
    if len(wide.A) == 0:
        _substitute_columns(12, system.panels, system.swaps, system.last, system.last_swaps, system.rhs,
                            system.rhs_start, b, system.rhs_end, x)  # fmt: skip
        return
    for i in range(18):
        wide.rhs_start[i] = scale * wide.b_start[i]
    for j in range(len(b)):
        for k in range(12):
            wide.rhs[j, k] = b[j, k] + scale * (wide.b[j, k] - system.b[j, k])
            wide.rhs[j, 12 + k] = scale * wide.b[j, 12 + k]
    _substitute_columns(len(wide.last), wide.panels, wide.swaps, wide.last, wide.last_swaps, wide.y,
                        wide.rhs_start, wide.rhs, system.rhs_end, wide.x)  # fmt: skip
    x[:, :] = wide.x[:, :12]


@kernel
def determinant_sign(system: Linear) -> int:
    """The sign of the determinant of the factored system: it changes where equilibria branch or fold."""
    sign = 1
    for j in range(len(system.panels)):
        for k in range(12):
            if system.swaps[j, k] != k:
                sign = -sign
            if system.panels[j, k, k] < 0.0:
                sign = -sign
    for k in range(12):
        if system.last_swaps[k] != k:
            sign = -sign
        if system.last[k, k] < 0.0:
            sign = -sign
    return sign
