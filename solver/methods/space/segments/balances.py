"""The balances of the segments and the conditions at the ends at one stage: residuals and tangents.

For segment j with centre r, tangent T = R a3, forces F_j and F_j+1 at its nodes and q turned into its frame there:

    h (rho_c A dV/dt - B)                 - (F_j+1 - F_j)                                         = 0   lab
    h (I omega_t + omega x I omega - Q)   - (q_right - q_left) - (h/2) a3 x R^t (F_j+1 + F_j)     = 0   material

with I about the segment's centre. Forces on the nodes (contact) are shared by the segments that meet there.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from solver.arrays import Array
from solver.kernels.kernel import inlined, kernel
from solver.kernels.scratch import scratch
from solver.methods.space.segments.chain import Chain, Residuals, Stages
from solver.methods.space.segments.joints import joint_tangents
from solver.physics.ends import LOAD, LOAD_LAB, RATE, RATE_LAB, Kinds
from solver.physics.loads.applied import Loads
from solver.physics.loads.fluid import add_added_mass, add_drag, add_fluid_force


class Driven(NamedTuple):
    """What is given at the stages: loads per length `lab`, `material` (3, N, 6); ends' `kinds` (2, 6), `values`
    (3, 2, 6) and dead lab loads `dead` (3, 2, 6); forces on the nodes `push` (3, N + 1, 3), lab."""

    lab: Array
    material: Array
    kinds: Kinds
    values: Array
    dead: Array
    push: Array

    @classmethod
    def empty(cls, intervals: int) -> Driven:
        """Zeros for N = `intervals`."""
        N = intervals
        return cls(np.zeros((3, N, 6)), np.zeros((3, N, 6)), np.zeros((2, 6), np.int64), np.zeros((3, 2, 6)),
                   np.zeros((3, 2, 6)), np.zeros((3, N + 1, 3)))  # fmt: skip


class Tangents(NamedTuple):
    """Tangents of the balances at one stage, common to all eigenvalues lambda of the time scheme.

    Segments (N, 3, 3): translation's `M` by acceleration, `C` by velocity, `E` by rotation (with the sign of a load);
    rotation's `spin` by the rate of rotation. Orientations (N + 2, 3, 3): rotation's `stiff`, `before`, `behind` by the
    rotation of the orientation itself, the one before and the one behind; `R` the rotations. `ahead`, `back` (N + 1, 2,
    3, 3) of the joints. Ends (2, 3, 3): `turn`, what a rotation of the end's frame does to the condition on its
    translation.
    """

    M: Array
    C: Array
    E: Array
    spin: Array
    stiff: Array
    before: Array
    behind: Array
    R: Array
    ahead: Array
    back: Array
    turn: Array

    @classmethod
    def empty(cls, intervals: int) -> Tangents:
        """Zeros for N = `intervals`."""
        N = intervals
        segments, orientations, joints = (N, 3, 3), (N + 2, 3, 3), (N + 1, 2, 3, 3)
        shapes = [segments] * 4 + [orientations] * 4 + [joints] * 2 + [(2, 3, 3)]
        return cls(*(np.zeros(shape) for shape in shapes))


@inlined
def share(j: int, last: int) -> float:
    """Part of the force on node j that one of the segments beside it takes."""
    return 1.0 if j == 0 or j == last else 0.5


@kernel
def balance_segments(chain: Chain, loads: Loads, driven: Driven, stages: Stages, residuals: Residuals, i: int) -> None:
    """Write the residuals of all segments at stage i.

    What not every scene has is added in loops of its own: where it stood within this one, the compiler made half as
    fast code of it, in scenes without, too.
    """
    h, c = chain.h, loads.damping
    N = len(chain.mass)
    F, push = stages.F[i], driven.push[i]
    left, right = stages.left[i], stages.right[i]
    for j in range(N):
        R, V, A = stages.R[i, j + 1], stages.V[i, j], stages.A[i, j]
        mass = chain.mass[j]
        lab, material = driven.lab[i, j], driven.material[i, j]
        near, far = share(j, N), share(j + 1, N)
        for k in range(3):
            P = mass * (A[k] + c * V[k]) - lab[k]
            residuals.translation[i, j, k] = (h * P - (F[j + 1, k] - F[j, k])
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
            out[k] += h * (c * chain.dry_inertia[j, k] * w[k] - material[3 + k]) - left[j + 1, k] + right[j, k]
    if loads.follows or loads.turns:
        _turn_loads(h, driven, stages, residuals, i)
    if loads.wet:
        _add_fluid(h, loads, stages, residuals, i)


@kernel
def _turn_loads(h: float, driven: Driven, stages: Stages, residuals: Residuals, i: int) -> None:
    """Subtract the forces given in the material frame, and the moments given in the lab's."""
    for j in range(len(driven.lab[i])):
        R, lab, material = stages.R[i, j + 1], driven.lab[i, j], driven.material[i, j]
        force, moment = residuals.translation[i, j], residuals.rotation[i, j + 1]
        for k in range(3):
            force[k] -= h * (R[k, 0] * material[0] + R[k, 1] * material[1] + R[k, 2] * material[2])
            moment[k] -= h * (R[0, k] * lab[3] + R[1, k] * lab[4] + R[2, k] * lab[5])


@kernel
def _add_fluid(h: float, loads: Loads, stages: Stages, residuals: Residuals, i: int) -> None:
    """Add the fluid's force."""
    P, u, T = scratch(3), scratch(3), scratch(3)
    for j in range(len(stages.V[i])):
        for k in range(3):
            P[k], u[k], T[k] = 0.0, stages.V[i, j, k] - loads.current[k], stages.R[i, j + 1, k, 2]
        add_fluid_force(loads.added_mass[j], loads.drag_normal[j], loads.drag_tangential[j], stages.A[i, j], u, T, P)
        for k in range(3):
            residuals.translation[i, j, k] += h * P[k]


@kernel
def condition_ends(chain: Chain, driven: Driven, stages: Stages, residuals: Residuals, i: int) -> None:
    """Write what the conditions at the ends miss at stage i."""
    N = len(chain.mass)
    V = scratch(3)
    for side in range(2):
        frame, node = (0, 0) if side == 0 else (N + 1, N)
        R = stages.R[i, frame]
        if side == 0:
            V[:] = stages.base[i, 1]
        else:
            w, Q = stages.omega[i, N], stages.R[i, N]
            for k in range(3):
                V[k] = stages.V[i, N - 1, k] + 0.5 * chain.h * (Q[k, 0] * w[1] - Q[k, 1] * w[0])
        kinds, values, dead = driven.kinds[side], driven.values[i, side], driven.dead[i, side]
        inner = stages.left[i, 0] if side == 0 else stages.right[i, N]
        for k in range(3):
            if kinds[k] == RATE_LAB:
                missed = V[k]
            elif kinds[k] == LOAD_LAB:
                missed = stages.F[i, node, k] - dead[k]
            else:
                missed = 0.0
                for m in range(3):
                    missed += R[m, k] * (V[m] if kinds[k] == RATE else stages.F[i, node, m] - dead[m])
            residuals.ends[i, side, k] = missed - values[k]
            if kinds[3 + k] == RATE:
                missed = stages.omega[i, frame, k]
            else:
                missed = inner[k] - (R[0, k] * dead[3] + R[1, k] * dead[4] + R[2, k] * dead[5])
            residuals.rotation[i, frame, k] = missed - values[3 + k]


@kernel
def _cross_matrix(x: Array, factor: float, out: Array) -> None:
    """Add factor [x] to `out` (3, 3)."""
    out[0, 1] -= factor * x[2]
    out[0, 2] += factor * x[1]
    out[1, 0] += factor * x[2]
    out[1, 2] -= factor * x[0]
    out[2, 0] -= factor * x[1]
    out[2, 1] += factor * x[0]


@kernel
def segment_tangents(chain: Chain, loads: Loads, driven: Driven, stages: Stages, i: int, tangents: Tangents) -> None:
    """Write the tangents at stage i of the balances and of the ends' conditions."""
    h, c = chain.h, loads.damping
    N = len(chain.mass)
    joint_tangents(chain, stages.bend[i], stages.moment[i], tangents.ahead, tangents.back)
    tangents.R[:] = stages.R[i]
    tangents.stiff[:] = 0.0
    tangents.before[:] = 0.0
    tangents.behind[:] = 0.0
    g, swing = scratch(3), scratch((3, 3))
    for j in range(N):
        R, w = stages.R[i, j + 1], stages.omega[i, j + 1]
        M, C, E, spin, stiff = tangents.M[j], tangents.C[j], tangents.E[j], tangents.spin[j], tangents.stiff[j + 1]
        for k in range(3):
            for m in range(3):
                M[k, m] = 0.0
                C[k, m] = 0.0
                E[k, m] = 0.0
                spin[k, m] = 0.0
            M[k, k] = h * chain.mass[j]
            C[k, k] = h * c * chain.mass[j]
        # with psi in a frame that does not turn, omega changes by psi_t and omega_t by psi_tt - omega x psi_t
        I0, I1, I2 = chain.inertia[j, 0], chain.inertia[j, 1], chain.inertia[j, 2]
        for k in range(3):
            spin[k, k] = h * c * chain.dry_inertia[j, k]
            g[k] = chain.inertia[j, k] * w[k]
        _cross_matrix(g, -h, spin)
        spin[0, 1] += h * w[2] * (I0 - I1)
        spin[0, 2] -= h * w[1] * (I0 - I2)
        spin[1, 0] -= h * w[2] * (I1 - I0)
        spin[1, 2] += h * w[0] * (I1 - I2)
        spin[2, 0] += h * w[1] * (I2 - I0)
        spin[2, 1] -= h * w[0] * (I2 - I1)
        near, far = share(j, N), share(j + 1, N)
        for k in range(3):
            g[k] = 0.0
            for m in range(3):
                pull = stages.F[i, j + 1, m] + stages.F[i, j, m]
                pull += far * driven.push[i, j + 1, m] - near * driven.push[i, j, m]
                g[k] += R[m, k] * pull
        # -(h/2) a3 x (g x psi) = (h/2) (g_3 psi - ...), its third row is 0
        stiff[0, 0] += 0.5 * h * g[2]
        stiff[0, 2] -= 0.5 * h * g[0]
        stiff[1, 1] += 0.5 * h * g[2]
        stiff[1, 2] -= 0.5 * h * g[1]
        for k in range(3):
            for m in range(3):
                stiff[k, m] += tangents.back[j, 1, k, m] - tangents.ahead[j + 1, 0, k, m]
                tangents.before[j + 1, k, m] = tangents.back[j, 0, k, m]
                tangents.behind[j + 1, k, m] = -tangents.ahead[j + 1, 1, k, m]
    if loads.follows or loads.turns:
        _turned_loads_tangents(h, driven, stages, i, tangents)
    if loads.wet:
        _fluid_tangents(h, loads, stages, i, tangents)
    _end_tangents(chain, driven, stages, i, tangents, swing)


@kernel
def _turned_loads_tangents(h: float, driven: Driven, stages: Stages, i: int, tangents: Tangents) -> None:
    """Add the tangents of `_turn_loads`."""
    g = scratch(3)
    for j in range(len(driven.lab[i])):
        R, b, E = stages.R[i, j + 1], driven.material[i, j], tangents.E[j]
        for k in range(3):
            E[k, 0] += h * (R[k, 2] * b[1] - R[k, 1] * b[2])
            E[k, 1] += h * (R[k, 0] * b[2] - R[k, 2] * b[0])
            E[k, 2] += h * (R[k, 1] * b[0] - R[k, 0] * b[1])
            g[k] = R[0, k] * driven.lab[i, j, 3] + R[1, k] * driven.lab[i, j, 4] + R[2, k] * driven.lab[i, j, 5]
        _cross_matrix(g, -h, tangents.stiff[j + 1])


@kernel
def _fluid_tangents(h: float, loads: Loads, stages: Stages, i: int, tangents: Tangents) -> None:
    """Add the tangents of `_add_fluid`."""
    P, u, T = scratch(3), scratch(3), scratch(3)
    T_w, M, C, E = scratch((3, 3)), scratch((3, 3)), scratch((3, 3)), scratch((3, 3))
    for j in range(len(stages.V[i])):
        R = stages.R[i, j + 1]
        for k in range(3):
            u[k], T[k] = stages.V[i, j, k] - loads.current[k], R[k, 2]
            T_w[k, 0], T_w[k, 1], T_w[k, 2] = -R[k, 1], R[k, 0], 0.0
        M[:, :], C[:, :], E[:, :] = 0.0, 0.0, 0.0
        add_added_mass(loads.added_mass[j], 1.0, stages.A[i, j], T, T_w, P, M, E)
        add_drag(loads.drag_normal[j], loads.drag_tangential[j], u, T, T_w, P, C, E)
        for k in range(3):
            for m in range(3):
                tangents.M[j, k, m] += h * M[k, m]
                tangents.C[j, k, m] += h * C[k, m]
                tangents.E[j, k, m] -= h * E[k, m]


@kernel
def _end_tangents(chain: Chain, driven: Driven, stages: Stages, i: int, tangents: Tangents, swing: Array) -> None:
    """Tangents of the conditions on a loaded end's rotation (the start's with the opposite sign), and `turn`."""
    N = len(chain.mass)
    g, V = scratch(3), scratch(3)
    for side in range(2):
        frame, node = (0, 0) if side == 0 else (N + 1, N)
        R, dead = stages.R[i, frame], driven.dead[i, side]
        for k in range(3):
            g[k] = R[0, k] * dead[3] + R[1, k] * dead[4] + R[2, k] * dead[5]
        swing[:, :] = 0.0
        _cross_matrix(g, -1.0, swing)
        w, Q = stages.omega[i, N], stages.R[i, N]
        for k in range(3):
            V[k] = stages.base[i, 1, k]
            if side == 1:
                V[k] = stages.V[i, N - 1, k] + 0.5 * chain.h * (Q[k, 0] * w[1] - Q[k, 1] * w[0])
        tangents.turn[side] = 0.0
        for k in range(3):
            for m in range(3):
                if side == 0:
                    tangents.stiff[0, k, m] = -tangents.ahead[0, 0, k, m] - swing[k, m]
                    tangents.behind[0, k, m] = -tangents.ahead[0, 1, k, m]
                else:
                    tangents.stiff[N + 1, k, m] = tangents.back[N, 1, k, m] + swing[k, m]
                    tangents.before[N + 1, k, m] = tangents.back[N, 0, k, m]
            # R[:, k] turns by R (psi x e_k): the condition on component k changes by (g x psi)_k, g = R^t vector
            kind = driven.kinds[side, k]
            if kind in (RATE, LOAD):
                for m in range(3):
                    g[m] = 0.0
                    for n in range(3):
                        g[m] += R[n, m] * (V[n] if kind == RATE else stages.F[i, node, n] - dead[n])
                one, two = (k + 1) % 3, (k + 2) % 3
                tangents.turn[side, k, two] += g[one]
                tangents.turn[side, k, one] -= g[two]
