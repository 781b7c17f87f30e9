"""Energies of the chain that turns about one axis, and what flows in and out within a step."""

from __future__ import annotations

from solver.arrays import Array
from solver.kernels.handed import Reference
from solver.kernels.kernel import kernel
from solver.kernels.scratch import scratch
from solver.measures.energies import Energies
from solver.methods.space.one_axis.balances import Motion, along, end_velocity, motion_at
from solver.methods.space.segments.chain import STAGES
from solver.physics.elasticity import is_viscous, strain_energy
from solver.physics.ends import LOAD, RATE
from solver.physics.loads.load import add_energies, add_powers


@kernel
def energies(reference: Reference, phi: Array, motion: Motion) -> Energies:
    """The energies at the end of a step: angles (N + 2,), and the segments' motion."""
    chain, loads = reference.chain, reference.loads
    elastic, kinetic, turning, by_loads, h = 0.0, 0.0, 0.0, scratch(2), chain.h
    by_loads[0], by_loads[1] = 0.0, 0.0
    add_energies(loads, STAGES - 1, motion, by_loads)
    for j in range(len(chain.span)):
        strain = (phi[j + 1] - phi[j]) / chain.span[j] - chain.elastic.kappa0[j]
        elastic += chain.span[j] * strain_energy(chain.elastic, j, strain)
    for j in range(len(motion.V)):
        V, spin = motion.V[j], motion.omega[j + 1] * motion.omega[j + 1]
        kinetic += chain.mass[j] * along(V, V) + chain.dry_inertia[j] * spin
        turning += (chain.inertia[j] - chain.dry_inertia[j]) * spin
    moving = 0.5 * h * kinetic, 0.5 * h * turning + h * by_loads[1]
    return Energies(elastic * chain.swing, elastic * (1.0 - chain.swing), 0.0, moving[0], moving[1], h * by_loads[0])


@kernel
def stage_powers(reference: Reference, weights: Array, moved: Array, out: Array) -> None:
    """Write the power (W) of the ends, of loads, and dissipated, at the stages, into `out`.

    And into `moved` (2, 3) by how much start and end have moved, z of the frame of their conditions on translation, and
    turned (rad), by the `weights` (3,) of the stages.
    """
    chain, loads, driven, stages = reference.chain, reference.loads, reference.driven, reference.stages
    N, by_loads = len(chain.mass), scratch(2)
    moved[:] = 0.0
    for i in range(STAGES):
        by_loads[0], by_loads[1] = 0.0, 0.0
        work, sign = 0.0, -1.0
        for side, frame, node in ((0, 0, 0), (1, N + 1, N)):
            V, omega = end_velocity(chain, stages, i, side), stages.omega[i, frame]
            work += sign * (along(stages.F[i, node], V) + stages.q[i, node] * omega)
            if driven.kinds[side, 0] in (RATE, LOAD):
                V *= stages.T[i, frame].conjugate()
            moved[side, 0] += weights[i] * V.real
            moved[side, 1] += weights[i] * V.imag
            moved[side, 2] += weights[i] * omega
            sign = 1.0
        add_powers(loads, i, motion_at(chain, stages, i), by_loads)
        out[i, 0], out[i, 1], out[i, 2] = work, chain.h * by_loads[0], chain.h * by_loads[1]
        if is_viscous(chain.elastic):
            for j in range(N + 1):
                rate = stages.omega[i, j + 1] - stages.omega[i, j]
                out[i, 2] += chain.elastic.viscosity[j] * rate * rate / chain.span[j]
