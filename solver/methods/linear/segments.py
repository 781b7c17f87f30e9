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
from solver.physics.ends import LOAD, RATE, RATE_LAB, Kinds


class Factors(NamedTuple):
    """The factored system: `X`, `Y` = X E (N + 2, 3, 3), 0 of the ends' frames; `lower`, `inverse` of the reduced
    diagonal, `upper` = inverse times the blocks above (N + 2, 6, 6); right-hand side and solution `x` (N + 2, 6);
    `moved` (N, 3): displacements of the centres; `load` (N, 3), `ends` (2, 3): the residuals of translation and of the
    ends' conditions."""

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
        N, n = intervals, intervals + 2
        shapes = (n, 3, 3), (n, 3, 3), (n, 6, 6), (n, 6, 6), (n, 6, 6), (n, 6), (N, 3), (N, 3), (2, 3)
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
        X, Y = factors.X[j + 1], factors.Y[j + 1]
        invert3(P, X)
        for k in range(3):
            for m in range(3):
                Y[k, m] = X[k, 0] * tangents.E[j, 0, m] + X[k, 1] * tangents.E[j, 1, m] + X[k, 2] * tangents.E[j, 2, m]


@inner
def write_row(chain: Chain, driven: Driven, tangents: Tangents, eigenvalue: complex, factors: Factors, a: int,
              lower: Array, D: Array, upper: Array) -> None:  # fmt: skip
    """Write the blocks (6, 6) of row a, before, on and behind the diagonal, once the segments' X and Y are there: of
    the rotation of orientation a, and of the joint at node a. The zero blocks of lower and upper stay."""
    N = len(chain.mass)
    _fill(chain, tangents, eigenvalue, factors, a, lower, D, upper)
    if is_viscous(chain.elastic):
        for k in range(3):
            _resist(tangents, eigenvalue, a, k, lower, D, upper)
    if stretches(chain.elastic):
        _open(tangents, a, lower, D, upper)
    if a in (0, N + 1):
        _hold(driven.kinds[0 if a == 0 else 1], lower, D, upper)
    if a == 0:
        _condition(driven, tangents, eigenvalue, 0, lower, D, upper, D)
    elif a == N:
        _condition(driven, tangents, eigenvalue, 1, lower, D, upper, upper)
    elif a > N:  # there is no force
        for k in range(3):
            D[3 + k, 3 + k] = 1.0


@inner
def _fill(chain: Chain, tangents: Tangents, eigenvalue: complex, factors: Factors, a: int,
          lower: Array, D: Array, upper: Array) -> None:  # fmt: skip
    """Write what stiffness, inertia and the levers of the segments at node a, one at an end, do to row a."""
    N, b = len(chain.mass), min(a + 1, len(chain.mass) + 1)
    half, half_ahead = 0.5 * chain.h if 0 < a <= N else 0.0, 0.5 * chain.h if b <= N else 0.0
    X, Y, R = factors.X[a], factors.Y[a], tangents.R[a]
    X_ahead, Y_ahead, R_ahead = factors.X[b], factors.Y[b], tangents.R[b]
    before, behind, stiff = tangents.before[a], tangents.behind[a], tangents.stiff[a]
    for k in range(3):
        for m in range(3):
            D[k, m] = stiff[k, m]
            lower[k, m] = before[k, m]
            upper[k, m] = behind[k, m]
            D[3 + k, m] = -Y[k, m]
            D[3 + k, 3 + m] = -X_ahead[k, m] - X[k, m]
            lower[3 + k, 3 + m] = X[k, m]
            upper[3 + k, 3 + m] = X_ahead[k, m]
            upper[3 + k, m] = Y_ahead[k, m]
        # (h/2) T turns by (h/2) R (psi x a3)
        x, y = half * R[k, 0], half * R[k, 1]
        D[3 + k, 0] += y
        D[3 + k, 1] -= x
        D[0, 3 + k], lower[0, 3 + k] = y, y
        D[1, 3 + k], lower[1, 3 + k] = -x, -x
        D[2, 3 + k], lower[2, 3 + k] = 0.0, 0.0
        upper[3 + k, 0] += half_ahead * R_ahead[k, 1]
        upper[3 + k, 1] -= half_ahead * R_ahead[k, 0]
    if 0 < a <= N:
        inertia, spin = chain.inertia[a - 1], tangents.spin[a - 1]
        for k in range(3):
            D[k, k] += chain.h * inertia[k] * eigenvalue * eigenvalue
            for m in range(3):
                D[k, m] += spin[k, m] * eigenvalue


@inner
def _resist(tangents: Tangents, eigenvalue: complex, a: int, k: int, lower: Array, D: Array, upper: Array) -> None:
    """Add what viscosity does to a component of rotation in the blocks of row a."""
    for m in range(3):
        D[k, m] += tangents.stiff_t[a, k, m] * eigenvalue
        lower[k, m] += tangents.before_t[a, k, m] * eigenvalue
        upper[k, m] += tangents.behind_t[a, k, m] * eigenvalue


@inner
def _open(tangents: Tangents, a: int, lower: Array, D: Array, upper: Array) -> None:
    """Add what openings do to the blocks of row a."""
    if a < len(tangents.opens):
        here = tangents.opens[a]
        for k in range(3):
            for m in range(3):
                D[3 + k, m] -= here[0, k, m]
                D[m, 3 + k] -= here[0, k, m]
                D[3 + k, 3 + m] -= here[2, k, m]
                upper[3 + k, m] -= here[1, k, m]
    if a > 0:
        before = tangents.opens[a - 1]
        for k in range(3):
            for m in range(3):
                lower[m, 3 + k] -= before[1, k, m]


@inner
def _hold(kinds: Kinds, lower: Array, D: Array, upper: Array) -> None:
    """Hold the components of the rotation of an end's frame that are not loaded."""
    for k in range(3):
        if kinds[3 + k] == RATE:
            for m in range(6):
                lower[k, m], D[k, m], upper[k, m] = 0.0, 0.0, 0.0
            D[k, k] = 1.0


@inner
def _condition(driven: Driven, tangents: Tangents, eigenvalue: complex, side: int,
               lower: Array, D: Array, upper: Array, frame: Array) -> None:  # fmt: skip
    """Turn the rows "the end stays where it is" into the end's conditions. `frame` is the block that holds the rotation
    of the end's own frame."""
    R = tangents.R[0] if side == 0 else tangents.R[-1]
    rows = scratch_like((3, 3, 6), D)
    copy(lower[3:], rows[0])
    copy(D[3:], rows[1])
    copy(upper[3:], rows[2])
    for k in range(3):
        kind = driven.kinds[side, k]
        held = kind in (RATE_LAB, RATE)
        part = 1.0 + 0.0 * eigenvalue if held else -driven.mass[side] * eigenvalue * eigenvalue
        for m in range(6):
            lower[3 + k, m], D[3 + k, m], upper[3 + k, m] = 0.0, 0.0, 0.0
        for n in range(3):
            axis = _axis(R, kind, k, n)
            for m in range(6):
                lower[3 + k, m] += part * axis * rows[0, n, m]
                D[3 + k, m] += part * axis * rows[1, n, m]
                upper[3 + k, m] += part * axis * rows[2, n, m]
            if held:
                for m in range(3):
                    D[3 + k, 3 + m] -= axis * driven.compliance[side] * R[n, 2] * R[m, 2]
            else:
                D[3 + k, 3 + n] += axis
        for m in range(3):
            turn = tangents.turn[side, k, m]
            frame[3 + k, m] += (turn if side == 0 else -turn) / eigenvalue if held else turn


@inlined
def _axis(R: Array, kind: int, k: int, n: int) -> float:
    """Component n of the axis, lab, of condition k on the translation of an end with rotation R."""
    if kind in (RATE, LOAD):
        return R[n, k]  # type: ignore[no-any-return]
    return 1.0 if n == k else 0.0
