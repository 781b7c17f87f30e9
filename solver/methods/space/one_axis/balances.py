"""The balances of the segments and the conditions at the ends at one stage, about one axis: residuals and tangents.

As in `staggered.segments`, with plane vectors as complex numbers: the couple of a force f on T is Im(conj(T) f), and
with the velocity relative to the current u = (a + i b) T and the acceleration A = (A_T + i A_N) T the fluid's force is

    -B = (k_t |a| a + i (k_n |b| b + m_a A_N)) T.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from solver.arrays import Array
from solver.kernels.kernel import inlined, kernel
from solver.methods.space.one_axis.axis import Plane
from solver.methods.space.one_axis.chain import Chain, Residuals, Stages
from solver.methods.space.one_axis.motion import bend_joints
from solver.methods.space.segments.chain import STAGES
from solver.physics.ends import LOAD, RATE, RATE_LAB, Kinds
from solver.physics.loads.applied import Loads


class Driven(NamedTuple):
    """What is given at the stages: loads per length `force` (lab) and `following` (material, z / T) (3, N), `moment`
    (3, N); `current` (1,). Of each end, translation twice and rotation: `kinds` (2, 3), `values` (3, 2, 3); of the
    translation's conditions the `direction` (2, 2), lab or material; the dead loads `dead` (3, 2) and `couple`
    (3, 2)."""

    force: Plane
    following: Plane
    moment: Array
    current: Plane
    kinds: Kinds
    values: Array
    direction: Plane
    dead: Plane
    couple: Array

    @classmethod
    def empty(cls, intervals: int) -> Driven:
        """Zeros for N = `intervals`."""
        force, following = np.zeros((STAGES, intervals), complex), np.zeros((STAGES, intervals), complex)
        return cls(force, following, np.zeros((STAGES, intervals)), np.zeros(1, complex), np.zeros((2, 3), np.int64),
                   np.zeros((STAGES, 2, 3)), np.zeros((2, 2), complex), np.zeros((STAGES, 2), complex),
                   np.zeros((STAGES, 2)))  # fmt: skip


class Tangents(NamedTuple):
    """Tangents of the balances at one stage.

    Segments (N,): translation's `M` by acceleration and `C` by velocity (N, 2), along and across T, and `E` by rotation
    (with the sign of a load); rotation's `spin` by the rate of rotation. Orientations (N + 2,): rotation's `stiff` by
    their own rotation, and `T`. Ends (2, 2): `turn`, what a rotation of the end's frame does to the conditions on its
    translation.
    """

    M: Array
    C: Array
    E: Plane
    spin: Array
    stiff: Array
    T: Plane
    turn: Array

    @classmethod
    def empty(cls, intervals: int) -> Tangents:
        """Zeros for N = `intervals`."""
        N = intervals
        return cls(np.zeros((N, 2)), np.zeros((N, 2)), np.zeros(N, complex), np.zeros(N), np.zeros(N + 2),
                   np.zeros(N + 2, complex), np.zeros((2, 2)))  # fmt: skip


@inlined
def along(T: complex, z: complex) -> float:
    """The component of z along T."""
    return T.real * z.real + T.imag * z.imag


@inlined
def across(T: complex, z: complex) -> float:
    """The component of z along i T."""
    return T.real * z.imag - T.imag * z.real


@kernel
def end_velocity(chain: Chain, stages: Stages, i: int, side: int) -> complex:
    """V of the first or the last node at stage i."""
    N = len(chain.mass)
    if side == 0:
        return complex(stages.base[i, 1])
    w, T = 0.5 * chain.h * chain.swing * stages.omega[i, N], stages.T[i, N]
    return complex(stages.V[i, N - 1] + complex(-w * T.imag, w * T.real))


@kernel
def balance(chain: Chain, loads: Loads, driven: Driven, stages: Stages, residuals: Residuals, i: int) -> None:
    """Write the residuals of all segments, and what the conditions at the ends miss, at stage i."""
    h, c = chain.h, loads.damping
    F, q = stages.F[i], stages.q[i]
    bend_joints(chain, stages.phi[i], q)
    for j in range(len(chain.mass)):
        T, V, A = stages.T[i, j + 1], stages.V[i, j], stages.A[i, j]
        P = chain.mass[j] * (A + c * V) - driven.force[i, j]
        if loads.follows:
            P -= T * driven.following[i, j]
        if loads.wet:
            u = V - driven.current[0]
            a, b = along(T, u), across(T, u)
            P += T * complex(loads.drag_tangential[j] * abs(a) * a,
                             loads.drag_normal[j] * abs(b) * b + loads.added_mass[j] * across(T, A))  # fmt: skip
        P = h * P - (F[j + 1] - F[j])
        residuals.translation[i, j, 0], residuals.translation[i, j, 1] = P.real, P.imag
        turning = chain.inertia[j] * stages.alpha[i, j + 1] + c * chain.dry_inertia[j] * stages.omega[i, j + 1]
        couple = 0.5 * chain.swing * across(T, F[j + 1] + F[j])
        residuals.rotation[i, j + 1] = h * (turning - driven.moment[i, j] - couple) - (q[j + 1] - q[j])
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
def tangents_at(chain: Chain, loads: Loads, driven: Driven, stages: Stages, i: int, tangents: Tangents) -> None:
    """Write the tangents at stage i of the balances and of the ends' conditions."""
    h, c = chain.h, loads.damping
    N, F = len(chain.mass), stages.F[i]
    tangents.T[:] = stages.T[i]
    tangents.stiff[:] = 0.0
    for j in range(N + 1):
        tangents.stiff[j] += chain.stiffness[j] / chain.span[j]
        tangents.stiff[j + 1] += chain.stiffness[j] / chain.span[j]
    for j in range(N):
        T, swung = stages.T[i, j + 1], 0.0j
        M, C = tangents.M[j], tangents.C[j]
        M[0], M[1] = h * chain.mass[j], h * chain.mass[j]
        C[0], C[1] = c * M[0], c * M[0]
        tangents.spin[j] = h * c * chain.dry_inertia[j]
        if loads.wet:
            u, A = stages.V[i, j] - driven.current[0], stages.A[i, j]
            a, b = along(T, u), across(T, u)
            by_a, by_b = loads.drag_tangential[j] * abs(a), loads.drag_normal[j] * abs(b)
            M[1] += h * loads.added_mass[j]
            C[0] += 2.0 * h * by_a
            C[1] += 2.0 * h * by_b
            swung = complex(2.0 * by_a * b - by_b * b - loads.added_mass[j] * across(T, A),
                            by_a * a - 2.0 * by_b * a - loads.added_mass[j] * along(T, A))  # fmt: skip
        if loads.follows:
            swung -= 1j * driven.following[i, j]
        tangents.E[j] = -h * chain.swing * T * swung
        tangents.stiff[j + 1] += 0.5 * h * chain.swing * along(T, F[j + 1] + F[j])
    for side in range(2):
        frame, node = (0, 0) if side == 0 else (N + 1, N)
        V, pull = end_velocity(chain, stages, i, side), F[node] - driven.dead[i, side]
        for k in range(2):
            kind, d = driven.kinds[side, k], 1j * chain.swing * driven.direction[side, k] * stages.T[i, frame]
            tangents.turn[side, k] = 0.0
            if kind in (RATE, LOAD):
                tangents.turn[side, k] = along(d, V if kind == RATE else pull)
