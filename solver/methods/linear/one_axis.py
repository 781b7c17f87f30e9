"""Newton's linear system about one axis: that of `segments` with 3 x 3 blocks.

Unknown at block a = 0 ... N + 1: the rotation psi of orientation a and the force F at node a, as a pair (none in the
last block). With P = M lambda^2 + C lambda + K and X = P^-1, a segment moves by

    delta r_j = X (delta F_j+1 - delta F_j + E psi - residual).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from solver.arrays import Array
from solver.kernels.copying import copy
from solver.kernels.kernel import inlined_late, inner, kernel
from solver.kernels.scratch import scratch_like
from solver.methods.linear.segments import invert3
from solver.methods.space.one_axis.balances import Driven, Tangents
from solver.methods.space.one_axis.chain import Chain, Residuals, Stages
from solver.methods.space.segments.chain import STAGES
from solver.physics.ends import LOAD, LOAD_LAB, RATE


class Factors(NamedTuple):
    """The factored system: `X` (N, 2, 2), `Y` = X E (N, 2); `lower`, `inverse` of the reduced diagonal, `upper` =
    inverse times the blocks above (N + 2, 3, 3); right-hand side and solution `x` (N + 2, 3); `moved` (N, 2):
    displacements of the centres; `load` (N, 2), `ends` (2, 2): residuals of translation and of the ends' conditions."""

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
        shapes = ((N, 2, 2), (N, 2), (N + 2, 3, 3), (N + 2, 3, 3), (N + 2, 3, 3), (N + 2, 3), (N, 2), (N, 2),
                  (2, 2))  # fmt: skip
        return cls(*(np.zeros(shape, dtype) for shape in shapes))


@inner
def widths(factors: Factors) -> tuple[int, int]:
    """In the plane of an axis."""
    return 1, 2


@inner
def _translate(tangents: Tangents, eigenvalue: complex, factors: Factors) -> None:
    """Write X and Y of all segments."""
    square = eigenvalue * eigenvalue
    for j in range(len(tangents.M)):
        M, C, K, E, X, Y = tangents.M[j], tangents.C[j], tangents.K[j], tangents.E[j], factors.X[j], factors.Y[j]
        a, b = M[0, 0] * square + C[0, 0] * eigenvalue + K[0, 0], M[0, 1] * square + C[0, 1] * eigenvalue + K[0, 1]
        c, d = M[1, 0] * square + C[1, 0] * eigenvalue + K[1, 0], M[1, 1] * square + C[1, 1] * eigenvalue + K[1, 1]
        inverse = 1.0 / (a * d - b * c)
        X[0, 0], X[0, 1], X[1, 0], X[1, 1] = d * inverse, -b * inverse, -c * inverse, a * inverse
        Y[0], Y[1] = X[0, 0] * E.real + X[0, 1] * E.imag, X[1, 0] * E.real + X[1, 1] * E.imag


@inner
def _fill(chain: Chain, tangents: Tangents, eigenvalue: complex, factors: Factors) -> None:
    """Write the blocks of all rows as if the ends were loaded in rotation and held in place."""
    N, half = len(chain.mass), 0.5 * chain.h * chain.swing
    lower, D, upper = factors.lower, factors.inverse, factors.upper
    for a in range(N + 2):
        for k in range(3):
            for m in range(3):
                lower[a, k, m], D[a, k, m], upper[a, k, m] = 0.0, 0.0, 0.0
        D[a, 0, 0] = tangents.stiff[a]
    for i in range(N + 1):
        viscous = tangents.spring_t[i] * eigenvalue
        D[i, 0, 0] += viscous
        D[i + 1, 0, 0] += viscous
        upper[i, 0, 0] = -tangents.spring[i] - viscous
        lower[i + 1, 0, 0] = upper[i, 0, 0]
    for j in range(N):
        a, X, Y, T = j + 1, factors.X[j], factors.Y[j], tangents.T[j + 1]
        D[a, 0, 0] += (chain.h * chain.inertia[j] * eigenvalue + tangents.spin[j]) * eigenvalue
        # (h/2) T turns by (h/2) i T psi
        x, y = half * T.imag, -half * T.real
        D[a, 0, 1], D[a, 0, 2], lower[a, 0, 1], lower[a, 0, 2] = x, y, x, y
        D[a, 1, 0], D[a, 2, 0] = x - Y[0], y - Y[1]
        upper[j, 1, 0], upper[j, 2, 0] = x + Y[0], y + Y[1]
        for k in range(2):
            for m in range(2):
                D[j, 1 + k, 1 + m] -= X[k, m]
                D[a, 1 + k, 1 + m] = -X[k, m]
                lower[a, 1 + k, 1 + m], upper[j, 1 + k, 1 + m] = X[k, m], X[k, m]
    D[N + 1, 1, 1], D[N + 1, 2, 2] = 1.0, 1.0


@inner
def _fill_ends(driven: Driven, tangents: Tangents, eigenvalue: complex, factors: Factors) -> None:
    """Put the ends' conditions in place."""
    lower, D, upper = factors.lower, factors.inverse, factors.upper
    last = len(D) - 1
    for side in range(2):
        if driven.kinds[side, 2] == RATE:
            frame, beside = (0, upper[0]) if side == 0 else (last, lower[last])
            D[frame, 0, 0], beside[0, 0] = 1.0, 0.0
    _condition(driven, tangents, eigenvalue, 0, D[0], upper[0], D[0])
    _condition(driven, tangents, eigenvalue, 1, D[last - 1], lower[last - 1], upper[last - 1])


@inner
def _condition(driven: Driven, tangents: Tangents, eigenvalue: complex, side: int,
               D: Array, neighbour: Array, frame: Array) -> None:  # fmt: skip
    """Turn the rows "the end stays where it is" in D and `neighbour` into the end's conditions.

    `frame` is the block that holds the rotation of the end's own frame.
    """
    before = scratch_like((2, 2, 3), D)
    rows, beside = before[0], before[1]
    copy(D[1:], rows)
    copy(neighbour[1:], beside)
    sign = 1.0 if side == 0 else -1.0
    for k in range(2):
        kind, d = driven.kinds[side, k], direction(driven, tangents, side, k)
        loaded = kind in (LOAD, LOAD_LAB)
        for m in range(3):
            D[1 + k, m] = 0.0 if loaded else d.real * rows[0, m] + d.imag * rows[1, m]
            neighbour[1 + k, m] = 0.0 if loaded else d.real * beside[0, m] + d.imag * beside[1, m]
        if loaded:
            D[1 + k, 1], D[1 + k, 2] = d.real, d.imag
            frame[1 + k, 0] += tangents.turn[side, k]
        else:
            frame[1 + k, 0] += sign * tangents.turn[side, k] / eigenvalue


@kernel
def direction(driven: Driven, tangents: Tangents, side: int, k: int) -> complex:
    """Direction of a condition on an end's translation in the lab."""
    T = tangents.T[0] if side == 0 else tangents.T[-1]
    return complex(driven.direction[side, k] * (T if driven.kinds[side, k] in (RATE, LOAD) else 1.0))


@inlined_late
def _times(A: Array, x: tuple) -> tuple:  # type: ignore[type-arg]
    """A (3, 3) times x (3)."""
    return (A[0, 0] * x[0] + A[0, 1] * x[1] + A[0, 2] * x[2],
            A[1, 0] * x[0] + A[1, 1] * x[1] + A[1, 2] * x[2],
            A[2, 0] * x[0] + A[2, 1] * x[1] + A[2, 2] * x[2])  # fmt: skip


@inner
def _reduce(lower: Array, inverse: Array, upper: Array) -> bool:
    """Eliminate downwards: from the diagonal blocks to the inverses of the reduced ones, `upper` times by them."""
    D = scratch_like((3, 3), inverse)
    for a in range(len(inverse)):
        X, W = inverse[a], upper[a]
        for m in range(3):
            x, y, z = X[0, m], X[1, m], X[2, m]
            if a > 0:
                before = upper[a - 1]
                u, v, w = _times(lower[a], (before[0, m], before[1, m], before[2, m]))
                x, y, z = x - u, y - v, z - w
            D[0, m], D[1, m], D[2, m] = x, y, z
        if not invert3(D, X):
            return False
        for m in range(3):
            W[0, m], W[1, m], W[2, m] = _times(X, (W[0, m], W[1, m], W[2, m]))
    return True


@kernel
def factor(chain: Chain, driven: Driven, tangents: Tangents, eigenvalue: complex, factors: Factors) -> bool:
    """Factor the system for one eigenvalue; False if it is singular."""
    _translate(tangents, eigenvalue, factors)
    _fill(chain, tangents, eigenvalue, factors)
    _fill_ends(driven, tangents, eigenvalue, factors)
    return bool(_reduce(factors.lower, factors.inverse, factors.upper))


@kernel
def complete(chain: Chain, driven: Driven, tangents: Tangents, eigenvalue: complex, factors: Factors) -> None:
    """Write the rows of F into x and condition the ends; rotation, with minus, is there."""
    N, X, b, load, ends = len(chain.mass), factors.X, factors.x, factors.load, factors.ends
    for side in range(2):
        frame = 0 if side == 0 else N + 1
        if driven.kinds[side, 2] == RATE:
            b[frame, 0] /= eigenvalue
        elif side == 0:
            b[frame, 0] = -b[frame, 0]
        b[frame, 1] = 0.0
        b[frame, 2] = 0.0
    for j in range(N):
        for k in range(2):
            moved = X[j, k, 0] * load[j, 0] + X[j, k, 1] * load[j, 1]
            b[j, 1 + k] += moved
            b[j + 1, 1 + k] = -moved
    for side in range(2):
        node, sign = (0, 1.0) if side == 0 else (N, -1.0)
        x, y = b[node, 1], b[node, 2]
        for k in range(2):
            d = direction(driven, tangents, side, k)
            if driven.kinds[side, k] in (LOAD, LOAD_LAB):
                b[node, 1 + k] = -ends[side, k]
            else:
                b[node, 1 + k] = d.real * x + d.imag * y - sign * ends[side, k] / eigenvalue


@kernel
def solve(factors: Factors) -> None:
    """Replace the right-hand side in x by the solution, and write the displacements of the centres."""
    x, X, Y, n = factors.x, factors.X, factors.Y, len(factors.x)
    zero = 0.0 * x[0, 0]
    last = (zero, zero, zero)
    for a in range(n):
        b, before = x[a], _times(factors.lower[a], last)
        last = _times(factors.inverse[a], (b[0] - before[0], b[1] - before[1], b[2] - before[2]))
        b[0], b[1], b[2] = last
    for a in range(n - 2, -1, -1):
        b, behind = x[a], _times(factors.upper[a], last)
        last = (b[0] - behind[0], b[1] - behind[1], b[2] - behind[2])
        b[0], b[1], b[2] = last
    for j in range(len(factors.moved)):
        p, q = x[j + 1, 1] - x[j, 1] - factors.load[j, 0], x[j + 1, 2] - x[j, 2] - factors.load[j, 1]
        for k in range(2):
            factors.moved[j, k] = X[j, k, 0] * p + X[j, k, 1] * q + Y[j, k] * x[j + 1, 0]


@kernel
def solve_with_contact(chain: Chain, driven: Driven, tangents: Tangents, transform: Array, gamma: float, lam: complex,
                       residuals: Residuals, real: Factors, pair: Factors, touch: None, coupling: None,
                       first: bool, fresh: bool) -> float:  # fmt: skip
    """There is no contact."""
    return 1.0


@kernel
def update(chain: Chain, transform: Array, unit: float, fraction: float, stages: Stages, tangents: Tangents,
           real: Factors, pair: Factors) -> tuple[float, float, float]:  # fmt: skip
    """Add a fraction of the increments to the stages; return their size: rotation (rad), force by the largest one, and
    displacement of the start (m)."""
    T, x, z, half = transform, real.x, pair.x, 0.5 * chain.h * chain.swing
    turned, forced, shifted, largest = 0.0, 0.0, 0.0, unit
    for i in range(STAGES):
        t0, t1, t2 = fraction * T[i, 0], fraction * T[i, 1], fraction * T[i, 2]
        for a in range(len(x)):
            psi = t0 * x[a, 0] + t1 * z[a, 0].real + t2 * z[a, 0].imag
            if not np.isfinite(psi):
                return np.inf, np.inf, np.inf
            stages.theta[i, a] += psi
            turned = max(turned, abs(psi))
        for a in range(len(x) - 1):
            change = complex(t0 * x[a, 1] + t1 * z[a, 1].real + t2 * z[a, 1].imag,
                             t0 * x[a, 2] + t1 * z[a, 2].real + t2 * z[a, 2].imag)  # fmt: skip
            stages.F[i, a] += change
            forced = max(forced, abs(change.real), abs(change.imag))
            largest = max(largest, abs(stages.F[i, a].real), abs(stages.F[i, a].imag))
        # the start lies half a segment before the first centre
        psi = t0 * x[1, 0] + t1 * z[1, 0].real + t2 * z[1, 0].imag
        p, q = real.moved[0], pair.moved[0]
        moved = complex(t0 * p[0] + t1 * q[0].real + t2 * q[0].imag, t0 * p[1] + t1 * q[1].real + t2 * q[1].imag)
        moved -= half * psi * 1j * tangents.T[1]
        stages.shift[i] += moved
        shifted = max(shifted, abs(moved))
    return turned / fraction, forced / (fraction * largest), shifted / fraction
