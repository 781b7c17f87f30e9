"""Block elimination of the almost block diagonal system, O(N): the production solve.

Each interval's panel has 18 rows, six carried from the left and the interval's twelve, and 24 columns, the
unknowns of its two nodes. Twelve columns are eliminated with row pivoting, six rows carry on. In the manner of
de Boor & Weiss 1980 (SOLVEBLOK) and Diaz, Fairweather & Keast 1983 (COLROW). Backward stable: see validation.
"""

from __future__ import annotations

import numpy as np

from solver.kernel import kernel
from solver.methods.box.fields import Linear, Nodes
from solver.methods.box.intervals import interval_panel
from solver.rod import Array


@kernel
def factor(Y: Array, c0: float, h: float, nodes: Nodes, system: Linear) -> bool:
    """Factor the system of the iterate `Y` (n, 12), making each panel when its turn comes; False if it is singular."""
    N = len(system.panels)
    W, mean = np.zeros((18, 24)), np.zeros((4, 3))
    W[:6, :12] = system.start
    for j in range(N):
        interval_panel(j, Y, c0, h, nodes, system.rows, system.columns, mean, W)
        if not _eliminate(W, 18, system.swaps[j]):
            return False
        for i in range(18):
            for k in range(24):
                system.panels[j, i, k] = W[i, k]
        for i in range(6):
            for k in range(12):
                W[i, k] = W[12 + i, 12 + k]
                W[i, 12 + k] = 0.0
    system.last[:6] = W[:6, :12]
    system.last[6:] = system.end
    return bool(_eliminate_last(system.last, system.last_swaps))


@kernel
def _eliminate(W: Array, rows: int, swaps: Array) -> bool:
    """Eliminate the first twelve columns of W (rows, 24) with row pivoting, multipliers kept below."""
    for k in range(12):
        pivot, largest = k, abs(W[k, k])
        for i in range(k + 1, rows):
            size = abs(W[i, k])
            if size > largest:
                pivot, largest = i, size
        if not largest > 0.0:
            return False
        swaps[k] = pivot
        if pivot != k:
            for c in range(24):
                W[k, c], W[pivot, c] = W[pivot, c], W[k, c]
        inverse = 1.0 / W[k, k]
        for i in range(k + 1, rows):
            if W[i, k] != 0.0:
                multiplier = W[i, k] * inverse
                W[i, k] = multiplier
                for c in range(k + 1, 24):
                    W[i, c] -= multiplier * W[k, c]
    return True


@kernel
def _eliminate_last(W: Array, swaps: Array) -> bool:
    """Factor W (12, 12) with row pivoting."""
    for k in range(12):
        pivot = k
        for i in range(k + 1, 12):
            if abs(W[i, k]) > abs(W[pivot, k]):
                pivot = i
        if not abs(W[pivot, k]) > 0.0:
            return False
        swaps[k] = pivot
        if pivot != k:
            for c in range(12):
                W[k, c], W[pivot, c] = W[pivot, c], W[k, c]
        for i in range(k + 1, 12):
            multiplier = W[i, k] / W[k, k]
            W[i, k] = multiplier
            for c in range(k + 1, 12):
                W[i, c] -= multiplier * W[k, c]
    return True


@kernel
def solve(system: Linear, b_start: Array, b: Array, b_end: Array, x: Array) -> None:
    """Solve with the factors for the right-hand side (6,), (N, 12), (6,) into `x` (n, 12)."""
    N = len(system.panels)
    y = system.rhs
    for j in range(N):
        for i in range(6):
            y[j, i] = b_start[i] if j == 0 else y[j - 1, 12 + i]
        for i in range(12):
            y[j, 6 + i] = b[j, i]
        _forward(system.panels[j], system.swaps[j], y[j], 18)
    for i in range(6):
        x[N, i] = y[N - 1, 12 + i]
        x[N, 6 + i] = b_end[i]
    _forward(system.last, system.last_swaps, x[N], 12)
    for i in range(11, -1, -1):
        total = x[N, i]
        for k in range(i + 1, 12):
            total -= system.last[i, k] * x[N, k]
        x[N, i] = total / system.last[i, i]
    for j in range(N - 1, -1, -1):
        W = system.panels[j]
        for i in range(11, -1, -1):
            total = y[j, i]
            for k in range(12):
                total -= W[i, 12 + k] * x[j + 1, k]
            for k in range(i + 1, 12):
                total -= W[i, k] * x[j, k]
            x[j, i] = total / W[i, i]


@kernel
def _forward(W: Array, swaps: Array, y: Array, rows: int) -> None:
    for k in range(12):
        pivot = swaps[k]
        y[k], y[pivot] = y[pivot], y[k]
    for k in range(12):
        for i in range(k + 1, rows):
            y[i] -= W[i, k] * y[k]


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
