"""Elimination in the 6 x 6 block tridiagonal system of `segments`.

The rows of F are minus positive and those of psi positive definite but for loads, so no pivots are searched between
blocks.
"""

from __future__ import annotations

from solver.arrays import Array
from solver.kernels.kernel import inlined_late, inner, kernel
from solver.kernels.scratch import scratch_like
from solver.methods.linear.segments import Factors, invert3, translate, write_row
from solver.methods.linear.segments_increments import displace
from solver.methods.space.segments.balances import Driven, Tangents
from solver.methods.space.segments.chain import Chain


@inlined_late
def _times(A: Array, i: int, j: int, B: Array, k: int, m: int, out: Array, row: int, column: int) -> None:
    """Write the 3 x 3 block (i, j) of A times the block (k, m) of B into the block of `out`."""
    for p in range(3):
        x, y, z = A[i + p, j], A[i + p, j + 1], A[i + p, j + 2]
        for q in range(3):
            out[row + p, column + q] = x * B[k, m + q] + y * B[k + 1, m + q] + z * B[k + 2, m + q]


@inlined_late
def _subtract_times(A: Array, i: int, j: int, B: Array, k: int, m: int, out: Array, row: int, column: int) -> None:
    """Subtract the 3 x 3 block (i, j) of A times the block (k, m) of B from the block of `out`."""
    for p in range(3):
        x, y, z = A[i + p, j], A[i + p, j + 1], A[i + p, j + 2]
        for q in range(3):
            out[row + p, column + q] -= x * B[k, m + q] + y * B[k + 1, m + q] + z * B[k + 2, m + q]


@inner
def _invert6(D: Array, room: Array, inverse: Array) -> bool:
    """Write D^-1 by its 3 x 3 blocks, that of the forces first: it is definite. False if a block is singular.

    With D = (A B; C E), P = E^-1, S = (A - B P C)^-1: (S, -S B P; -P C S, P + P C S B P).
    """
    blocks = scratch_like((3, 3, 3), D)
    E, P, S = blocks[0], blocks[1], blocks[2]
    for k in range(3):
        for m in range(3):
            E[k, m] = D[3 + k, 3 + m]
    if not invert3(E, P):
        return False
    # (P C) into the lower left block, (B P) into the upper right one, for now
    _times(P, 0, 0, D, 3, 0, inverse, 3, 0)
    _times(D, 0, 3, P, 0, 0, inverse, 0, 3)
    for k in range(3):
        for m in range(3):
            E[k, m] = D[k, m]
    _subtract_times(D, 0, 3, inverse, 3, 0, E, 0, 0)
    if not invert3(E, S):
        return False
    # S B P into room, then P + P C (S B P)
    _times(S, 0, 0, inverse, 0, 3, room, 0, 3)
    for k in range(3):
        for m in range(3):
            inverse[k, m] = S[k, m]
            inverse[3 + k, 3 + m] = P[k, m]
            room[3 + k, 3 + m] = -inverse[3 + k, m]
            inverse[k, 3 + m] = -room[k, 3 + m]
    _subtract_times(room, 3, 3, room, 0, 3, inverse, 3, 3)
    _times(room, 3, 3, S, 0, 0, inverse, 3, 0)
    return True


@kernel
def factor(chain: Chain, driven: Driven, tangents: Tangents, eigenvalue: complex, factors: Factors) -> bool:
    """Factor the system for one eigenvalue; False if it is singular."""
    blocks = scratch_like((3, 6, 6), factors.lower)
    D, upper, room = blocks[0], blocks[1], blocks[2]
    translate(chain, tangents, eigenvalue, D, factors)
    for a in range(len(factors.lower)):
        lower = factors.lower[a]
        write_row(chain, driven, tangents, eigenvalue, factors, a, lower, D, upper)
        if a > 0:
            before = factors.upper[a - 1]
            for column in (0, 3):
                _subtract_times(lower, 0, 0, before, 0, column, D, 0, column)
                _subtract_times(lower, 0, 3, before, 3, column, D, 0, column)
                _subtract_times(lower, 3, 3, before, 3, column, D, 3, column)
        inverse, W = factors.inverse[a], factors.upper[a]
        if not _invert6(D, room, inverse):
            return False
        for row in (0, 3):
            _times(inverse, row, 3, upper, 3, 3, W, row, 3)
            _times(inverse, row, 0, upper, 0, 0, W, row, 0)
            for k in range(3):
                for m in range(3):
                    room[k, m] = W[row + k, m]
            _times(inverse, row, 3, upper, 3, 0, W, row, 0)
            for k in range(3):
                for m in range(3):
                    W[row + k, m] += room[k, m]
    return True


@inlined_late
def _row(A: Array, k: int, x: tuple) -> complex:  # type: ignore[type-arg]
    """Row k of A (6, 6) times x (6)."""
    total: complex = (A[k, 0] * x[0] + A[k, 1] * x[1] + A[k, 2] * x[2]
                      + (A[k, 3] * x[3] + A[k, 4] * x[4] + A[k, 5] * x[5]))  # fmt: skip
    return total


@kernel
def solve(factors: Factors) -> None:
    """Replace the right-hand side in x by the solution, and write the displacements of the centres.

    Tuples stay in registers, which arrays do not.
    """
    x, n = factors.x, len(factors.x)
    zero = 0.0 * x[0, 0]
    last = (zero, zero, zero, zero, zero, zero)
    for a in range(n):
        b, lower, inverse = x[a], factors.lower[a], factors.inverse[a]
        y = (b[0] - _row(lower, 0, last), b[1] - _row(lower, 1, last), b[2] - _row(lower, 2, last),
             b[3] - _row(lower, 3, last), b[4] - _row(lower, 4, last), b[5] - _row(lower, 5, last))  # fmt: skip
        last = (_row(inverse, 0, y), _row(inverse, 1, y), _row(inverse, 2, y),
                _row(inverse, 3, y), _row(inverse, 4, y), _row(inverse, 5, y))  # fmt: skip
        for k in range(6):
            b[k] = last[k]
    for a in range(n - 2, -1, -1):
        b, upper = x[a], factors.upper[a]
        last = (b[0] - _row(upper, 0, last), b[1] - _row(upper, 1, last), b[2] - _row(upper, 2, last),
                b[3] - _row(upper, 3, last), b[4] - _row(upper, 4, last), b[5] - _row(upper, 5, last))  # fmt: skip
        for k in range(6):
            b[k] = last[k]
    displace(factors)
