"""Stability of an equilibrium: in how many directions the energy falls.

With the forces held as they are, the Lagrangian's second variation by the rotations is block tridiagonal, H; G are the
conditions that tie the rotations to where both ends are held, W those on the place of the start. By Haynsworth
(Linear Algebra Appl. 1 (1968) 73) the negative eigenvalues of [H G^t; G W] are those of H, counted by the signs of the
pivots of its factorisation, and those of W - G H^-1 G^t; each condition accounts for one that is no direction.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from scipy.linalg.lapack import dgbsv, dsytrf

from solver.arrays import Array
from solver.kernels.kernel import kernel
from solver.statics.elimination import falling_in_turn
from solver.statics.equations import Equations
from solver.statics.tangent import SOFTEST_PLACE, levers

BAND = 5
NEUTRAL = 1e-7
"""Stiffness, in EJ/L shared by all segments as `SOFTEST` is, that makes a direction one of rising energy, and in
proportion to what loads the rod one of falling energy: within these the energy stays the same, as where a rod spins
about its own axis, a buckle turns about it, or an arch swings about its pins."""
NEUTRAL_PLACE = 10.0 * SOFTEST_PLACE
"""Likewise in the largest stiffness of loads by place: of a rod that slides along a floor."""


def negative_modes(equations: Equations) -> int:
    """Directions of falling energy at the point that `equations` looked at last; loads are held as they are."""
    return _count(equations, NEUTRAL * equations.loading())


def neutral_modes(equations: Equations, falling: int) -> int:
    """Directions in which the energy stays the same, besides those in which it is `falling`."""
    return max(_count(equations, -NEUTRAL) - falling, 0)


def _count(equations: Equations, softest: float) -> int:
    """Directions of falling energy where every rotation has as much stiffness more."""
    K, length = equations.stiffness_of_loads(), float(equations.s[-1])
    D, B = _second_variation(equations, softest)
    if K.any() and not equations.contact.pressing:
        return falling_in_turn(equations, D, B, no_softer(K, softest) * (length**3 / equations.stiffness))
    bands, (G, W, ties) = _in_bands(D, B), _conditions(equations)
    if equations.contact.pressing:
        return _all_together(equations, K, bands, G, W, softest) - ties
    full = np.zeros((3 * BAND + 1, bands.shape[1]))
    full[2 * BAND :] = bands
    for k in range(1, BAND + 1):
        full[2 * BAND - k, k:] = bands[k, : -k]
    _, _, solved, _ = dgbsv(BAND, BAND, full, G)
    S = W - G.T @ solved
    falling = int(np.sum(np.linalg.eigvalsh(S) < 0.0))
    return int(_negative_pivots(bands.copy())) + falling - ties


def _conditions(equations: Equations) -> tuple[Array, Array, int]:
    """G (3 n, m), W (m, m) of the start's place and the conditions on places, which give way to the force along the
    rod where it has to stretch, and how many of these there are."""
    R, length = equations.stages.R[0], float(equations.s[-1])
    held = [end.axes[:, end.held[:3]] for end in equations.ends]
    ties = np.hstack(held)
    many, first = 3 + ties.shape[1], 3 + held[0].shape[1]
    G, W = np.zeros((3 * len(R), many)), np.zeros((many, many))
    opens, by_rotation = equations.tangents.opens, -2.0 * levers(R, equations.chain.h)
    by_rotation[:-1] += opens[:, 0].transpose(0, 2, 1)
    by_rotation[1:] += opens[:, 1].transpose(0, 2, 1)
    G[:, first:] = (1.0 / length * by_rotation @ held[1]).reshape(3 * len(R), -1)
    W[:3, 3:], W[3:, :3] = ties, ties.T
    give = equations.compliance * equations.stiffness / length**3
    for side, rows in enumerate((slice(3, first), slice(first, many))):
        along = R[-side, :, 2] @ held[side]
        W[rows, rows] -= give * np.outer(along, along)
    W[first:, first:] -= equations.stiffness / length**3 * held[1].T @ opens[:, 2].sum(axis=0) @ held[1]
    return G, W, int(ties.shape[1])


def _all_together(equations: Equations, K: Array, bands: Array, G: Array, W: Array, softest: float) -> int:
    """Negative eigenvalues of [H G^t; G W] where strands press on each other, which couples rotations far apart. How
    these, and loads by place, move a rod along itself by stretching it is left out."""
    length = float(equations.s[-1])
    unit, steps = length / equations.stiffness, -2.0 * levers(equations.stages.R[0], equations.chain.h)[1:-1]
    H, turned = _from_bands(bands), slice(3, 3 * len(steps) + 3)
    for by_rotations, by_both, by_place in (of_loads(K, steps, softest), *_of_contact(equations, steps)):
        H[turned, turned] += unit * by_rotations
        G[turned, :3] += unit * length * by_both
        W[:3, :3] += unit * length**2 * by_place
    variation = np.block([[H, G], [G.T, W]])
    factors, pivots, _ = dsytrf(variation, lower=1, lwork=64 * len(variation), overwrite_a=1)
    paired = pivots < 0  # in blocks of two, each of which has one of either sign
    return int(np.sum(np.diag(factors)[~paired] < 0.0)) + int(np.sum(paired)) // 2


def no_softer(K: Array, softest: float) -> Array:
    """The stiffness (n, 3, 3) of loads by place, with as much more, of the sign of `softest`, as a slide along them is
    taken for neutral by."""
    more = float(np.copysign(NEUTRAL_PLACE, softest) * np.abs(K).max())
    return np.asarray(0.5 * (K + K.transpose(0, 2, 1)) + more * np.eye(3))


def of_loads(K: Array, steps: Array, softest: float) -> tuple[Array, Array, Array]:
    """The second variation by the rotations of the n segments (3 n, 3 n), of which what is above the diagonal blocks is
    none, by these and the place of the start (3 n, 3), and by this alone (3, 3). The centre of a segment is moved by
    the place of the start, the rotations of all segments before it, by `steps` (n, 3, 3), and half its own."""
    K = no_softer(K, softest)
    pushed, one = steps @ (K[::-1].cumsum(axis=0)[::-1] - 0.5 * K), np.arange(len(K))
    by_rotations = (pushed.reshape(-1, 3) @ steps.reshape(-1, 3).T).reshape(len(K), 3, len(K), 3)
    by_rotations[one, :, one] -= 0.25 * steps @ K @ steps.transpose(0, 2, 1)
    return by_rotations.reshape(3 * len(K), -1), pushed.reshape(-1, 3), K.sum(axis=0)


def _of_contact(equations: Equations, steps: Array) -> Iterator[tuple[Array, Array, Array]]:
    """Likewise where strands press on each other: the place of the start moves all nodes, a rotation those behind its
    segment."""
    if not equations.contact.pressing:
        return
    S = equations.contact.stiffness()[0]
    together = S[::-1, :, ::-1].cumsum(axis=0).cumsum(axis=2)[::-1, :, ::-1]
    by_rotations = np.einsum("iap,ipkq,kbq->iakb", steps, together[1:, :, 1:], steps, optimize=True)
    by_both = np.einsum("iap,ipq->iaq", steps, together[1:, :, 0])
    yield by_rotations.reshape(3 * len(steps), -1), by_both.reshape(-1, 3), together[0, :, 0]


def _from_bands(bands: Array) -> Array:
    """The symmetric matrix with these lower bands."""
    full = np.zeros((bands.shape[1], bands.shape[1]))
    for k, band in enumerate(bands):
        np.fill_diagonal(full[k:], band[: len(band) - k])
        np.fill_diagonal(full[:, k:], band[: len(band) - k])
    return full


def _second_variation(equations: Equations, softest: float) -> tuple[Array, Array]:
    """H's symmetric part in EJ/L, of each segment's rotation (N + 2, 3, 3) and with the next one's (N + 1, 3, 3);
    rotations that are held count as stiff."""
    T, unit = equations.tangents, float(equations.s[-1]) / equations.stiffness
    soft = softest * equations.chain.h / float(equations.s[-1])
    D = 0.5 * unit * (T.stiff + T.stiff.transpose(0, 2, 1)) + soft * np.eye(3)
    B = 0.5 * unit * (T.behind[:-1] + T.before[1:].transpose(0, 2, 1))
    for side, end in enumerate(equations.ends):
        fixed = end.held[3:]
        for block in (D[-side], D[-side].T, B[0] if side == 0 else B[-1].T):
            block[fixed] = 0.0
        D[-side][fixed, fixed] = 1.0
    return D, B


def _in_bands(D: Array, B: Array) -> Array:
    """The block tridiagonal symmetric matrix in lower bands (6, 3 n)."""
    bands = np.zeros((BAND + 1, 3 * len(D)))
    for p in range(3):
        for q in range(3):
            if p >= q:
                bands[p - q, q::3] = D[:, p, q]
            # the block below the diagonal is B^t
            bands[3 + p - q, q:-3:3] = B[:, q, p]
    return bands


@kernel
def _negative_pivots(bands: Array) -> int:
    """Number of negative pivots of the symmetric matrix with these lower bands, which are overwritten."""
    count, wide, n = 0, bands.shape[0] - 1, bands.shape[1]
    for j in range(n):
        pivot = bands[0, j]
        if pivot < 0.0:
            count += 1
        for p in range(1, min(wide, n - 1 - j) + 1):
            factor = bands[p, j] / pivot
            for q in range(p, min(wide, n - 1 - j) + 1):
                bands[q - p, j + p] -= factor * bands[q, j]
    return count
