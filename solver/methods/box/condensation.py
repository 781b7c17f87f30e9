"""Block elimination of the box scheme's system, O(N): the production solve.

Each interval has six rows carried from the left and twelve of its own. In the lab frame (3) and (4) are differences,
Delta V and Delta F, with rows that hold little else: so V_j and F_j are eliminated by them, without a search for a
pivot and without arithmetic with zeros. The six unknowns omega_j and kappa_j are eliminated with row pivoting from the
carried rows, (2) and (5); the six rows that remain are carried on. That is half the arithmetic and half the searches
of eliminating all twelve with row pivoting (de Boor & Weiss 1980, SOLVEBLOK; Diaz, Fairweather & Keast 1983, COLROW).

The pivots of V and F are not the largest of their columns; in the system's scales they are 1, and the multipliers stay
small enough: `validation/linear_solve.py` measures the backward error.
"""

from __future__ import annotations

from solver.kernel import inlined, kernel
from solver.methods.box.fields import OMEGA, F, V
from solver.rod import Array

LOCAL = 6
"""Unknowns of a node that are eliminated with pivoting: omega and kappa."""
COMPATIBILITY, EXTENSION, TRANSLATION, ROTATION = 0, 3, 6, 9
"""First row of (2), (3), (4) and (5) among an interval's own."""


@kernel
def reduce_interval(carried: Array, panel: Array, swept: Array, by_swept: Array, reduced: Array, swaps: Array) -> bool:
    """Eliminate node j from the rows `carried` (6, 12) and the interval's own, `panel` (12, 24); False if singular.

    Writes the rows (3) and (4) into `swept` (6, 24), with the multipliers of (4) by (3) in the place of its V_j; the
    multipliers of the other rows into `by_swept` (9, 6); the factored rest into `reduced` (12, 18), whose columns are
    omega_j, kappa_j and the twelve unknowns of node j + 1; and the rows to be carried on into `carried`.
    """
    for i in range(6):
        for k in range(24):
            swept[i, k] = panel[EXTENSION + i, k]
    _sweep_translation(swept)
    for i in range(6):
        for k in range(LOCAL):
            reduced[i, k] = carried[i, OMEGA + k]
        for k in range(12):
            reduced[i, LOCAL + k] = 0.0
        for m in range(3):
            multiplier = carried[i, V + m] / swept[m, V + m]
            by_swept[i, m] = multiplier
            for k in range(3):
                reduced[i, k] -= multiplier * swept[m, OMEGA + k]
                reduced[i, LOCAL + OMEGA + k] -= multiplier * swept[m, 12 + OMEGA + k]
            reduced[i, LOCAL + V + m] -= multiplier * swept[m, 12 + V + m]
        for m in range(3):
            by_swept[i, 3 + m] = carried[i, F + m] / swept[3 + m, F + m]
            _subtract_translation(m, by_swept[i, 3 + m], swept, reduced, i)
    for i in range(3):
        for k in range(LOCAL):
            reduced[6 + i, k] = panel[COMPATIBILITY + i, OMEGA + k]
            reduced[9 + i, k] = panel[ROTATION + i, OMEGA + k]
        for k in range(12):
            reduced[6 + i, LOCAL + k] = panel[COMPATIBILITY + i, 12 + k]
            reduced[9 + i, LOCAL + k] = panel[ROTATION + i, 12 + k]
        for m in range(3):
            by_swept[6 + i, 3 + m] = panel[ROTATION + i, F + m] / swept[3 + m, F + m]
            _subtract_translation(m, by_swept[6 + i, 3 + m], swept, reduced, 9 + i)
    if not _eliminate_local(reduced, swaps):
        return False
    for i in range(6):
        for k in range(12):
            carried[i, k] = reduced[LOCAL + i, LOCAL + k]
    return True


@inlined
def _sweep_translation(swept: Array) -> None:
    """Eliminate V_j from (4) by (3)."""
    for i in range(3):
        for m in range(3):
            multiplier = swept[3 + i, V + m] / swept[m, V + m]
            swept[3 + i, V + m] = multiplier
            for k in range(3):
                swept[3 + i, OMEGA + k] -= multiplier * swept[m, OMEGA + k]
                swept[3 + i, 12 + OMEGA + k] -= multiplier * swept[m, 12 + OMEGA + k]
            swept[3 + i, 12 + V + m] -= multiplier * swept[m, 12 + V + m]


@inlined
def _subtract_translation(m: int, multiplier: float, swept: Array, reduced: Array, row: int) -> None:
    """Subtract a multiple of component m of (4), V_j eliminated, from a row of `reduced`."""
    for k in range(3):
        reduced[row, k] -= multiplier * swept[3 + m, OMEGA + k]
        reduced[row, LOCAL + V + k] -= multiplier * swept[3 + m, 12 + V + k]
        reduced[row, LOCAL + OMEGA + k] -= multiplier * swept[3 + m, 12 + OMEGA + k]
    reduced[row, LOCAL + F + m] -= multiplier * swept[3 + m, 12 + F + m]


@inlined
def _eliminate_local(W: Array, swaps: Array) -> bool:
    """Factor the first six columns of W (12, 18) in place; `swaps` (6,) says where each pivot came from."""
    for k in range(LOCAL):
        pivot, largest = k, abs(W[k, k])
        for i in range(k + 1, 12):
            entry = abs(W[i, k])
            if entry > largest:
                pivot, largest = i, entry
        if not largest > 0.0:
            return False
        swaps[k] = pivot
        if pivot != k:
            for c in range(18):
                W[k, c], W[pivot, c] = W[pivot, c], W[k, c]
        inverse = 1.0 / W[k, k]
        for i in range(k + 1, 12):
            multiplier = W[i, k] * inverse
            W[i, k] = multiplier
            for c in range(k + 1, 18):
                W[i, c] -= multiplier * W[k, c]
    return True


@kernel
def forward(carried: Array, b: Array, swept: Array, by_swept: Array, reduced: Array, swaps: Array, y: Array,
            local: Array) -> None:  # fmt: skip
    """What `reduce_interval` did to the rows, done to their right-hand sides `carried` (6,) and `b` (12,).

    Writes those of (3), (4) and of the pivots into `y` (12,), and those to be carried on into `carried`; `local`
    (12,) is scratch.
    """
    for i in range(6):
        y[i] = b[EXTENSION + i]
        local[i] = carried[i]
    for i in range(3):
        local[6 + i], local[9 + i] = b[COMPATIBILITY + i], b[ROTATION + i]
        for m in range(3):
            y[3 + i] -= swept[3 + i, V + m] * y[m]
    for i in range(6):
        for m in range(6):
            local[i] -= by_swept[i, m] * y[m]
    for i in range(3):
        for m in range(3, 6):
            local[9 + i] -= by_swept[6 + i, m] * y[m]
    for k in range(LOCAL):
        pivot = swaps[k]
        local[k], local[pivot] = local[pivot], local[k]
    for k in range(LOCAL):
        for i in range(k + 1, 12):
            local[i] -= reduced[i, k] * local[k]
    for i in range(6):
        y[6 + i] = local[i]
        carried[i] = local[6 + i]


@kernel
def backward(y: Array, swept: Array, reduced: Array, right: Array, x: Array) -> None:
    """Write the unknowns `x` (12,) of node j from those of node j + 1, `right` (12,)."""
    for i in range(LOCAL - 1, -1, -1):
        total = y[6 + i]
        for k in range(12):
            total -= reduced[i, LOCAL + k] * right[k]
        for k in range(i + 1, LOCAL):
            total -= reduced[i, k] * x[OMEGA + k]
        x[OMEGA + i] = total / reduced[i, i]
    for m in range(3):
        total = y[3 + m] - swept[3 + m, 12 + F + m] * right[F + m]
        for k in range(3):
            total -= swept[3 + m, OMEGA + k] * x[OMEGA + k]
            total -= swept[3 + m, 12 + V + k] * right[V + k] + swept[3 + m, 12 + OMEGA + k] * right[OMEGA + k]
        x[F + m] = total / swept[3 + m, F + m]
    for m in range(3):
        total = y[m] - swept[m, 12 + V + m] * right[V + m]
        for k in range(3):
            total -= swept[m, OMEGA + k] * x[OMEGA + k] + swept[m, 12 + OMEGA + k] * right[OMEGA + k]
        x[V + m] = total / swept[m, V + m]
