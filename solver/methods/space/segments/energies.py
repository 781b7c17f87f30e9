"""Energies of the chain, and what flows in and out within a step, in the method's own quadrature."""

from __future__ import annotations

from typing import Any

import numpy as np

from solver.arrays import Array
from solver.kernels.handed import Reference
from solver.kernels.kernel import inner, kernel
from solver.kernels.scratch import scratch
from solver.kernels.vectors import dot, in_material, matrix, minus, plus, times, vector
from solver.measures.energies import Energies
from solver.methods.space.segments.balances import Driven, Motion, end_velocity, motion_at
from solver.methods.space.segments.chain import STAGES, Chain, Stages
from solver.methods.space.segments.opening import tension
from solver.methods.space.segments.viscosity import dissipated
from solver.physics.elasticity import is_viscous, strain_energy, stretch_energy, stretches
from solver.physics.ends import LOAD, RATE
from solver.physics.loads.load import add_energies, add_powers
from solver.physics.loads.registry import Loads


@kernel
def energies(reference: Reference, bend: Array, F: Array, motion: Motion) -> Energies:
    """The energies at the end of a step: joints' `bend` and forces `F` (N + 1, 3), the segments' motion."""
    return energies_at(reference.chain, reference.loads, STAGES - 1, bend, F, motion)


@kernel
def energies_at(chain: Chain, loads: Loads, i: int, bend: Array, F: Array, motion: Motion) -> Energies:
    """The energies at a state, by the loads of the i-th time of a step."""
    bending, torsion, stretching, kinetic, turning, by_loads = 0.0, 0.0, 0.0, 0.0, 0.0, scratch(2)
    by_loads[0], by_loads[1] = 0.0, 0.0
    add_energies(loads, i, motion, by_loads)
    for joint in range(len(bend)):
        strain = minus(times(1.0 / chain.span[joint], vector(bend, joint)), vector(chain.elastic.kappa0, joint))
        bent, twisted = strain_energy(chain.elastic, joint, strain)
        bending += chain.span[joint] * bent
        torsion += chain.span[joint] * twisted
    if stretches(chain.elastic):
        for joint in range(len(bend)):
            stretching += chain.span[joint] * stretch_energy(chain.elastic, joint, tension(motion.R, F, joint))
    for j in range(len(motion.r)):
        for k in range(3):
            velocity, spin = motion.V[j, k], motion.omega[j + 1, k] * motion.omega[j + 1, k]
            kinetic += chain.mass[j] * velocity * velocity + chain.dry_inertia[j, k] * spin
            turning += (chain.inertia[j, k] - chain.dry_inertia[j, k]) * spin
    h = chain.h
    moving = 0.5 * h * kinetic, 0.5 * h * turning + h * by_loads[1]
    return Energies(bending, torsion, stretching, moving[0], moving[1], h * by_loads[0])


@inner
def _follow_end(driven: Driven, stages: Stages, i: int, side: int, velocity: Any, weight: float, out: Array) -> None:
    """Add to `out` (6,) how what holds an end, at the `velocity` of its node, moves and turns along the axes of its
    conditions."""
    a, sign = (0, -1.0) if side == 0 else (stages.R.shape[1] - 1, 1.0)
    R = matrix(stages.R[i], a)
    T = R[0][2], R[1][2], R[2][2]
    away = sign * driven.compliance[side] * dot(T, vector(stages.F_t[i], side))
    speed = plus(velocity, times(away, T))
    if driven.kinds[side, 0] in (RATE, LOAD):
        speed = in_material(R, speed)
    for k in range(3):
        out[k] += weight * speed[k]
        out[3 + k] += weight * stages.omega[i, a, k]


@kernel
def stage_powers(reference: Reference, weights: Array, moved: Array, out: Array) -> None:
    """Write the power (W) of the ends, of loads, and dissipated, at the stages into `out` (3, 3).

    And into `moved` (2, 6) by how much what holds start and end has moved (m) and turned (rad) along the axes of its
    conditions, by the `weights` (3,) of the stages.
    """
    chain, loads, driven, stages = reference.chain, reference.loads, reference.driven, reference.stages
    N, by_loads = len(chain.mass), scratch(2)
    moved[:] = 0.0
    for i in range(STAGES):
        start, end = end_velocity(chain, stages, i, 0), end_velocity(chain, stages, i, 1)
        _follow_end(driven, stages, i, 0, start, weights[i], moved[0])
        _follow_end(driven, stages, i, 1, end, weights[i], moved[1])
        work, by_loads[0], by_loads[1] = 0.0, 0.0, 0.0
        for k in range(3):
            work += stages.F[i, N, k] * end[k] - stages.F[i, 0, k] * start[k]
            work += stages.right[i, N, k] * stages.omega[i, N + 1, k] - stages.left[i, 0, k] * stages.omega[i, 0, k]
        add_powers(loads, i, motion_at(stages, i), by_loads)
        out[i, 0], out[i, 1], out[i, 2] = work, chain.h * by_loads[0], chain.h * by_loads[1]
        if is_viscous(chain.elastic):
            out[i, 2] += dissipated(chain, stages.omega[i], stages.bend[i])


@kernel
def stretch_of_ends(reference: Reference) -> float:
    """By how much (m) a step ends with the ends stretched by their compliance."""
    driven, stages = reference.driven, reference.stages
    F, R, (N, stretch) = stages.F[STAGES - 1], stages.R[STAGES - 1], (stages.F.shape[1] - 1, 0.0)
    for side, node, frame in ((0, 0, 0), (1, N, N + 1)):
        pull = 0.0
        for k in range(3):
            pull += F[node, k] * R[frame, k, 2]
        stretch += driven.compliance[side] * abs(pull)
    return stretch


@kernel
def twist(quaternion: Array) -> float:
    """Twist (rad) of orientations (n, 4): the sum of the rotations of neighbours about their common tangent.

    Of the relative rotation (w, x, y, z) it is 2 atan(z / w), what is left of it after the shortest rotation from one
    tangent to the other; so with the writhe of the polygon Tw + Wr is the ends' relative rotation to rounding.
    """
    total = 0.0
    for i in range(len(quaternion) - 1):
        a, b, c, d = quaternion[i, 0], quaternion[i, 1], quaternion[i, 2], quaternion[i, 3]
        w, x, y, z = quaternion[i + 1, 0], quaternion[i + 1, 1], quaternion[i + 1, 2], quaternion[i + 1, 3]
        cosine = a * w + b * x + c * y + d * z
        sine = a * z - b * y + c * x - d * w
        if cosine < 0.0:
            cosine, sine = -cosine, -sine
        total += 2.0 * np.arctan2(sine, cosine)
    return total
