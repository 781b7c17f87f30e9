"""Newton's linear system: 6 x 6 block tridiagonal, for one eigenvalue lambda of the time scheme, real or complex.

Unknown at block a = 0 ... N + 1: the rotation psi of orientation a and the force F at node a (none in the last block).
A segment's displacement is eliminated by its own balance: with P = M lambda^2 + C lambda + K and X = P^-1,

    delta r_j = X (delta F_j+1 - delta F_j + E psi - residual),

and what remains of translation is that neighbours stay joined: delta r_j+1 - delta r_j = d(h/2 T_j + h/2 T_j+1). The
rows of F are minus positive and those of psi positive definite but for loads, so no pivots are searched between blocks.
Where the rod can stretch, delta (e t) comes to the right, and its transpose to the rows of psi: see `Tangents.opens`.
Where it resists rates, lambda times its tangents stand beside those of its stiffness.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from solver.arrays import Array
from solver.kernels.copying import copy
from solver.kernels.kernel import inlined_late, inner, kernel
from solver.kernels.scratch import scratch_like
from solver.methods.space.segments.balances import Driven, Tangents
from solver.methods.space.segments.chain import STAGES, Chain, Stages
from solver.methods.space.segments.joints import share
from solver.physics.elasticity import is_viscous, stretches
from solver.physics.ends import LOAD, RATE, RATE_LAB


class Factors(NamedTuple):
    """The factored system: `X`, `Y` = X E (N, 3, 3); `lower`, `inverse` of the reduced diagonal, `upper` = inverse
    times the blocks above (N + 2, 6, 6); right-hand side and solution `x` (N + 2, 6); `moved` (N, 3): displacements of
    the centres; `load` (N, 3), `ends` (2, 3): the residuals of translation and of the ends' conditions."""

    X: Array
    Y: Array
    lower: Array
    inverse: Array
    upper: Array
    x: Array
    moved: Array
    load: Array
    ends: Array

    @classmethod
    def empty(cls, intervals: int, dtype: type) -> Factors:
        """Zeros for N = `intervals`."""
        N = intervals
        shapes = ((N, 3, 3), (N, 3, 3), (N + 2, 6, 6), (N + 2, 6, 6), (N + 2, 6, 6), (N + 2, 6), (N, 3), (N, 3),
                  (2, 3))  # fmt: skip
        return cls(*(np.zeros(shape, dtype) for shape in shapes))


@inner
def widths(factors: Factors) -> tuple[int, int]:
    """In space."""
    return 3, 3


@inner
def invert3(P: Array, X: Array) -> bool:
    """Write P^-1 (3, 3) into X; False if P is singular."""
    a = P[1, 1] * P[2, 2] - P[1, 2] * P[2, 1]
    b = P[1, 2] * P[2, 0] - P[1, 0] * P[2, 2]
    c = P[1, 0] * P[2, 1] - P[1, 1] * P[2, 0]
    determinant = P[0, 0] * a + P[0, 1] * b + P[0, 2] * c
    if not abs(determinant) > 0.0:
        return False
    d = 1.0 / determinant
    X[0, 0], X[1, 0], X[2, 0] = a * d, b * d, c * d
    X[0, 1] = (P[0, 2] * P[2, 1] - P[0, 1] * P[2, 2]) * d
    X[1, 1] = (P[0, 0] * P[2, 2] - P[0, 2] * P[2, 0]) * d
    X[2, 1] = (P[0, 1] * P[2, 0] - P[0, 0] * P[2, 1]) * d
    X[0, 2] = (P[0, 1] * P[1, 2] - P[0, 2] * P[1, 1]) * d
    X[1, 2] = (P[0, 2] * P[1, 0] - P[0, 0] * P[1, 2]) * d
    X[2, 2] = (P[0, 0] * P[1, 1] - P[0, 1] * P[1, 0]) * d
    return True


@inner
def _translate(chain: Chain, tangents: Tangents, eigenvalue: complex, P: Array, factors: Factors) -> None:
    """Write X and Y of all segments."""
    square = eigenvalue * eigenvalue
    for j in range(len(chain.mass)):
        for k in range(3):
            for m in range(3):
                P[k, m] = tangents.M[j, k, m] * square + tangents.C[j, k, m] * eigenvalue + tangents.K[j, k, m]
        invert3(P, factors.X[j])
        X, Y = factors.X[j], factors.Y[j]
        for k in range(3):
            for m in range(3):
                Y[k, m] = X[k, 0] * tangents.E[j, 0, m] + X[k, 1] * tangents.E[j, 1, m] + X[k, 2] * tangents.E[j, 2, m]


@inner
def _open(tangents: Tangents, a: int, lower: Array, D: Array, upper: Array) -> None:
    """Add what openings do to the blocks of a row in the middle of the chain."""
    here, before = tangents.opens[a], tangents.opens[a - 1]
    for k in range(3):
        for m in range(3):
            D[3 + k, m] -= here[0, k, m]
            D[m, 3 + k] -= here[0, k, m]
            D[3 + k, 3 + m] -= here[2, k, m]
            upper[3 + k, m] -= here[1, k, m]
            lower[m, 3 + k] -= before[1, k, m]


@inner
def _open_end(driven: Driven, tangents: Tangents, a: int, lower: Array, D: Array, upper: Array) -> None:
    """Add what openings do to the blocks of rows 0, N and N + 1: to loaded rotations, and to held translations."""
    last, side = len(tangents.opens) - 1, 0 if a == 0 else 1
    for m in range(3):
        if a != last and driven.kinds[side, 3 + m] == RATE:
            continue
        for k in range(3):
            if a <= last:
                D[m, 3 + k] -= tangents.opens[a, 0, k, m]
            if a > 0:
                lower[m, 3 + k] -= tangents.opens[a - 1, 1, k, m]
    if a > last:
        return
    R, here = tangents.R[0] if side == 0 else tangents.R[-1], tangents.opens[a]
    for k in range(3):
        kind = driven.kinds[side, k]
        if kind in (RATE_LAB, RATE):
            for n in range(3):
                weight = R[n, k] if kind == RATE else (1.0 if n == k else 0.0)
                for m in range(3):
                    D[3 + k, m] -= weight * here[0, n, m]
                    upper[3 + k, m] -= weight * here[1, n, m]
                    D[3 + k, 3 + m] -= weight * here[2, n, m]


@inner
def _resist(tangents: Tangents, eigenvalue: complex, a: int, k: int, lower: Array, D: Array, upper: Array) -> None:
    """Add what viscosity does to a component of rotation in the blocks of row a."""
    for m in range(3):
        D[k, m] += tangents.stiff_t[a, k, m] * eigenvalue
        lower[k, m] += tangents.before_t[a, k, m] * eigenvalue
        upper[k, m] += tangents.behind_t[a, k, m] * eigenvalue


@inner
def _fill(chain: Chain, tangents: Tangents, eigenvalue: complex, factors: Factors, a: int,
          lower: Array, D: Array, upper: Array) -> None:  # fmt: skip
    """Write the blocks of row a of a chain that goes on at both sides. The zero blocks of lower and upper stay."""
    half = 0.5 * chain.h
    X, Y, R, ahead = factors.X, factors.Y, tangents.R[a], tangents.R[a + 1]
    before, behind, stiff, spin = tangents.before[a], tangents.behind[a], tangents.stiff[a], tangents.spin[a - 1]
    for k in range(3):
        for m in range(3):
            D[k, m] = stiff[k, m] + spin[k, m] * eigenvalue
            lower[k, m] = before[k, m]
            upper[k, m] = behind[k, m]
            D[3 + k, m] = -Y[a - 1, k, m]
            D[3 + k, 3 + m] = -X[a, k, m] - X[a - 1, k, m]
            lower[3 + k, 3 + m] = X[a - 1, k, m]
            upper[3 + k, 3 + m] = X[a, k, m]
            upper[3 + k, m] = Y[a, k, m]
        D[k, k] += chain.h * chain.inertia[a - 1, k] * eigenvalue * eigenvalue
        # (h/2) T turns by (h/2) R (psi x a3)
        x, y = half * R[k, 0], half * R[k, 1]
        D[3 + k, 0] += y
        D[3 + k, 1] -= x
        D[0, 3 + k], lower[0, 3 + k] = y, y
        D[1, 3 + k], lower[1, 3 + k] = -x, -x
        D[2, 3 + k], lower[2, 3 + k] = 0.0, 0.0
        upper[3 + k, 0] += half * ahead[k, 1]
        upper[3 + k, 1] -= half * ahead[k, 0]
    if is_viscous(chain.elastic):
        for k in range(3):
            _resist(tangents, eigenvalue, a, k, lower, D, upper)
    if stretches(chain.elastic):
        _open(tangents, a, lower, D, upper)


@inner
def _fill_end(chain: Chain, driven: Driven, tangents: Tangents, eigenvalue: complex, factors: Factors, a: int,
              lower: Array, D: Array, upper: Array) -> None:  # fmt: skip
    """Write the blocks of rows 0, N and N + 1: those of the ends' frames and of the forces at the ends."""
    N, half = len(chain.mass), 0.5 * chain.h
    X, Y = factors.X, factors.Y
    side = 0 if a == 0 else 1
    D[:, :] = 0.0
    upper[:, :] = 0.0
    lower[:, :] = 0.0
    for k in range(3):
        held = a != N and driven.kinds[side, 3 + k] == RATE
        for m in range(3):
            if held:
                D[k, m] = 1.0 if k == m else 0.0
            else:
                D[k, m] = tangents.stiff[a, k, m]
                lower[k, m] = tangents.before[a, k, m]
                upper[k, m] = tangents.behind[a, k, m]
        if is_viscous(chain.elastic) and not held:
            _resist(tangents, eigenvalue, a, k, lower, D, upper)
        if a == N:
            D[k, k] += chain.h * chain.inertia[a - 1, k] * eigenvalue * eigenvalue
            x, y = half * tangents.R[a, k, 0], half * tangents.R[a, k, 1]
            D[0, 3 + k], lower[0, 3 + k], D[3 + k, 0] = y, y, y
            D[1, 3 + k], lower[1, 3 + k], D[3 + k, 1] = -x, -x, -x
            for m in range(3):
                D[k, m] += tangents.spin[a - 1, k, m] * eigenvalue
                D[3 + k, 3 + m] -= X[a - 1, k, m]
                lower[3 + k, 3 + m] += X[a - 1, k, m]
                D[3 + k, m] -= Y[a - 1, k, m]
        elif a == 0:
            upper[3 + k, 0], upper[3 + k, 1] = half * tangents.R[1, k, 1], -half * tangents.R[1, k, 0]
            for m in range(3):
                D[3 + k, 3 + m] -= X[0, k, m]
                upper[3 + k, 3 + m] += X[0, k, m]
                upper[3 + k, m] += Y[0, k, m]
        else:
            D[3 + k, 3 + k] = 1.0
    if a == 0:
        _condition(driven, tangents, eigenvalue, 0, D, upper, D, lower)
    elif a == N:
        _condition(driven, tangents, eigenvalue, 1, D, lower, upper, upper)
    if stretches(chain.elastic):
        _open_end(driven, tangents, a, lower, D, upper)


@inner
def _condition(driven: Driven, tangents: Tangents, eigenvalue: complex, side: int,
               D: Array, neighbour: Array, frame: Array, other: Array) -> None:  # fmt: skip
    """Turn the rows "the end stays where it is" in D and `neighbour` into the end's conditions.

    `frame` is the block that holds the rotation of the end's own frame; `other` is emptied of what is not the frame's.
    """
    R = tangents.R[0] if side == 0 else tangents.R[-1]
    before = scratch_like((2, 3, 6), D)
    rows, beside = before[0], before[1]
    copy(D[3:], rows)
    copy(neighbour[3:], beside)
    sign = 1.0 if side == 0 else -1.0
    for k in range(3):
        kind = driven.kinds[side, k]
        for m in range(6):
            D[3 + k, m] = 0.0
            neighbour[3 + k, m] = 0.0
            other[3 + k, m] = 0.0
        if kind in (RATE_LAB, RATE):
            for n in range(3):
                weight = R[n, k] if kind == RATE else (1.0 if n == k else 0.0)
                for m in range(6):
                    D[3 + k, m] += weight * rows[n, m]
                    neighbour[3 + k, m] += weight * beside[n, m]
                for m in range(3):
                    D[3 + k, 3 + m] -= weight * driven.compliance[side] * R[n, 2] * R[m, 2]
            for m in range(3):
                frame[3 + k, m] += sign * tangents.turn[side, k, m] / eigenvalue
        else:
            for n in range(3):
                D[3 + k, 3 + n] = R[n, k] if kind == LOAD else (1.0 if n == k else 0.0)
            for m in range(3):
                frame[3 + k, m] += tangents.turn[side, k, m]


@inner
def _opened(tangents: Tangents, factors: Factors, a: int, k: int) -> complex:
    """Component k of delta (e t) of joint a in the solution."""
    opens, x, y = tangents.opens[a], factors.x[a], factors.x[a + 1]
    moved: complex = 0.0 * x[0]
    for m in range(3):
        moved += opens[0, k, m] * x[m] + opens[1, k, m] * y[m] + opens[2, k, m] * x[3 + m]
    return moved


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
    E, P = room[0:3, 0:3], room[3:6, 0:3]
    for k in range(3):
        for m in range(3):
            E[k, m] = D[3 + k, 3 + m]
    if not invert3(E, P):
        return False
    # (P C) into the lower left block, (B P) into the upper right one, for now
    _times(room, 3, 0, D, 3, 0, inverse, 3, 0)
    _times(D, 0, 3, room, 3, 0, inverse, 0, 3)
    for k in range(3):
        for m in range(3):
            E[k, m] = D[k, m]
    _subtract_times(D, 0, 3, inverse, 3, 0, room, 0, 0)
    S = inverse[0:3, 0:3]
    if not invert3(E, S):
        return False
    # S B P into room, then P + P C (S B P)
    _times(inverse, 0, 0, inverse, 0, 3, room, 0, 3)
    for k in range(3):
        for m in range(3):
            inverse[3 + k, 3 + m] = P[k, m]
            room[3 + k, 3 + m] = -inverse[3 + k, m]
            inverse[k, 3 + m] = -room[k, 3 + m]
    _subtract_times(room, 3, 3, room, 0, 3, inverse, 3, 3)
    _times(room, 3, 3, inverse, 0, 0, inverse, 3, 0)
    return True


@kernel
def factor(chain: Chain, driven: Driven, tangents: Tangents, eigenvalue: complex, factors: Factors) -> bool:
    """Factor the system for one eigenvalue; False if it is singular."""
    blocks = scratch_like((3, 6, 6), factors.lower)
    D, upper, room = blocks[0], blocks[1], blocks[2]
    _translate(chain, tangents, eigenvalue, D, factors)
    last = len(factors.lower) - 1
    for a in range(last + 1):
        lower = factors.lower[a]
        if 0 < a < last - 1:
            _fill(chain, tangents, eigenvalue, factors, a, lower, D, upper)
        else:
            _fill_end(chain, driven, tangents, eigenvalue, factors, a, lower, D, upper)
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


@kernel
def complete(chain: Chain, driven: Driven, tangents: Tangents, eigenvalue: complex, factors: Factors) -> None:
    """Write the rows of F into x and condition the ends; rotation, with minus, is there."""
    N = len(chain.mass)
    X, b, load, ends = factors.X, factors.x, factors.load, factors.ends
    for side in range(2):
        frame = 0 if side == 0 else N + 1
        for k in range(3):
            if driven.kinds[side, 3 + k] == RATE:
                b[frame, k] /= eigenvalue
            elif side == 0:
                b[frame, k] = -b[frame, k]
    for k in range(3):
        b[0, 3 + k] = 0.0
        b[N + 1, 3 + k] = 0.0
    for j in range(N):
        for k in range(3):
            moved = X[j, k, 0] * load[j, 0] + X[j, k, 1] * load[j, 1] + X[j, k, 2] * load[j, 2]
            b[j, 3 + k] += moved
            b[j + 1, 3 + k] = -moved
    for side in range(2):
        node, R = (0, tangents.R[0]) if side == 0 else (N, tangents.R[N + 1])
        x, y, z = b[node, 3], b[node, 4], b[node, 5]
        sign = 1.0 if side == 0 else -1.0
        for k in range(3):
            kind = driven.kinds[side, k]
            if kind == RATE:
                b[node, 3 + k] = R[0, k] * x + R[1, k] * y + R[2, k] * z - sign * ends[side, k] / eigenvalue
            elif kind == RATE_LAB:
                b[node, 3 + k] -= sign * ends[side, k] / eigenvalue
            else:
                b[node, 3 + k] = -ends[side, k]


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
    _displace(factors)


@inner
def _displace(factors: Factors) -> None:
    """Write the displacements of the centres that belong to the solution."""
    x, X, Y = factors.x, factors.X, factors.Y
    for j in range(len(factors.moved)):
        psi, near, far, load = x[j + 1], x[j], x[j + 1], factors.load[j]
        u, v, w = far[3] - near[3] - load[0], far[4] - near[4] - load[1], far[5] - near[5] - load[2]
        for k in range(3):
            factors.moved[j, k] = (X[j, k, 0] * u + X[j, k, 1] * v + X[j, k, 2] * w
                                   + (Y[j, k, 0] * psi[0] + Y[j, k, 1] * psi[1] + Y[j, k, 2] * psi[2]))  # fmt: skip


@inner
def node_moves(chain: Chain, tangents: Tangents, factors: Factors, node: int, k: int) -> complex:
    """Component k of a node's displacement in the solution."""
    j, side = (node - 1, 1.0) if node > 0 else (0, -1.0)
    R, x = tangents.R[j + 1], factors.x[j + 1]
    moved: complex = factors.moved[j, k] + side * 0.5 * chain.h * (R[k, 0] * x[1] - R[k, 1] * x[0])
    if stretches(chain.elastic):
        moved += side * share(node, len(chain.mass)) * _opened(tangents, factors, node, k)
    return moved


@kernel
def update(chain: Chain, transform: Array, unit: float, fraction: float, stages: Stages, tangents: Tangents,
           real: Factors, pair: Factors) -> tuple[float, float, float]:  # fmt: skip
    """Add a fraction of the increments to the stages; return their size: rotation (rad), force by the largest one, and
    displacement of the start (m)."""
    T = transform
    turned, forced, shifted, largest = 0.0, 0.0, 0.0, unit
    for i in range(STAGES):
        t0, t1, t2 = fraction * T[i, 0], fraction * T[i, 1], fraction * T[i, 2]
        for a in range(stages.theta.shape[1]):
            x, z = real.x[a], pair.x[a]
            c0 = t0 * x[0] + t1 * z[0].real + t2 * z[0].imag
            c1 = t0 * x[1] + t1 * z[1].real + t2 * z[1].imag
            c2 = t0 * x[2] + t1 * z[2].real + t2 * z[2].imag
            Q, R = stages.R[i, a], stages.start[a]
            cosine, sine = tangents.spun[i, a, 0], tangents.spun[i, a, 1]
            c0, c1 = cosine * c0 + sine * c1, cosine * c1 - sine * c0
            u = Q[0, 0] * c0 + Q[0, 1] * c1 + Q[0, 2] * c2
            v = Q[1, 0] * c0 + Q[1, 1] * c1 + Q[1, 2] * c2
            w = Q[2, 0] * c0 + Q[2, 1] * c1 + Q[2, 2] * c2
            p0 = R[0, 0] * u + R[1, 0] * v + R[2, 0] * w
            p1 = R[0, 1] * u + R[1, 1] * v + R[2, 1] * w
            p2 = R[0, 2] * u + R[1, 2] * v + R[2, 2] * w
            theta = stages.theta[i, a]
            u, v, w = theta[0], theta[1], theta[2]
            # a rotation by p in the frame of R_n changes theta by p - theta x p / 2 + ...
            c0, c1, c2 = v * p2 - w * p1, w * p0 - u * p2, u * p1 - v * p0
            theta[0] += p0 - 0.5 * c0 + (1 / 12) * (v * c2 - w * c1)
            theta[1] += p1 - 0.5 * c1 + (1 / 12) * (w * c0 - u * c2)
            theta[2] += p2 - 0.5 * c2 + (1 / 12) * (u * c1 - v * c0)
            turned = max(turned, abs(p0), abs(p1), abs(p2))
            if not np.isfinite(p0):
                return np.inf, np.inf, np.inf
        for a in range(stages.F.shape[1]):
            for k in range(3):
                change = t0 * real.x[a, 3 + k] + t1 * pair.x[a, 3 + k].real + t2 * pair.x[a, 3 + k].imag
                stages.F[i, a, k] += change
                forced = max(forced, abs(change))
                largest = max(largest, abs(stages.F[i, a, k]))
        for k in range(3):
            z0 = node_moves(chain, tangents, pair, 0, k)
            moved = t0 * node_moves(chain, tangents, real, 0, k).real + t1 * z0.real + t2 * z0.imag
            stages.shift[i, k] += moved
            shifted = max(shifted, abs(moved))
    return turned / fraction, forced / (fraction * largest), shifted / fraction
