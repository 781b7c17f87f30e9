"""Loops over nodes or segments, eight abreast.

The arrays hold what belongs to a node side by side, which a compiler cannot compute on several nodes at a time. So a
loop gathers what eight nodes hold into rows of eight, computes along the rows, where every operation is that of one
node on eight numbers at once, and scatters the results: to the bit what one after the other would give. What only some
nodes need (a function for large angles, say) is mended between two loops along the rows. The last lanes are copies of
the last line, so all that is gathered and scattered in one loop must have as many lines.
"""

from __future__ import annotations

from solver.arrays import Array
from solver.kernels.kernel import inlined

LANES = 8
"""Nodes abreast: 512 bits, or two times 256."""


@inlined
def gather(source: Array, width: int, first: int, rows: Array, at: int) -> None:
    """Write `width` columns of source (n, .), eight lines from `first` on, into rows (., 8) from `at` on.

    `width` is given as a number, and `rows` made where it is used, so that the compiler knows what it deals with.
    """
    last = len(source) - 1
    for lane in range(LANES):
        j = min(first + lane, last)
        for k in range(width):
            rows[at + k, lane] = source[j, k]


@inlined
def scatter(rows: Array, at: int, width: int, first: int, target: Array) -> None:
    """Write `width` rows (., 8) from `at` on into the columns of target (n, .), eight lines from `first` on."""
    last = len(target) - 1
    for lane in range(LANES):
        j = min(first + lane, last)
        for k in range(width):
            target[j, k] = rows[at + k, lane]
