"""The balances of the segments and the conditions at the ends at one stage: residuals and tangents.

For segment j with centre r, tangent T = R a3, forces F_j and F_j+1 at its nodes and q turned into its frame there:

    h (rho_c A dV/dt - B)                 - (F_j+1 - F_j)                                         = 0   lab
    h (I omega_t + omega x I omega - Q)   - (q_right - q_left) - (h/2) a3 x R^t (F_j+1 + F_j)     = 0   material

with I about the segment's centre. Of a rod that can stretch, the levers that its joints have besides are added by
`opening`. Forces on the nodes (contact) are shared by the segments that meet there. How a load's tangents become those
of the balances is said in `_take_tangents`, and nowhere else.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from solver.arrays import Array
from solver.kernels.copying import copy
from solver.kernels.dispatch import variant
from solver.kernels.handed import Reference
from solver.kernels.kernel import inlined, inner, kernel
from solver.kernels.vectors import (
    add_matrix,
    add_vector,
    dot,
    in_material,
    in_material_by_rotation,
    lever_turned,
    matrix,
    minus,
    plus,
    tangent_acceleration,
    tangent_by_rotation,
    tangent_rate,
    times,
    vector,
)
from solver.methods.space.segments.chain import STAGES, Chain, Residuals, Stages
from solver.methods.space.segments.joints import joint_tangents, share
from solver.methods.space.segments.opening import opening_tangents
from solver.methods.space.segments.viscosity import rate_tangents
from solver.physics.elasticity import is_viscous, stretches
from solver.physics.ends import LOAD, LOAD_LAB, RATE, RATE_LAB, Kinds
from solver.physics.loads.load import Point, add_forces, add_tangents, point, take_force, take_tangents
from solver.physics.loads.load import Tangents as LoadTangent
from solver.physics.loads.registry import Loads


class Driven(NamedTuple):
    """What is given at the stages: ends' `kinds` (2, 6), `values` (3, 2, 6) and dead lab loads `dead` (3, 2, 6);
    forces on the nodes `push` (3, N + 1, 3), lab. Of each end its `compliance` (2,), see `physics.axial`, and the
    `mass` (2,) of the body there, kg."""

    kinds: Kinds
    values: Array
    dead: Array
    push: Array
    compliance: Array
    mass: Array

    @classmethod
    def empty(cls, intervals: int) -> Driven:
        """Zeros for N = `intervals`."""
        return cls(np.zeros((2, 6), np.int64), np.zeros((3, 2, 6)), np.zeros((3, 2, 6)),
                   np.zeros((3, intervals + 1, 3)), np.zeros(2), np.zeros(2))  # fmt: skip


class Tangents(NamedTuple):
    """Tangents of the balances at one stage, common to all eigenvalues lambda of the time scheme.

    Segments (N, 3, 3): translation's `M` by acceleration, `C` by velocity, `K` by place, `E` by rotation (with the sign
    of a load); rotation's `spin` by the rate of rotation. Orientations (N + 2, 3, 3): rotation's `stiff`, `before`,
    `behind` by the rotation of the orientation itself, the one before and the one behind, and `stiff_t`, `before_t`,
    `behind_t` by their rates, as the rod's viscosity has them; `R` the rotations. `ahead`,
    `back` (N + 1, 2, 3, 3) of the joints, and `opens` (N + 1, 3, 3, 3), what e t is by a rotation of the orientation
    before and of the one behind, and by F; their transposes, with minus, are what F does to these orientations.
    Ends (2, 3, 3): `turn`, what a rotation of the end's frame does to the condition on its translation.
    Of the orientations at all stages (3, N + 2, 2): `spun`, see `stages.turn_residuals`.
    """

    M: Array
    C: Array
    K: Array
    E: Array
    spin: Array
    stiff: Array
    before: Array
    behind: Array
    stiff_t: Array
    before_t: Array
    behind_t: Array
    R: Array
    ahead: Array
    back: Array
    opens: Array
    turn: Array
    spun: Array

    @classmethod
    def empty(cls, intervals: int) -> Tangents:
        """Zeros for N = `intervals`."""
        N = intervals
        segments, orientations, joints = (N, 3, 3), (N + 2, 3, 3), (N + 1, 2, 3, 3)
        shapes = [segments] * 5 + [orientations] * 7 + [joints] * 2 + [(N + 1, 3, 3, 3), (2, 3, 3), (STAGES, N + 2, 2)]
        return cls(*(np.zeros(shape) for shape in shapes))


class Motion(NamedTuple):
    """How the segments move at a stage: centres' places, velocities and accelerations (N, 3), lab; rotations (N + 2, 3,
    3) and angular velocities (N + 2, 3) of all orientations."""

    r: Array
    V: Array
    A: Array
    R: Array
    omega: Array


@inlined
def motion_at(stages: Stages, i: int) -> Motion:
    """The motion at stage i."""
    return Motion(stages.r[i], stages.V[i], stages.A[i], stages.R[i], stages.omega[i])


class Balance(NamedTuple):
    """The residuals of a stage, translation (N, 3) and rotation (N + 2, 3), of segments of length h."""

    translation: Array
    rotation: Array
    h: float


class LoadTangents(NamedTuple):
    """The tangents to which those of loads are added, for segments of length h."""

    tangents: Tangents
    h: float


@variant(point, Motion)
@inner
def _point(motion: Motion, j: int) -> Point:
    R = matrix(motion.R, j + 1)
    return Point(vector(motion.r, j), vector(motion.V, j), vector(motion.A, j), (R[0][2], R[1][2], R[2][2]), R,
                 vector(motion.omega, j + 1))  # fmt: skip


@variant(take_force, Balance)
@inner
def _take_force(balance: Balance, j: int, at: Point, force: Any, moment: Any) -> None:
    add_vector(-balance.h, force, balance.translation[j])
    add_vector(-balance.h, moment, balance.rotation[j + 1])


@variant(take_tangents, LoadTangents)
@inner
def _take_tangents(load: LoadTangents, j: int, at: Point, by: LoadTangent) -> None:
    """M, C, K and spin of the balances, and E and stiff by rotation: the unknowns are r, whose rates are multiples of
    it by an eigenvalue, and psi."""
    tangents, h = load.tangents, load.h
    add_matrix(-h, by.M, tangents.M[j])
    add_matrix(-h, by.C, tangents.C[j])
    add_matrix(-h, by.K, tangents.K[j])
    add_matrix(h, by.E, tangents.E[j])
    add_matrix(h, tangent_by_rotation(by.by_T, at.R), tangents.E[j])
    add_matrix(-h, by.moment_E, tangents.stiff[j + 1])
    add_matrix(-h, by.moment_omega, tangents.spin[j])


@kernel
def balance_segments(chain: Chain, loads: Loads, driven: Driven, stages: Stages, residuals: Residuals, i: int) -> None:
    """Write the residuals of all segments at stage i.

    What not every scene has is added in loops of its own: where it stood within this one, the compiler made half as
    fast code of it, in scenes without, too.
    """
    h, N = chain.h, len(chain.mass)
    F, push = stages.F[i], driven.push[i]
    left, right = stages.left[i], stages.right[i]
    for j in range(N):
        R, A = stages.R[i, j + 1], stages.A[i, j]
        inertia, near, far = h * chain.mass[j], share(j, N), share(j + 1, N)
        for k in range(3):
            residuals.translation[i, j, k] = (inertia * A[k] - (F[j + 1, k] - F[j, k])
                                              - (near * push[j, k] + far * push[j + 1, k]))  # fmt: skip
        w, g = stages.omega[i, j + 1], stages.alpha[i, j + 1]
        I0, I1, I2 = chain.inertia[j, 0], chain.inertia[j, 1], chain.inertia[j, 2]
        p0, p1 = 0.0, 0.0
        for k in range(3):
            pull = F[j + 1, k] + F[j, k] + far * push[j + 1, k] - near * push[j, k]
            p0 += R[k, 0] * pull
            p1 += R[k, 1] * pull
        out = residuals.rotation[i, j + 1]
        out[0] = h * (I0 * g[0] + (I2 - I1) * w[1] * w[2]) + 0.5 * h * p1
        out[1] = h * (I1 * g[1] + (I0 - I2) * w[2] * w[0]) - 0.5 * h * p0
        out[2] = h * (I2 * g[2] + (I1 - I0) * w[0] * w[1])
        for k in range(3):
            out[k] += right[j, k] - left[j + 1, k]
    add_forces(loads, i, motion_at(stages, i), Balance(residuals.translation[i], residuals.rotation[i], h))


@kernel
def load_segments(reference: Reference) -> None:
    """Write the residuals of all segments at the first stage, whose motion is known."""
    balance_segments(reference.chain, reference.loads, reference.driven, reference.stages, reference.work.residuals, 0)


@kernel
def condition_ends(chain: Chain, driven: Driven, stages: Stages, residuals: Residuals, i: int) -> None:
    """Write what the conditions at the ends miss at stage i."""
    N = len(chain.mass)
    for side in range(2):
        frame = 0 if side == 0 else N + 1
        R, V = matrix(stages.R[i], frame), end_velocity(chain, stages, i, side)
        kinds, values, dead = driven.kinds[side], driven.values[i, side], driven.dead[i, side]
        if driven.compliance[side] > 0.0:  # the rod's end and what holds it move apart along the tangent
            T, give = (R[0][2], R[1][2], R[2][2]), driven.compliance[side] * (1.0 if side == 1 else -1.0)
            V = plus(V, times(dot(T, vector(stages.F_t[i], side)) * give, T))
        pull = _end_pull(chain, driven, stages, i, side)
        speed_within, pull_within = in_material(R, V), in_material(R, pull)
        couple = in_material(R, (dead[3], dead[4], dead[5]))
        inner = stages.left[i, 0] if side == 0 else stages.right[i, N]
        for k in range(3):
            if kinds[k] == RATE_LAB:
                missed = V[k]
            elif kinds[k] == LOAD_LAB:
                missed = pull[k]
            else:
                missed = speed_within[k] if kinds[k] == RATE else pull_within[k]
            residuals.ends[i, side, k] = missed - values[k]
            missed = stages.omega[i, frame, k] if kinds[3 + k] == RATE else inner[k] - couple[k]
            residuals.rotation[i, frame, k] = missed - values[3 + k]


@inner
def end_velocity(chain: Chain, stages: Stages, i: int, side: int) -> Any:
    """The velocity, lab, of the rod's start or end."""
    if side == 0:
        return vector(stages.base[i], 1)
    N, R = len(chain.mass), matrix(stages.R[i], len(chain.mass))
    lever, along = 0.5 * chain.h + stages.opening[i, 0, N], (R[0][2], R[1][2], R[2][2])
    swing = times(lever, tangent_rate(R, vector(stages.omega[i], N)))
    return plus(plus(vector(stages.V[i], N - 1), swing), times(stages.opening[i, 1, N], along))


@inner
def _end_acceleration(chain: Chain, stages: Stages, i: int, side: int) -> Any:
    """The acceleration, lab, of the rod's start or end."""
    if side == 0:
        return vector(stages.base[i], 2)
    N, R = len(chain.mass), matrix(stages.R[i], len(chain.mass))
    omega, alpha, opening = vector(stages.omega[i], N), vector(stages.alpha[i], N), stages.opening[i]
    swing = times(0.5 * chain.h + opening[0, N], tangent_acceleration(R, omega, alpha))
    swing = plus(swing, times(2.0 * opening[1, N], tangent_rate(R, omega)))
    return plus(plus(vector(stages.A[i], N - 1), swing), times(opening[2, N], (R[0][2], R[1][2], R[2][2])))


@inner
def _end_pull(chain: Chain, driven: Driven, stages: Stages, i: int, side: int) -> Any:
    """The force, lab, that is more in the rod's end than its dead loads and its body ask for."""
    pull = minus(vector(stages.F[i], 0 if side == 0 else len(chain.mass)), vector(driven.dead[i], side))
    if driven.mass[side] > 0.0:
        inertia = driven.mass[side] * (1.0 if side == 1 else -1.0)
        pull = plus(pull, times(inertia, _end_acceleration(chain, stages, i, side)))
    return pull


@kernel
def segment_tangents(chain: Chain, loads: Loads, driven: Driven, stages: Stages, i: int, tangents: Tangents) -> None:
    """Write the tangents at stage i of the balances and of the ends' conditions."""
    h, N, F, push = chain.h, len(chain.mass), stages.F[i], driven.push[i]
    joint_tangents(chain, stages.bend[i], stages.moment[i], tangents.ahead, tangents.back)
    copy(stages.R[i], tangents.R)
    tangents.M[:], tangents.C[:], tangents.K[:], tangents.E[:], tangents.spin[:] = 0.0, 0.0, 0.0, 0.0, 0.0
    tangents.stiff[:], tangents.before[:], tangents.behind[:] = 0.0, 0.0, 0.0
    for j in range(N):
        R, w = matrix(stages.R[i], j + 1), stages.omega[i, j + 1]
        M, spin, stiff = tangents.M[j], tangents.spin[j], tangents.stiff[j + 1]
        # with psi in a frame that does not turn, omega changes by psi_t and omega_t by psi_tt - omega x psi_t
        I0, I1, I2 = chain.inertia[j, 0], chain.inertia[j, 1], chain.inertia[j, 2]
        for k in range(3):
            M[k, k] = h * chain.mass[j]
        add_matrix(-h, in_material_by_rotation((I0 * w[0], I1 * w[1], I2 * w[2])), spin)
        spin[0, 1] += h * w[2] * (I0 - I1)
        spin[0, 2] -= h * w[1] * (I0 - I2)
        spin[1, 0] -= h * w[2] * (I1 - I0)
        spin[1, 2] += h * w[0] * (I1 - I2)
        spin[2, 0] += h * w[1] * (I2 - I0)
        spin[2, 1] -= h * w[0] * (I2 - I1)
        near, far = share(j, N), share(j + 1, N)
        pull = plus(vector(F, j + 1), vector(F, j))
        pull = plus(pull, minus(times(far, vector(push, j + 1)), times(near, vector(push, j))))
        add_matrix(-0.5 * h, lever_turned(in_material(R, pull)), stiff)
        for k in range(3):
            for m in range(3):
                stiff[k, m] += tangents.back[j, 1, k, m] - tangents.ahead[j + 1, 0, k, m]
                tangents.before[j + 1, k, m] = tangents.back[j, 0, k, m]
                tangents.behind[j + 1, k, m] = -tangents.ahead[j + 1, 1, k, m]
    add_tangents(loads, i, motion_at(stages, i), LoadTangents(tangents, h))
    _end_tangents(chain, driven, stages, i, tangents)
    if is_viscous(chain.elastic):
        rate_tangents(chain, stages.bend[i], tangents.stiff_t, tangents.before_t, tangents.behind_t)
    if stretches(chain.elastic):
        opening_tangents(chain, stages, i, tangents.stiff, tangents.before, tangents.behind, tangents.opens)


@inner
def _end_tangents(chain: Chain, driven: Driven, stages: Stages, i: int, tangents: Tangents) -> None:
    """Tangents of the conditions on a loaded end's rotation (the start's with the opposite sign), and `turn`."""
    N = len(chain.mass)
    for side in range(2):
        R, dead = matrix(stages.R[i], 0 if side == 0 else N + 1), driven.dead[i, side]
        swing = in_material_by_rotation(times(-1.0, in_material(R, (dead[3], dead[4], dead[5]))))
        speed = in_material(R, end_velocity(chain, stages, i, side))
        pull = in_material(R, _end_pull(chain, driven, stages, i, side))
        tangents.turn[side] = 0.0
        for k in range(3):
            for m in range(3):
                if side == 0:
                    tangents.stiff[0, k, m] = -tangents.ahead[0, 0, k, m] - swing[k][m]
                    tangents.behind[0, k, m] = -tangents.ahead[0, 1, k, m]
                else:
                    tangents.stiff[N + 1, k, m] = tangents.back[N, 1, k, m] + swing[k][m]
                    tangents.before[N + 1, k, m] = tangents.back[N, 0, k, m]
            # R[:, k] turns by R (psi x e_k): the condition on component k changes by (g x psi)_k, g = R^t vector
            kind = driven.kinds[side, k]
            if kind in (RATE, LOAD):
                g, one, two = speed if kind == RATE else pull, (k + 1) % 3, (k + 2) % 3
                tangents.turn[side, k, two] += g[one]
                tangents.turn[side, k, one] -= g[two]
