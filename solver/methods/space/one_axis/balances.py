"""The balances of the segments and the conditions at the ends at one stage, about one axis: residuals and tangents.

As in `space.segments.balances`, with plane vectors as complex numbers: the couple of a force f on T is Im(conj(T) f).
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from solver.arrays import Array
from solver.kernels.copying import copy
from solver.kernels.dispatch import variant
from solver.kernels.kernel import inlined, inner, kernel
from solver.kernels.vectors import add_matrix, add_vector, tangent_by_rotation, vector
from solver.methods.space.one_axis.axis import Plane
from solver.methods.space.one_axis.chain import Chain, Residuals, Stages
from solver.methods.space.one_axis.motion import bend_joints
from solver.methods.space.segments.chain import STAGES
from solver.physics.elasticity import is_viscous, tangent
from solver.physics.ends import LOAD, RATE, RATE_LAB, Kinds
from solver.physics.loads.load import Point, add_forces, add_tangents, point, take_force, take_tangents
from solver.physics.loads.load import Tangents as LoadTangent
from solver.physics.loads.registry import LoadsAbout


class Driven(NamedTuple):
    """What is given at the stages. Of each end, translation twice and rotation: `kinds` (2, 3), `values` (3, 2, 3); of
    the translation's conditions the `direction` (2, 2), lab or material; the dead loads `dead` (3, 2) and `couple`
    (3, 2)."""

    kinds: Kinds
    values: Array
    direction: Plane
    dead: Plane
    couple: Array

    @classmethod
    def empty(cls, _intervals: int) -> Driven:
        """Zeros, as many for a rod of any number of intervals."""
        return cls(np.zeros((2, 3), np.int64), np.zeros((STAGES, 2, 3)), np.zeros((2, 2), complex),
                   np.zeros((STAGES, 2), complex), np.zeros((STAGES, 2)))  # fmt: skip


class Tangents(NamedTuple):
    """Tangents of the balances at one stage.

    Segments: translation's `M` by acceleration, `C` by velocity and `K` by place (N, 2, 2), and `E` (N,) by rotation
    (with the sign of a load); rotation's `spin` by the rate of rotation. Orientations (N + 2,): rotation's `stiff` by
    their own rotation, and `T`. Joints (N + 1,): `spring`, dq by their rotation; `spring_t` by its rate, 0 without
    viscosity. Ends (2, 2): `turn`, what a rotation
    of the end's frame does to the conditions on its translation.
    """

    M: Array
    C: Array
    K: Array
    E: Plane
    spin: Array
    stiff: Array
    T: Plane
    spring: Array
    spring_t: Array
    turn: Array

    @classmethod
    def empty(cls, intervals: int) -> Tangents:
        """Zeros for N = `intervals`."""
        N = intervals
        return cls(np.zeros((N, 2, 2)), np.zeros((N, 2, 2)), np.zeros((N, 2, 2)), np.zeros(N, complex), np.zeros(N),
                   np.zeros(N + 2), np.zeros(N + 2, complex), np.zeros(N + 1), np.zeros(N + 1),
                   np.zeros((2, 2)))  # fmt: skip


class Motion(NamedTuple):
    """How the segments move at a stage: centres' places, velocities and accelerations (N,); tangents and angular
    velocities (N + 2,) of all orientations; whether the tangents turn."""

    r: Plane
    V: Plane
    A: Plane
    T: Plane
    omega: Array
    swing: float


@inlined
def motion_at(chain: Chain, stages: Stages, i: int) -> Motion:
    """The motion at stage i."""
    return Motion(stages.r[i], stages.V[i], stages.A[i], stages.T[i], stages.omega[i], chain.swing)


class Balance(NamedTuple):
    """The residuals of a stage, translation (N, 2) and rotation (N + 2,), of segments of length h."""

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
    T = vector(motion.T, j + 1)
    return Point(vector(motion.r, j), vector(motion.V, j), vector(motion.A, j), T, (T[0], T[1], motion.swing),
                 motion.omega[j + 1])  # fmt: skip


@variant(take_force, Balance)
@inner
def _take_force(balance: Balance, j: int, at: Point, force: Any, moment: Any) -> None:
    add_vector(-balance.h, force, balance.translation[j])
    _add_number(-balance.h, moment, balance.rotation, j + 1)


@variant(take_tangents, LoadTangents)
@inner
def _take_tangents(load: LoadTangents, j: int, at: Point, by: LoadTangent) -> None:
    """As in `space.segments.balances`."""
    tangents, h = load.tangents, load.h
    add_matrix(-h, by.M, tangents.M[j])
    add_matrix(-h, by.C, tangents.C[j])
    add_matrix(-h, by.K, tangents.K[j])
    _add_turning(h, by.E, tangents.E, j)
    _add_turning(h, tangent_by_rotation(by.by_T, at.R), tangents.E, j)
    _add_number(-h, by.moment_E, tangents.stiff, j + 1)
    _add_number(-h, by.moment_omega, tangents.spin, j)


@inner
def _add_turning(factor: float, x: Any, out: Plane, j: int) -> None:
    if x is not None:
        out[j] += complex(factor * x[0], factor * x[1])


@inner
def _add_number(factor: float, x: Any, out: Array, j: int) -> None:
    if x is not None:
        out[j] += factor * x


@inlined
def along(T: complex, z: complex) -> float:
    """The component of z along T."""
    return T.real * z.real + T.imag * z.imag


@inlined
def across(T: complex, z: complex) -> float:
    """The component of z along i T."""
    return T.real * z.imag - T.imag * z.real


@inner
def end_velocity(chain: Chain, stages: Stages, i: int, side: int) -> complex:
    """V of the first or the last node at stage i."""
    N = len(chain.mass)
    if side == 0:
        return complex(stages.base[i, 1])
    w, T = 0.5 * chain.h * chain.swing * stages.omega[i, N], stages.T[i, N]
    return complex(stages.V[i, N - 1] + complex(-w * T.imag, w * T.real))


@kernel
def balance(chain: Chain, loads: LoadsAbout, driven: Driven, stages: Stages, residuals: Residuals, i: int) -> None:
    """Write the residuals of all segments, and what the conditions at the ends miss, at stage i."""
    h, F, q = chain.h, stages.F[i], stages.q[i]
    bend_joints(chain, stages.phi[i], stages.omega[i], q)
    for j in range(len(chain.mass)):
        T, P = stages.T[i, j + 1], h * chain.mass[j] * stages.A[i, j] - (F[j + 1] - F[j])
        residuals.translation[i, j, 0], residuals.translation[i, j, 1] = P.real, P.imag
        couple = 0.5 * chain.swing * across(T, F[j + 1] + F[j])
        turning = chain.inertia[j] * stages.alpha[i, j + 1] - couple
        residuals.rotation[i, j + 1] = h * turning - (q[j + 1] - q[j])
    add_forces(loads, i, motion_at(chain, stages, i), Balance(residuals.translation[i], residuals.rotation[i], h))
    for side in range(2):
        frame, node = (0, 0) if side == 0 else (len(F), len(F) - 1)
        speed, pull, kinds = end_velocity(chain, stages, i, side), F[node] - driven.dead[i, side], driven.kinds[side]
        for k in range(2):
            d = driven.direction[side, k]
            if kinds[k] in (RATE, LOAD):
                d *= stages.T[i, frame]
            residuals.ends[i, side, k] = along(d, speed if kinds[k] in (RATE, RATE_LAB) else pull)
            residuals.ends[i, side, k] -= driven.values[i, side, k]
        missed = stages.omega[i, frame] if kinds[2] == RATE else q[node] - driven.couple[i, side]
        residuals.rotation[i, frame] = missed - driven.values[i, side, 2]


@kernel
def tangents_at(chain: Chain, loads: LoadsAbout, driven: Driven, stages: Stages, i: int, tangents: Tangents) -> None:
    """Write the tangents at stage i of the balances and of the ends' conditions."""
    h, N, F = chain.h, len(chain.mass), stages.F[i]
    copy(stages.T[i], tangents.T)
    tangents.M[:], tangents.C[:], tangents.K[:], tangents.spin[:], tangents.stiff[:] = 0.0, 0.0, 0.0, 0.0, 0.0
    tangents.E[:] = 0.0
    for j in range(N + 1):
        kappa = (stages.phi[i, j + 1] - stages.phi[i, j]) / chain.span[j]
        tangents.spring[j] = tangent(chain.elastic, j, kappa) / chain.span[j]
        tangents.spring_t[j] = chain.elastic.viscosity[j] / chain.span[j] if is_viscous(chain.elastic) else 0.0
        tangents.stiff[j] += tangents.spring[j]
        tangents.stiff[j + 1] += tangents.spring[j]
    for j in range(N):
        for k in range(2):
            tangents.M[j, k, k] = h * chain.mass[j]
        tangents.stiff[j + 1] += 0.5 * h * chain.swing * along(stages.T[i, j + 1], F[j + 1] + F[j])
    add_tangents(loads, i, motion_at(chain, stages, i), LoadTangents(tangents, h))
    for side in range(2):
        frame, node = (0, 0) if side == 0 else (N + 1, N)
        V, pull = end_velocity(chain, stages, i, side), F[node] - driven.dead[i, side]
        for k in range(2):
            kind, d = driven.kinds[side, k], 1j * chain.swing * driven.direction[side, k] * stages.T[i, frame]
            tangents.turn[side, k] = 0.0
            if kind in (RATE, LOAD):
                tangents.turn[side, k] = along(d, V if kind == RATE else pull)
