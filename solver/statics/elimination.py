"""Directions of falling energy where loads depend on the place: from segment to segment.

The places X of the segments' begins are unknowns besides the rotations psi, tied by multipliers F of what leads from
one to the next: X' = X + steps^t psi + e, where a joint opens by e. Loads act at the middles, X + steps^t psi / 2. So
the second variation is block tridiagonal, and its negative eigenvalues are those of its Schur complements (Haynsworth,
Linear Algebra Appl. 1 (1968) 73): each multiplier accounts for one that is no direction. One that has X' to balance it
is eliminated with X' where the start is held along it, for X is not free then, and else with X.
"""

from __future__ import annotations

import numpy as np
from scipy.linalg import qr
from scipy.linalg.lapack import dsytrf, dsytrs

from solver.arrays import Array
from solver.statics.equations import Equations
from solver.statics.tangent import levers

PSI, X = slice(0, 3), slice(3, 6)


def falling_in_turn(equations: Equations, D: Array, B: Array, K: Array) -> int:
    """Directions of falling energy, by the second variation of the rotations of n segments, of which the first and the
    last are the ends', `D` (n, 3, 3), and of each with the next, `B` (n - 1, 3, 3), in EJ/L; and by the stiffness `K`
    (n - 2, 3, 3) of the loads on those between, in EJ/L^3."""
    length, unit = float(equations.s[-1]), equations.stiffness / float(equations.s[-1]) ** 3
    R, (starts, ends) = equations.stages.R[0], (end.axes[:, end.held[:3]] for end in equations.ends)
    held = int(starts.shape[1])
    axes = np.hstack([starts, qr(starts)[0][:, held:]]) if held else np.eye(3)
    steps, K = -2.0 / length * levers(R, equations.chain.h), np.pad(K, ((1, 1), (0, 0), (0, 0)))
    opens = equations.tangents.opens
    before, behind = (opens[:, i].transpose(0, 2, 1) / length @ axes for i in (0, 1))
    compliance = axes.T @ (unit * opens[:, 2]) @ axes
    tied, free = slice(6, 6 + held), slice(6 + held, 9)
    own, onward = np.zeros((len(D), 9, 9)), np.zeros((len(B), 9, 6 + held))
    own[:, PSI, PSI], own[:, X, X] = D + 0.25 * steps @ K @ steps.transpose(0, 2, 1), axes.T @ K @ axes
    own[:, X, PSI] = 0.5 * axes.T @ K @ steps.transpose(0, 2, 1)
    own[:, tied, 3 : 3 + held] = np.eye(held)
    own[1:, tied, PSI], own[1:, tied, tied] = -_turned(behind[..., :held]), -compliance[:, :held, :held]
    leaving = -(steps[:-1] @ axes + before)
    own[:-1, free, PSI], own[:-1, free, 3 + held : 6] = _turned(leaving[..., held:]), -np.eye(3 - held)
    own[:-1, free, free] = -compliance[:, held:, held:]
    own[0, tied, tied] = -_give(equations, R[0], starts)
    onward[:, PSI, PSI], onward[:, PSI, tied] = B, leaving[..., :held]
    onward[:, 3 : 3 + held, tied] = -np.eye(held)
    onward[:, free, 3 + held : 6], onward[:, free, PSI] = np.eye(3 - held), -_turned(behind[..., held:])
    onward[:, free, tied] = -compliance[:, held:, :held]
    last = np.zeros((6 + held + ends.shape[1],) * 2)
    last[: 6 + held, : 6 + held] = own[-1, : 6 + held, : 6 + held]
    last[6 + held :, X], last[6 + held :, 6 + held :] = ends.T @ axes, -_give(equations, R[-1], ends)
    return int(_negative([*own[:-1], last], onward)) - 3 * len(B) - held - int(ends.shape[1])


def _turned(blocks: Array) -> Array:
    return blocks.transpose(0, 2, 1)


def _give(equations: Equations, R: Array, axes: Array) -> Array:
    """By how much a held end gives way to the force along the rod, along the axes in which it is held."""
    along = R[:, 2] @ axes
    return np.asarray(equations.compliance * equations.stiffness / float(equations.s[-1]) ** 3 * np.outer(along, along))


def _negative(own: list[Array], onward: Array) -> int:
    """Negative eigenvalues of the block tridiagonal matrix with these lower triangles on its diagonal, and to the right
    of each the columns of the next that are not zero."""
    carried, many = np.zeros((onward.shape[2],) * 2), 0
    wide = len(carried)
    for i, block in enumerate(own):
        block[:wide, :wide] -= carried
        factors, pivots, _ = dsytrf(block, lower=1)
        paired = pivots < 0  # in blocks of two, each of which has one of either sign
        many += int(np.count_nonzero(factors.diagonal()[~paired] < 0.0)) + int(np.count_nonzero(paired)) // 2
        if i < len(onward):
            carried = onward[i].T @ dsytrs(factors, pivots, onward[i], lower=1)[0]
    return many
