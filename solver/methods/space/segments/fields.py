"""What lies at the nodes of a chain: orientations between the segments', and curvature and moment in these."""

from __future__ import annotations

import numpy as np

from solver.arrays import Array
from solver.kernels.kernel import kernel
from solver.kernels.vectors import vector
from solver.methods.space.segments.chain import Chain
from solver.physics.elasticity import add_strain


@kernel
def orientations_at_nodes(quaternion: Array, orientation: Array) -> None:
    """Write the orientations (N + 1, 4) at the nodes: half way between the segments, and those of the ends."""
    last = len(orientation) - 1
    for k in range(4):
        orientation[0, k], orientation[last, k] = quaternion[0, k], quaternion[last + 1, k]
    for i in range(1, last):
        cosine = 0.0
        for k in range(4):
            cosine += quaternion[i, k] * quaternion[i + 1, k]
        sign, square = -1.0 if cosine < 0.0 else 1.0, 0.0
        for k in range(4):
            orientation[i, k] = quaternion[i, k] + sign * quaternion[i + 1, k]
            square += orientation[i, k] ** 2
        for k in range(4):
            orientation[i, k] /= np.sqrt(square)


@kernel
def bending_at_nodes(chain: Chain, bend: Array, q: Array, left: Array, right: Array) -> None:
    """Make kappa + offset (see `lay_out`) and q (N + 1, 3 each), in the frames of the nodes, of what `bend_joints`
    wrote: in place, of `bend` and of `q`.

    A joint's own are in the frame half way between its neighbours. This is the node's, but at an end, where the node's
    is that of the end: there q is what acts on the end, B q at the start and B^t q at the end, and kappa follows from
    it by eq. (1). The joint's own would be off by the turn of a quarter of an interval, tau h / 4, and so of order 1.
    """
    for i in range(len(bend)):
        for k in range(3):
            bend[i, k] /= chain.span[i]
    last = len(bend) - 1
    for side in range(2):
        i, acting = (0, left) if side == 0 else (last, right)
        for k in range(3):
            q[i, k] = acting[i, k] - q[i, k]
        add_strain(chain.elastic, i, vector(q, i), bend[i])
        for k in range(3):
            q[i, k] = acting[i, k]
