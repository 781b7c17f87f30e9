"""Stability of an equilibrium: in how many directions the energy falls.

With the forces held as they are, the Lagrangian's second variation by the rotations is block tridiagonal, H; G are the
conditions that tie the rotations to where both ends are held, W those on the place of the start. By Haynsworth
(Linear Algebra Appl. 1 (1968) 73) the negative eigenvalues of [H G^t; G W] are those of H, counted by the signs of the
pivots of its factorisation, and those of W - G H^-1 G^t; each condition accounts for one that is no direction.
"""

from __future__ import annotations

import numpy as np
from scipy.linalg import eigvalsh
from scipy.linalg.lapack import dgbsv, dsytrf

from solver.arrays import Array
from solver.kernels.kernel import kernel
from solver.statics.equations import SOFTEST_PLACE, Equations, levers

BAND = 5
NEUTRAL = 1e-7
"""Stiffness, in EJ/L shared by all segments as `SOFTEST` is, that makes a direction one of rising or falling energy:
below it the energy stays the same, as where a rod spins about its own axis or an arch swings about its pins."""
NEUTRAL_PLACE = 10.0 * SOFTEST_PLACE
"""Likewise in the largest stiffness of loads by place: of a rod that slides along a floor."""


def negative_modes(equations: Equations) -> int:
    """Directions of falling energy at the point that `equations` looked at last; loads are held as they are."""
    return _count(equations, NEUTRAL)


def neutral_modes(equations: Equations, falling: int) -> int:
    """Directions in which the energy stays the same, besides those in which it is `falling`."""
    return max(_count(equations, -NEUTRAL) - falling, 0)


def _count(equations: Equations, softest: float) -> int:
    """Directions of falling energy where every rotation has as much stiffness more."""
    K = equations.stiffness_of_loads()
    placed = equations.contact.pressing > 0 or bool(K.any())
    length = float(equations.s[-1])
    T = equations.tangents
    bands = _second_variation(T.stiff, T.behind, equations, softest) * (length / equations.stiffness)
    G, W, ties = _conditions(equations)
    if placed:
        return _all_together(equations, K, bands, G, W, softest) - ties
    full = np.zeros((3 * BAND + 1, bands.shape[1]))
    full[2 * BAND :] = bands
    for k in range(1, BAND + 1):
        full[2 * BAND - k, k:] = bands[k, : -k]
    _, _, solved, _ = dgbsv(BAND, BAND, full, G)
    S = W - G.T @ solved
    falling = int(np.sum(eigvalsh(S) < 0.0))
    return int(_negative_pivots(bands.copy())) + falling - ties


def _conditions(equations: Equations) -> tuple[Array, Array, int]:
    """G (3 n, m), W (m, m) of the start's place and the conditions on places, which give way to the force along the
    rod where it has to stretch, and how many of these there are."""
    R, length = equations.stages.R[0], float(equations.s[-1])
    held = [end.axes[:, end.held[:3]] for end in equations.ends]
    ties = np.hstack(held)
    many = 3 + ties.shape[1]
    G, W = np.zeros((3 * len(R), many)), np.zeros((many, many))
    opens, by_rotation = equations.tangents.opens, -2.0 * levers(R, equations.chain.h)
    by_rotation[:-1] += opens[:, 0].transpose(0, 2, 1)
    by_rotation[1:] += opens[:, 1].transpose(0, 2, 1)
    G[:, 3 + held[0].shape[1] :] = (1.0 / length * by_rotation @ held[1]).reshape(3 * len(R), -1)
    W[:3, 3:], W[3:, :3] = ties, ties.T
    give = equations.compliance * equations.stiffness / length**3
    for side, rows in enumerate((slice(3, 3 + held[0].shape[1]), slice(3 + held[0].shape[1], many))):
        along = R[-side, :, 2] @ held[side]
        W[rows, rows] -= give * np.outer(along, along)
    last = slice(3 + held[0].shape[1], many)
    W[last, last] -= equations.stiffness / length**3 * held[1].T @ opens[:, 2].sum(axis=0) @ held[1]
    return G, W, int(ties.shape[1])


def _all_together(equations: Equations, K: Array, bands: Array, G: Array, W: Array, softest: float) -> int:
    """Negative eigenvalues of [H G^t; G W] where strands press on each other or loads depend on the place, which
    couples rotations far apart. (Eliminated from segment to segment the counts fell below zero.) How these move a rod
    along itself by stretching it is left out."""
    length = float(equations.s[-1])
    S, steps = _by_place(equations, K, softest), -2.0 * levers(equations.stages.R[0], equations.chain.h)[1:-1]
    n, unit = len(S), length / equations.stiffness
    # the place of the start moves all nodes, a rotation those behind its segment
    together = S[::-1, :, ::-1].cumsum(axis=0).cumsum(axis=2)[::-1, :, ::-1]
    H, turned = _from_bands(bands), slice(3, 3 * n)
    H[turned, turned] += unit * np.einsum("iap,ipkq,kbq->iakb", steps, together[1:, :, 1:], steps,
                                          optimize=True).reshape(3 * n - 3, -1)  # fmt: skip
    G[turned, :3] += unit * length * np.einsum("iap,ipq->iaq", steps, together[1:, :, 0]).reshape(-1, 3)
    W[:3, :3] += unit * length**2 * together[0, :, 0]
    variation = np.block([[H, G], [G.T, W]])
    factors, pivots, _ = dsytrf(0.5 * (variation + variation.T), lower=1, lwork=64 * len(variation), overwrite_a=1)
    paired = pivots < 0  # in blocks of two, each of which has one of either sign
    return int(np.sum(np.diag(factors)[~paired] < 0.0)) + int(np.sum(paired)) // 2


def _by_place(equations: Equations, K: Array, softest: float) -> Array:
    """The stiffness of contact and loads by the places of the nodes (N + 1, 3, N + 1, 3); of loads with as much more,
    of either sign, as a slide along them is taken for neutral by."""
    n = len(equations.s)
    K = K + np.copysign(NEUTRAL_PLACE, softest) * np.abs(K).max() * np.eye(3)
    S = equations.contact.stiffness()[0] if equations.contact.pressing else np.zeros((n, 3, n, 3))
    segments = np.arange(n - 1)
    for one in (0, 1):  # a segment's centre lies between its nodes
        for other in (0, 1):
            S[segments + one, :, segments + other] += 0.25 * K
    return np.asarray(S)


def _from_bands(bands: Array) -> Array:
    """The symmetric matrix with these lower bands."""
    full = np.zeros((bands.shape[1], bands.shape[1]))
    for k, band in enumerate(bands):
        np.fill_diagonal(full[k:], band[: len(band) - k])
        np.fill_diagonal(full[:, k:], band[: len(band) - k])
    return full


def _second_variation(stiff: Array, behind: Array, equations: Equations, softest: float) -> Array:
    """H's symmetric part in lower bands (6, 3 n); rotations that are held count as stiff."""
    n, unit = len(stiff), equations.stiffness / float(equations.s[-1])
    soft = softest * unit * equations.chain.h / float(equations.s[-1])
    D = 0.5 * (stiff + stiff.transpose(0, 2, 1)) + soft * np.eye(3)
    B = np.zeros_like(D)
    B[:-1] = 0.5 * (behind[:-1] + equations.tangents.before[1:].transpose(0, 2, 1))
    for side, end in enumerate(equations.ends):
        fixed = end.held[3:]
        for block in (D[-side], D[-side].T, B[0] if side == 0 else B[-2].T):
            block[fixed] = 0.0
        D[-side][fixed, fixed] = unit
    bands = np.zeros((BAND + 1, 3 * n))
    for p in range(3):
        for q in range(3):
            if p >= q:
                bands[p - q, q::3] = D[:, p, q]
            # the block below the diagonal is B^t
            bands[3 + p - q, q::3] = B[:, q, p]
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
