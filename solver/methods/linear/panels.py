"""Almost block diagonal systems by panels, with row pivoting.

A panel has the rows carried from the left and the interval's own: the left node's columns are eliminated, the remaining
rows are carried on (de Boor & Weiss 1980, SOLVEBLOK; Diaz, Fairweather & Keast 1983, COLROW).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from solver.arrays import Array
from solver.kernels.kernel import kernel

Swaps = NDArray[np.int64]
"""Where each pivot came from."""


@kernel
def eliminate(W: Array, swaps: Swaps) -> bool:
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
def forward_panel(W: Array, swaps: Swaps, y: Array) -> None:
    """Do to the right-hand sides `y` what was done to the rows of W."""
    for k in range(len(swaps)):
        pivot = swaps[k]
        y[k], y[pivot] = y[pivot], y[k]
    for k in range(len(swaps)):
        for i in range(k + 1, len(W)):
            y[i] -= W[i, k] * y[k]


@kernel
def close(last: Array, last_swaps: Swaps, b_end: Array, x: Array) -> None:
    """Solve for the last node's `x`, which holds the right-hand sides carried there."""
    size, carried = len(x), len(x) - len(b_end)
    for i in range(len(b_end)):
        x[carried + i] = b_end[i]
    forward_panel(last, last_swaps, x)
    for i in range(size - 1, -1, -1):
        for k in range(i + 1, size):
            x[i] -= last[i, k] * x[k]
        x[i] /= last[i, i]
