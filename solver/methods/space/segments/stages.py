"""The kernels of segments in space that a step of three stages asks for: see `space.stages`."""

from __future__ import annotations

from solver.arrays import Array
from solver.kernels.copying import copy
from solver.kernels.kernel import inner, kernel
from solver.kernels.rotation import spun_between
from solver.kernels.scratch import scratch
from solver.kernels.vectors import in_material, matrix, times, vector
from solver.methods.space.segments.balances import Driven, Tangents, balance_segments, condition_ends, segment_tangents
from solver.methods.space.segments.chain import STAGES, Chain, Residuals, Stages
from solver.methods.space.segments.joints import bend_joints
from solver.methods.space.segments.motion import spin_steadily
from solver.methods.space.segments.opening import add_levers, pull_joints
from solver.methods.space.segments.viscosity import resist_rates
from solver.physics.contact.forces import touching
from solver.physics.elasticity import is_viscous, stretches
from solver.physics.ends import LOAD, LOAD_LAB, RATE
from solver.physics.loads.registry import Loads

begin_step, tangents_at, in_contact = spin_steadily, segment_tangents, touching


@inner
def join_stages(chain: Chain, stages: Stages) -> None:
    """Write the moments of all stages, whose motion is known."""
    for i in range(STAGES):
        bend_joints(chain, stages.quaternion[i], stages.bend[i], stages.moment[i], stages.left[i], stages.right[i])
    if stretches(chain.elastic):
        for i in range(STAGES):
            pull_joints(chain, stages.R[i], stages.F[i], stages.bend[i], stages.moment[i], stages.left[i],
                        stages.right[i])  # fmt: skip
    if is_viscous(chain.elastic):
        for i in range(STAGES):
            resist_rates(chain, stages.omega[i], stages.bend[i], stages.moment[i], stages.left[i], stages.right[i])


@kernel
def evaluate(chain: Chain, loads: Loads, driven: Driven, stages: Stages, residuals: Residuals) -> None:
    """Write the residuals of all stages, whose motion and forces of contact are known."""
    join_stages(chain, stages)
    for i in range(STAGES):
        balance_segments(chain, loads, driven, stages, residuals, i)
        condition_ends(chain, driven, stages, residuals, i)
    if stretches(chain.elastic):
        for i in range(STAGES):
            add_levers(stages.R[i], stages.F[i], stages.opening[i, 0], residuals.rotation[i])


@inner
def missed_by_bodies(driven: Driven, stages: Stages, residuals: Residuals, noise: float) -> float:
    """The largest force that a body at an end misses at a stage, less that of its inertia by `noise` (m/s^2), in the
    largest force that a joint bears."""
    missed, largest = 0.0, 0.0
    for side in range(2):
        if driven.mass[side] > 0.0:
            for k in range(3):
                if driven.kinds[side, k] in (LOAD, LOAD_LAB):
                    for i in range(STAGES):
                        missed = max(missed, abs(residuals.ends[i, side, k]) - noise * driven.mass[side])
    if missed > 0.0:
        for i in range(STAGES):
            for a in range(stages.F.shape[1]):
                for k in range(3):
                    largest = max(largest, abs(stages.F[i, a, k]))
    return missed / max(largest, missed) if missed > 0.0 else 0.0


@inner
def turn_residuals(driven: Driven, stages: Stages, tangents: Tangents, residuals: Residuals) -> None:
    """Turn the rows in material components from the stages' own frames into those that go with the tangents.

    That is the tangents' frame, swung to the stage's own tangent T but not spun about it: what a force does is then no
    moment about T, where a thin rod's inertia is next to nothing, however far the segment swings. By which angle that
    frame is spun against the stage's own stands in `tangents.spun`, cos and sin. Where an end's
    conditions are of two kinds, only components of one kind are turned: exact for a frame that spins about the axis
    of the odd one.
    """
    R = tangents.R
    n = len(R)
    old, turned = scratch(3), scratch((3, 3))
    for i in range(STAGES):
        for a in range(n):
            row, (cosine, sine) = residuals.rotation[i, a], spun_between(R[a], stages.R[i, a])
            tangents.spun[i, a, 0], tangents.spun[i, a, 1] = cosine, sine
            kinds = driven.kinds[0 if a == 0 else 1]
            if 0 < a < n - 1 or kinds[3] == kinds[4]:
                row[0], row[1] = cosine * row[0] - sine * row[1], sine * row[0] + cosine * row[1]
        for side in range(2):
            a, rows = 0 if side == 0 else n - 1, residuals.ends[i, side]
            Q = stages.R[i, a]
            for k in range(3):
                for m in range(3):
                    turned[k, m] = R[a, 0, k] * Q[0, m] + R[a, 1, k] * Q[1, m] + R[a, 2, k] * Q[2, m]
            copy(rows, old)
            for k in range(3):
                kind = driven.kinds[side, k]
                if kind in (RATE, LOAD):
                    rows[k] = 0.0
                    for m in range(3):
                        if driven.kinds[side, m] == kind:
                            rows[k] += turned[k, m] * old[m]


@inner
def resist(chain: Chain, driven: Driven, tangents: Tangents, rate: float, velocity: Array, forces: Array,
           ends: Array) -> None:  # fmt: skip
    """Write the forces (N, 3) of inertia on the segments for accelerations `rate` `velocity` of their centres, and what
    bodies at the ends that move with these miss (2, 3)."""
    for side in range(2):
        frame, beside, sign = (0, 0, -1.0) if side == 0 else (len(tangents.R) - 1, len(velocity) - 1, 1.0)
        push = times(sign * driven.mass[side] * rate, vector(velocity, beside))
        within = in_material(matrix(tangents.R, frame), push)
        for k in range(3):
            kind = driven.kinds[side, k]
            ends[side, k] = push[k] if kind == LOAD_LAB else (within[k] if kind == LOAD else 0.0)
    for j in range(len(forces)):
        for k in range(3):
            forces[j, k] = 0.0
            for m in range(3):
                forces[j, k] -= tangents.M[j, k, m] * rate * velocity[j, m]
