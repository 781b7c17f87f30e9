"""The paper's linear solve: shooting from s = 0.

Six solutions of the homogeneous equations that satisfy the conditions at s = 0, and one of the inhomogeneous, are
marched to s = L, where six coefficients follow from the conditions there. The solutions grow like
exp(L (m / (EJ dt^2))^(1/4)), so that digits are lost on thin rods and at small steps: the growth is returned.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from solver.arrays import Array
from solver.kernels.copying import copy
from solver.kernels.dispatch import variant
from solver.kernels.kernel import inner, kernel
from solver.kernels.scratch import scratch, scratch_like
from solver.methods.linear.panels import Swaps, eliminate
from solver.methods.linear.system import System, factor, solve, solves_again
from solver.methods.space.box.fields import Nodes
from solver.methods.space.box.intervals import MEANS, interval_panel
from solver.methods.space.box.schemes import BOX
from solver.methods.status import CONVERGED, LOST_DIGITS

LARGEST_GROWTH = 1e12
"""Beyond it fewer than four digits are left and Newton's iteration cannot be trusted."""


class Shooting(NamedTuple):
    """Seven solutions `marched` (n, 12, 7), the last the inhomogeneous; `coefficients` (6, 1) of the others; `pivots`
    (6,) of the conditions at s = 0; `growth` (1,) of the homogeneous solutions from s = 0 to s = L."""

    marched: Array
    coefficients: Array
    pivots: Swaps
    growth: Array

    @classmethod
    def empty(cls, intervals: int) -> Shooting:
        """Zeros for a rod of `intervals` intervals."""
        return cls(np.zeros((intervals + 1, 12, 7)), np.zeros((6, 1)), np.zeros(6, np.int64), np.zeros(1))


@variant(factor, Shooting)
@kernel
def shoot(linear: Shooting, Y: Array, past: Array, c0: float, h: float, nodes: Nodes,
          system: System) -> int:  # fmt: skip
    """March the seven solutions for the system's own residuals, and find their coefficients."""
    linear.growth[0] = _march(linear, Y, c0, h, nodes, system)
    return CONVERGED if linear.growth[0] < LARGEST_GROWTH else LOST_DIGITS


@variant(solve, Shooting)
@kernel
def combine_marched(linear: Shooting, system: System, scale: float, b: Array, x: Array) -> None:
    """Write the solution for the system's own residuals into `x`, whatever `b` and `scale`."""
    marched, c = linear.marched, linear.coefficients
    for j in range(len(x)):
        for k in range(12):
            x[j, k] = marched[j, k, 6]
            for m in range(6):
                x[j, k] += marched[j, k, m] * c[m, 0]


@variant(solves_again, Shooting)
@inner
def _only_once(linear: Shooting) -> bool:
    """So the tangents of contact are left out."""
    return False


@inner
def _march(linear: Shooting, Y: Array, c0: float, h: float, nodes: Nodes,
           system: System) -> float:  # fmt: skip
    """Write the marched solutions and their coefficients; return the growth (inf if a block is singular)."""
    marched, c, N = linear.marched, linear.coefficients, len(linear.marched) - 1
    if not _start(system.start, system.b_start, marched[0], linear.pivots):
        return np.inf
    W, panel, mean, swaps = scratch((12, 24)), scratch((18, 24)), scratch((MEANS, 3)), scratch_like(12, linear.pivots)
    for j in range(N):
        interval_panel(j, Y, c0, h, BOX, nodes, system.rows, system.columns, mean, panel, 6)
        for i in range(12):
            for k in range(12):
                W[i, k] = panel[6 + i, 12 + k]
            for m in range(7):
                marched[j + 1, i, m] = system.b[j, i] if m == 6 else 0.0
            for k in range(12):
                if panel[6 + i, k] != 0.0:
                    for m in range(7):
                        marched[j + 1, i, m] -= panel[6 + i, k] * marched[j, k, m]
        if not _solve_dense(W, swaps, marched[j + 1]):
            return np.inf
    growth = _largest(marched[N]) / _largest(marched[0])
    W_end = scratch((6, 12))
    for i in range(6):
        c[i, 0] = system.b_end[i]
        for k in range(12):
            c[i, 0] -= system.end[i, k] * marched[N, k, 6]
            for m in range(6):
                W_end[i, m] += system.end[i, k] * marched[N, k, m]
    if not _solve_dense(W_end, swaps[:6], c):
        return np.inf
    return float(growth)


@inner
def _largest(homogeneous: Array) -> float:
    """The largest entry of the homogeneous solutions at a node, the first six columns of (12, 7); NaN if one is."""
    largest, poison = 0.0, 0.0
    for k in range(12):
        for m in range(6):
            largest = max(largest, abs(homogeneous[k, m]))
            poison += 0.0 * homogeneous[k, m]
    return largest + poison


@kernel
def _start(start: Array, b: Array, first: Array, pivots: Swaps) -> bool:
    """Write a basis of the null space of `start` (6, 12) and one solution of start y = b into `first` (12, 7).

    And the column of each row's pivot into `pivots` (6,).
    """
    A, rhs = scratch((6, 12)), scratch(6)
    copy(start, A)
    copy(b, rhs)
    for i in range(6):
        column = 0
        for k in range(12):
            if abs(A[i, k]) > abs(A[i, column]):
                column = k
        pivots[i] = column
        if A[i, column] == 0.0:
            return False
        inverse = 1.0 / A[i, column]
        rhs[i] *= inverse
        for k in range(12):
            A[i, k] *= inverse
        for other in range(6):
            multiplier = A[other, column]
            if other != i and multiplier != 0.0:
                rhs[other] -= multiplier * rhs[i]
                for k in range(12):
                    A[other, k] -= multiplier * A[i, k]
    first[:, :] = 0.0
    m = 0
    for k in range(12):
        if k not in pivots:
            first[k, m] = 1.0
            for i in range(6):
                first[pivots[i], m] = -A[i, k]
            m += 1
    for i in range(6):
        first[pivots[i], 6] = rhs[i]
    return True


@inner
def _solve_dense(W: Array, swaps: Swaps, X: Array) -> bool:
    """Overwrite X (n, m) with A^-1 X, of A in the left half of the columns of W (n, 2 n), which is destroyed."""
    n, m = X.shape
    for i in range(n):
        for c in range(m):
            W[i, n + c] = X[i, c]
    if not eliminate(W, swaps):
        return False
    for k in range(n - 1, -1, -1):
        for c in range(m):
            total = W[k, n + c]
            for i in range(k + 1, n):
                total -= W[k, i] * X[i, c]
            X[k, c] = total / W[k, k]
    return True
