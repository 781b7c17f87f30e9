"""The almost block diagonal system: factored and solved, in O(N).

The box scheme's by condensation.py. That of generalized-alpha in space, with 24 unknowns a node, see augmented.py, by
panels of the rows carried from the left and the interval's own: the left node's columns are eliminated with row
pivoting, the remaining rows are carried on (de Boor & Weiss 1980, SOLVEBLOK; Diaz, Fairweather & Keast 1983, COLROW).
"""

from __future__ import annotations

from solver.arrays import Array
from solver.kernels.kernel import kernel
from solver.kernels.scratch import scratch, scratch_like
from solver.methods.linear.augmented import wide_panel, wide_start
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
from solver.methods.space.box.fields import Linear, Nodes, Wide
from solver.methods.space.box.intervals import MEANS, interval_panel
from solver.methods.space.box.schemes import BOX
from solver.physics.section import Section


@kernel
def _eliminate(W: Array, swaps: Array) -> bool:
    """Factor the left half of the columns of W in place; `swaps` says where each pivot came from."""
    size = len(swaps)
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
def _forward(W: Array, swaps: Array, y: Array) -> None:
    for k in range(len(swaps)):
        pivot = swaps[k]
        y[k], y[pivot] = y[pivot], y[k]
    for k in range(len(swaps)):
        for i in range(k + 1, len(W)):
            y[i] -= W[i, k] * y[k]


@kernel
def _close(last: Array, last_swaps: Array, b_end: Array, x: Array) -> None:
    """Solve for the last node's `x`, which holds the right-hand sides carried there."""
    size, carried = len(x), len(x) - len(b_end)
    for i in range(len(b_end)):
        x[carried + i] = b_end[i]
    _forward(last, last_swaps, x)
    for i in range(size - 1, -1, -1):
        for k in range(i + 1, size):
            x[i] -= last[i, k] * x[k]
        x[i] /= last[i, i]


@kernel
def _substitute_wide(wide: Wide, b_end: Array) -> None:
    panels, y, x, size = wide.panels, wide.y, wide.x, len(wide.last)
    N, carried = len(panels), len(wide.rhs_start)
    for i in range(carried):
        y[0, i] = wide.rhs_start[i]
    for j in range(N):
        for i in range(size):
            y[j, carried + i] = wide.rhs[j, i]
        _forward(panels[j], wide.swaps[j], y[j])
        for i in range(carried):
            if j + 1 < N:
                y[j + 1, i] = y[j, size + i]
            else:
                x[N, i] = y[j, size + i]
    _close(wide.last, wide.last_swaps, b_end, x[N])
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
    # made here, so that the compiler knows their strides
    carried, panel, left, right = scratch((6, WIDTH)), scratch((12, 24)), scratch((12, LOCAL)), scratch((12, WIDTH))
    swaps, inverse, entries = scratch_like(LOCAL, system.swaps), scratch(LOCAL), left.reshape(12 * LOCAL)
    mean = scratch((MEANS, 3))
    for m in range(LOCAL):
        swaps[m] = m
    carried[:, :12] = system.start
    for j in range(len(system.lower)):
        interval_panel(j, Y, c0, h, BOX, nodes, section, system.rows, system.columns, mean, panel, 0)
        sweep(panel, system.swept[j])
        condense(carried, panel, system.swept[j], left, right)
        keep_multipliers(carried, panel, system.by_swept[j])
        if not factor_as_before(left, swaps, inverse):
            condense(carried, panel, system.swept[j], left, right)
            if not factor_anew(left, swaps):
                return False
        eliminate_right(left, swaps, right, system.upper[j], carried)
        lower, kept = system.lower[j], system.swaps[j]
        for m in range(12 * LOCAL):
            lower[m] = entries[m]
        for m in range(LOCAL):
            kept[m] = swaps[m]
    system.last[:, :] = 0.0
    system.last[:6, :12] = carried[:, :12]
    system.last[6:, :12] = system.end
    return bool(_eliminate(system.last, system.last_swaps))


@kernel
def _factor_wide(Y: Array, c0: float, h: float, nodes: Nodes, section: Section, system: Linear) -> bool:
    wide, mean = system.wide, scratch((MEANS, 3))
    for j in range(len(wide.panels)):
        W = wide.panels[j]
        W[:, :] = 0.0
        if j == 0:
            wide_start(Y, c0, h, nodes, section, system, mean, W)
        else:
            W[:18, :24] = wide.panels[j - 1, 24:, 24:]
        wide_panel(j, Y, c0, h, nodes, section, system, mean, W)
        if not _eliminate(W, wide.swaps[j]):
            return False
    wide.last[:, :] = 0.0
    wide.last[:18, :24] = wide.panels[len(wide.panels) - 1, 24:, 24:]
    wide.last[18:, :12] = system.end
    return bool(_eliminate(wide.last, wide.last_swaps))


@kernel
def solve(system: Linear, scale: float, b: Array, x: Array) -> None:
    """Solve with the factors into `x` (n, 12): right-hand side `b` (N, 12), and `scale` times all other residuals."""
    wide, start, end = system.wide, scratch(6), scratch(6)
    for i in range(6):
        start[i] = scale * system.b_start[i]
        end[i] = scale * system.b_end[i]
    if len(wide.A) == 0:
        N, y, local = len(b), system.rhs, scratch(12)
        for j in range(N):
            forward(start, b[j], system.swept[j], system.by_swept[j], system.lower[j], system.swaps[j],
                    y[j], local)  # fmt: skip
        for i in range(6):
            x[N, i] = start[i]
        _close(system.last, system.last_swaps, end, x[N])
        for j in range(N - 1, -1, -1):
            backward(y[j], system.swept[j], system.lower[j], system.upper[j], x[j + 1], x[j])
        return
    for i in range(18):
        wide.rhs_start[i] = scale * wide.b_start[i]
    for j in range(len(b)):
        for k in range(12):
            wide.rhs[j, k] = b[j, k] + scale * (wide.b[j, k] - system.b[j, k])
            wide.rhs[j, 12 + k] = scale * wide.b[j, 12 + k]
    _substitute_wide(wide, end)
    x[:, :] = wide.x[:, :12]
