"""What lies at the nodes of a chain: orientations between the segments', and curvature and moment in these."""

from __future__ import annotations

import numpy as np

from solver.arrays import Array
from solver.kernels.kernel import kernel
from solver.kernels.rotation import entries
from solver.kernels.vectors import in_lab, in_material, matrix, plus, times, vector
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
def motion_at_nodes(quaternion: Array, R: Array, omega: Array, V: Array, F: Array, orientation: Array,
                    shown: Array) -> None:  # fmt: skip
    """Write the nodes' orientations (N + 1, 4), and `shown` (3, N + 1, 3): v, omega and f in these.

    From the segments' `quaternion`, R and `omega` (N + 2, ...), and velocities V and forces F (N + 1, 3) of the nodes,
    lab. A node turns as its neighbours do in the mean, an end as it does itself.
    """
    orientations_at_nodes(quaternion, orientation)
    last = len(orientation) - 1
    for i in range(last + 1):
        own = i + 1 if i == last else i
        spin = in_lab(matrix(R, own), vector(omega, own))
        if 0 < i < last:
            spin = times(0.5, plus(spin, in_lab(matrix(R, i + 1), vector(omega, i + 1))))
        a, b, c, d, e, f, g, h, k = entries(orientation[i, 0], orientation[i, 1], orientation[i, 2], orientation[i, 3])
        Q = (a, b, c), (d, e, f), (g, h, k)
        shown[0, i, 0], shown[0, i, 1], shown[0, i, 2] = in_material(Q, vector(V, i))
        shown[1, i, 0], shown[1, i, 1], shown[1, i, 2] = in_material(Q, spin)
        shown[2, i, 0], shown[2, i, 1], shown[2, i, 2] = in_material(Q, vector(F, i))


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
