"""What lies at the nodes of a chain: orientations between the segments', and curvature and moment in these."""

from __future__ import annotations

import numpy as np

from solver.arrays import Array
from solver.methods.space.segments.chain import Chain
from solver.physics.elasticity import strains


def orientations_at_nodes(quaternion: Array) -> Array:
    """Orientations (N + 1, 4) at the nodes: half way between the segments, and those of the ends."""
    left, right = quaternion[1:-2], quaternion[2:-1]
    middle = left + np.sign(np.sum(left * right, axis=1))[:, None] * right
    middle /= np.linalg.norm(middle, axis=1)[:, None]
    return np.concatenate([quaternion[:1], middle, quaternion[-1:]])


def bending_at_nodes(chain: Chain, bend: Array, q: Array, left: Array, right: Array) -> tuple[Array, Array]:
    """kappa + offset (see `lay_out`) and q (N + 1, 3 each) in the frames of the nodes, of what `bend_joints` wrote.

    A joint's own are in the frame half way between its neighbours. This is the node's, but at an end, where the node's
    is that of the end: there q is what acts on the end, B q at the start and B^t q at the end, and kappa follows from
    it by eq. (1). The joint's own would be off by the turn of a quarter of an interval, tau h / 4, and so of order 1.
    """
    kappa, q, ends = bend / chain.span[:, None], q.copy(), [0, -1]
    acting = np.stack([left[0], right[-1]])
    kappa[ends] += strains(chain.elastic.K[ends], acting - q[ends])
    q[ends] = acting
    return kappa, q
