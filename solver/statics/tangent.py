"""The tangent of a rod's equations at rest: its blocks along the chain, and what contact adds.

Where the loads have a potential it is symmetric at equilibrium, F being the multiplier of that neighbours stay joined.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from solver.arrays import Array
from solver.methods.space.segments.balances import Tangents
from solver.statics.point import BLOCK, FORCE, PSI, X

if TYPE_CHECKING:
    from scipy.sparse import bsr_array, csr_array

SOFTEST_PLACE = 1e-12
"""Of the largest stiffness of loads by place, given to every place: a rod that may slide along a floor has one state,
the nearest."""


def chain_blocks(T: Tangents, R: Array, h: float, soft: float, stretches: bool) -> tuple[Array, Array, Array]:
    """Diagonal (N + 2, 9, 9) of the tangent, and the blocks before and behind it, of a chain that nothing holds.

    `soft` (N m): given to every rotation, as `SOFTEST_PLACE` is to every place; `stretches`: whether the rod can.
    """
    D, lower, upper = (np.zeros((len(R), BLOCK, BLOCK)) for _ in range(3))
    lever, one = levers(R, h), np.eye(3)
    D[:, PSI, PSI], lower[:, PSI, PSI], upper[:, PSI, PSI] = T.stiff, T.before, T.behind
    D[:, PSI, PSI] += soft * one
    D[1:, PSI, FORCE], upper[:-1, PSI, FORCE] = lever[1:], lever[:-1]
    D[1:-1, X, PSI], D[1:-1, X, X] = -T.E, T.K + SOFTEST_PLACE * np.abs(T.K).max() * one
    D[1:, X, FORCE], upper[:-1, X, FORCE] = one, -one
    D[1:, FORCE, PSI], lower[1:, FORCE, PSI] = lever[1:].transpose(0, 2, 1), lever[:-1].transpose(0, 2, 1)
    D[1:, FORCE, X], lower[1:, FORCE, X] = one, -one
    if stretches:
        before, behind, by_force = T.opens[:, 0], T.opens[:, 1], T.opens[:, 2]
        D[1:, FORCE, FORCE] -= by_force
        D[1:, FORCE, PSI] -= behind
        D[1:, PSI, FORCE] -= behind.transpose(0, 2, 1)
        lower[1:, FORCE, PSI] -= before
        upper[:-1, PSI, FORCE] -= before.transpose(0, 2, 1)
    return D, lower, upper


def levers(R: Array, h: float) -> Array:
    """(h/2) a3 x R^t (n, 3, 3): the moment of a unit force at a segment's node; none for the ends' frames."""
    lever = np.zeros((len(R), 3, 3))
    lever[1:-1, 0], lever[1:-1, 1] = 0.5 * h * R[1:-1, :, 1], -0.5 * h * R[1:-1, :, 0]
    return lever


def node_moves(R: Array, h: float, units: Array, opens: Array | None = None) -> Array:
    """What takes the dimensionless displacements of the orientations before and behind each node to its own, m
    (N + 1, 2, 3, 9): to that of either segment beside it, as these bear the forces there; `units` (9,).

    With `opens` (see `Tangents`), of a rod that can stretch, to that of the rod's own nodes: at its ends the joints
    open between the orientations beside them.
    """
    lever = levers(R, h).transpose(0, 2, 1)
    moves = np.zeros((len(R) - 1, 2, 3, BLOCK))
    for side, tip, sign in ((0, slice(1, None), -1.0), (1, slice(-1), 1.0)):
        moves[tip, side, :, X] = units[X] * np.eye(3)
        moves[tip, side, :, PSI] = sign * lever[1:-1]
    moves[1:-1] *= 0.5
    if opens is not None:
        at_ends = opens[[0, -1]] * np.array([-1.0, 1.0])[:, None, None, None]
        moves[[0, -1], :, :, PSI] += at_ends[:, :2]
        moves[[0, -1], 1, :, FORCE] += at_ends[:, 2] * units[FORCE]
    return moves


def of_contact(S: Array, coupled: NDArray[np.bool_], moves: Array, opened: Array, per_moment: float) -> csr_array:
    """What contact adds to the tangent (9 (N + 2), 9 (N + 2)), dimensionless; `S`, `coupled`: see
    `StaticContact.stiffness`; `opened`: `moves` of the rod's own nodes; `per_moment`: 1/(N m)."""
    from scipy.sparse import bsr_array, csr_array

    n = len(moves)
    one, other = np.nonzero(coupled)
    blocks = S[one, :, other] * per_moment, other, np.searchsorted(one, np.arange(n + 1))
    pushed = bsr_array(blocks, shape=(3 * n, 3 * n)) @ _by_blocks(opened)
    return csr_array(_by_blocks(moves).T @ pushed)


def _by_blocks(moves: Array) -> bsr_array:
    """What takes a displacement of all orientations to those of the nodes, of what does for each node."""
    from scipy.sparse import bsr_array

    n = len(moves)
    columns = (np.arange(n)[:, None] + np.arange(2)).ravel()
    blocks = moves.reshape(2 * n, 3, BLOCK), columns, 2 * np.arange(n + 1)
    return bsr_array(blocks, shape=(3 * n, BLOCK * (n + 1)))


def crossing(x: Array) -> Array:
    """The matrices [x] (..., 3, 3) of vectors (..., 3)."""
    matrices = np.zeros((*x.shape, 3))
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        matrices[..., k, j], matrices[..., j, k] = x[..., i], -x[..., i]
    return matrices
