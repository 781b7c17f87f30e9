"""Energies of the chain, and what flows in and out within a step, in the method's own quadrature."""

from __future__ import annotations

import numpy as np

from solver.arrays import Array
from solver.kernels.handed import Reference
from solver.kernels.kernel import kernel
from solver.kernels.scratch import scratch
from solver.measures.energies import Energies
from solver.methods.space.segments.balances import Driven
from solver.methods.space.segments.chain import STAGES, Chain, Stages
from solver.physics.loads.applied import Loads
from solver.physics.loads.fluid import fluid_power


def energies(chain: Chain, loads: Loads, bend: Array, omega: Array, centres: Array, tangents: Array,
             weight: Array) -> Energies:  # fmt: skip
    """The energies at a state: joints' `bend` (N + 1, 3); segments' `omega`, `tangents`, `weight` (N, 3); `centres`
    (2, N, 3), position and velocity."""
    return Energies(*_integrate(chain, loads, bend, omega, centres, tangents, weight))


@kernel
def _integrate(chain: Chain, loads: Loads, bend: Array, omega: Array, centres: Array, tangents: Array,
               weight: Array) -> tuple[float, float, float, float, float]:  # fmt: skip
    """The energies in their order."""
    bending, torsion, kinetic, added, potential = 0.0, 0.0, 0.0, 0.0, 0.0
    for i in range(len(bend)):
        for k in range(3):
            strain = bend[i, k] / chain.span[i] - chain.kappa0[i, k]
            energy = 0.5 * chain.span[i] * chain.stiffness[i, k] * strain * strain
            if k < 2:
                bending += energy
            else:
                torsion += energy
    for j in range(len(omega)):
        along = 0.0
        for k in range(3):
            along += tangents[j, k] * (centres[1, j, k] - loads.current[k])
        for k in range(3):
            velocity, spin = centres[1, j, k], omega[j, k] * omega[j, k]
            across = velocity - loads.current[k] - along * tangents[j, k]
            kinetic += chain.mass[j] * velocity * velocity + chain.dry_inertia[j, k] * spin
            added += loads.added_mass[j] * across * across + (chain.inertia[j, k] - chain.dry_inertia[j, k]) * spin
            potential -= weight[j, k] * centres[0, j, k]
    return bending, torsion, 0.5 * chain.h * kinetic, 0.5 * chain.h * added, chain.h * potential


@kernel
def stage_powers(given: Reference, weight: Array, ends: Array, out: Array) -> None:
    """Write the power (W) of the ends, of loads other than `weight`, and dissipated, at the stages into `out` (3, 3).

    `given`: see `newton.step`; `ends` (3, 2, 3): velocities of the first and the last node at the stages, lab.
    """
    chain, loads, driven, _, stages, _, _ = given.records
    N = len(chain.mass)
    for i in range(STAGES):
        by_loads, lost, work = 0.0, 0.0, 0.0
        for k in range(3):
            work += stages.F[i, N, k] * ends[i, 1, k] - stages.F[i, 0, k] * ends[i, 0, k]
            work += stages.right[i, N, k] * stages.omega[i, N + 1, k] - stages.left[i, 0, k] * stages.omega[i, 0, k]
        for j in range(N):
            V, w = stages.V[i, j], stages.omega[i, j + 1]
            lab, material = driven.lab[i, j], driven.material[i, j]
            for k in range(3):
                by_loads += (lab[k] - weight[j, k]) * V[k] + material[3 + k] * w[k]
                lost += loads.damping * (chain.mass[j] * V[k] ** 2 + chain.dry_inertia[j, k] * w[k] ** 2)
        if loads.follows or loads.turns:
            by_loads += _given_by_turned_loads(driven, stages, i)
        if loads.wet:
            from_current, to_fluid = _given_by_fluid(loads, stages, i)
            by_loads += from_current
            lost += to_fluid
        out[i, 0], out[i, 1], out[i, 2] = work, chain.h * by_loads, chain.h * lost


@kernel
def _given_by_turned_loads(driven: Driven, stages: Stages, i: int) -> float:
    """Power over h of the forces given in the material frame, and of the moments given in the lab's."""
    given = 0.0
    for j in range(len(driven.lab[i])):
        R, V, w = stages.R[i, j + 1], stages.V[i, j], stages.omega[i, j + 1]
        lab, material = driven.lab[i, j], driven.material[i, j]
        for k in range(3):
            for m in range(3):
                given += R[k, m] * (material[m] * V[k] + lab[3 + k] * w[m])
    return given


@kernel
def _given_by_fluid(loads: Loads, stages: Stages, i: int) -> tuple[float, float]:
    """Power over h that the current gives, and that the fluid takes."""
    T, T_t = scratch(3), scratch(3)
    given, lost = 0.0, 0.0
    for j in range(len(stages.V[i])):
        R, w = stages.R[i, j + 1], stages.omega[i, j + 1]
        for k in range(3):
            T[k] = R[k, 2]
            T_t[k] = R[k, 0] * w[1] - R[k, 1] * w[0]
        from_current, to_fluid = fluid_power(
            loads.added_mass[j], loads.drag_normal[j], loads.drag_tangential[j], stages.V[i, j], loads.current,
            stages.A[i, j], T, T_t,
        )  # fmt: skip
        given += from_current
        lost += to_fluid
    return given, lost


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
