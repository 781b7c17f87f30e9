"""A state at rest, and the rod laid down at it.

Unknown at block a = 0 ... N + 1: the rotation psi of orientation a, the displacement x (of the start, of segment a's
centre, of the end), and the force F at node a - 1.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from solver.arrays import Array
from solver.kernels.copying import copy
from solver.kernels.kernel import kernel
from solver.kernels.rotation import matrices_of, turn
from solver.methods.space.segments.chain import Chain, Stages
from solver.methods.space.segments.joints import bend_joints
from solver.methods.space.segments.motion import follow_segments
from solver.methods.space.segments.opening import measure_openings, pull_joints, shift_segments
from solver.physics.elasticity import stretches

BLOCK = 9
PSI, X, FORCE = slice(0, 3), slice(3, 6), slice(6, 9)


@dataclass
class Point:
    """A state at rest: `quaternion` (N + 2, 4), `base` (3,), `F` (N + 1, 3), lab; at the parameter `q` = t / t_end."""

    quaternion: Array
    base: Array
    F: Array
    q: float

    def moved(self, z: Array, dq: float) -> Point:
        """The point displaced by `z` (N + 2, 9), in units of rotation, place and force."""
        quaternion = np.empty_like(self.quaternion)
        _turn_all(self.quaternion, np.ascontiguousarray(z[:, PSI]), quaternion)
        return Point(quaternion, self.base + z[0, X], self.F + z[1:, FORCE], self.q + dq)


@kernel
def _turn_all(quaternion: Array, psi: Array, turned: Array) -> None:
    for a in range(len(psi)):
        turn(quaternion[a], psi[a], turned[a])


@kernel
def lay_down(chain: Chain, quaternion: Array, base: Array, F: Array, stages: Stages) -> None:
    """Write rotations, forces, places and moments of stage 0; velocities and accelerations stay zero."""
    copy(quaternion, stages.quaternion[0])
    matrices_of(quaternion, stages.R[0])
    copy(base, stages.base[0, 0])
    follow_segments(stages.R[0], stages.omega[0], stages.alpha[0], stages.base[0], chain.h,
                    stages.r[0], stages.V[0], stages.A[0])  # fmt: skip
    bend_joints(chain, quaternion, stages.bend[0], stages.moment[0], stages.left[0], stages.right[0])
    copy(F, stages.F[0])
    if stretches(chain.elastic):
        pull_joints(chain, stages.R[0], F, stages.bend[0], stages.moment[0], stages.left[0], stages.right[0])
        measure_openings(chain, stages.R[0], F, stages.bend[0], stages.opening[0, 0])
        shift_segments(stages.R[0], stages.omega[0], stages.alpha[0], stages.opening[0],
                       stages.r[0], stages.V[0], stages.A[0])  # fmt: skip
