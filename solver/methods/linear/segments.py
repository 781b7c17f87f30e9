"""Newton's linear system of segments in space: its rows, for one eigenvalue lambda of the time scheme, real or complex.

Unknown at block a = 0 ... N + 1: the rotation psi of orientation a and the force F at node a (none in the last block).
A segment's displacement is eliminated by its own balance: with P = M lambda^2 + C lambda + K and X = P^-1,

    delta r_j = X (delta F_j+1 - delta F_j + E psi - residual),

and what remains of translation is that neighbours stay joined: delta r_j+1 - delta r_j = d(h/2 T_j + h/2 T_j+1).
Where the rod can stretch, delta (e t) comes to the right, and its transpose to the rows of psi: see `Tangents.opens`.
Where it resists rates, lambda times its tangents stand beside those of its stiffness.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from solver.arrays import Array
from solver.kernels.copying import copy
from solver.kernels.kernel import inlined, inner
from solver.kernels.scratch import scratch_like
from solver.methods.space.segments.balances import Driven, Tangents
from solver.methods.space.segments.chain import Chain
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
def translate(chain: Chain, tangents: Tangents, eigenvalue: complex, P: Array, factors: Factors) -> None:
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
def write_row(chain: Chain, driven: Driven, tangents: Tangents, eigenvalue: complex, factors: Factors, a: int,
              lower: Array, D: Array, upper: Array) -> None:  # fmt: skip
    """Write the blocks (6, 6) of row a, before, on and behind the diagonal, once the segments' X and Y are there."""
    if 0 < a < len(chain.mass):
        _fill(chain, tangents, eigenvalue, factors, a, lower, D, upper)
    else:
        _fill_end(chain, driven, tangents, eigenvalue, factors, a, lower, D, upper)


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


@inlined
def _axis(R: Array, kind: int, k: int, n: int) -> float:
    """Component n of the axis, lab, of condition k on the translation of an end with rotation R."""
    if kind in (RATE, LOAD):
        return R[n, k]  # type: ignore[no-any-return]
    return 1.0 if n == k else 0.0


@inner
def _open_end(driven: Driven, tangents: Tangents, eigenvalue: complex, a: int, lower: Array, D: Array,
              upper: Array) -> None:  # fmt: skip
    """Add what openings do to the blocks of rows 0, N and N + 1: to loaded rotations, and to held translations or those
    of a body."""
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
        part = 1.0 + 0.0 * eigenvalue if kind in (RATE_LAB, RATE) else _inertia(driven, eigenvalue, side)
        if part != 0.0:
            for n in range(3):
                weight = part * _axis(R, kind, k, n)
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
        _open_end(driven, tangents, eigenvalue, a, lower, D, upper)


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
                weight = _axis(R, kind, k, n)
                for m in range(6):
                    D[3 + k, m] += weight * rows[n, m]
                    neighbour[3 + k, m] += weight * beside[n, m]
                for m in range(3):
                    D[3 + k, 3 + m] -= weight * driven.compliance[side] * R[n, 2] * R[m, 2]
            for m in range(3):
                frame[3 + k, m] += sign * tangents.turn[side, k, m] / eigenvalue
        else:
            inertia = _inertia(driven, eigenvalue, side)
            for n in range(3):
                weight = _axis(R, kind, k, n)
                D[3 + k, 3 + n] += weight
                if inertia != 0.0:
                    for m in range(6):
                        D[3 + k, m] += inertia * weight * rows[n, m]
                        neighbour[3 + k, m] += inertia * weight * beside[n, m]
            for m in range(3):
                frame[3 + k, m] += tangents.turn[side, k, m]


@inner
def _inertia(driven: Driven, eigenvalue: complex, side: int) -> complex:
    """What the rows "the end stays where it is" count for in those of a loaded end: the inertia of its body."""
    inertia: complex = -driven.mass[side] * eigenvalue * eigenvalue
    return inertia
