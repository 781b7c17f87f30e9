"""Energies of the chain that turns about one axis, and what flows in and out within a step."""

from __future__ import annotations

import numpy as np

from solver.arrays import Array
from solver.kernels.handed import Reference
from solver.kernels.kernel import kernel
from solver.kernels.scratch import scratch
from solver.measures.energies import Energies
from solver.methods.space.one_axis.balances import Motion, along, end_velocity, motion_at
from solver.methods.space.one_axis.chain import Chain
from solver.methods.space.segments.chain import STAGES
from solver.physics.elasticity import is_viscous, strain_energy, viscosity
from solver.physics.loads.load import add_energies, add_powers


def energies(reference: Reference, chain: Chain, phi: Array, motion: Motion) -> Energies:
    """The energies at the end of a step: angles (N + 2,), and the segments' motion; `reference`: see `newton.step`."""
    by_loads, V, omega = np.zeros(2), motion.V, motion.omega[1:-1]
    elastic = _sum(reference, phi, motion, by_loads)
    kinetic = np.sum(chain.mass * (V.real**2 + V.imag**2)) + np.sum(chain.dry_inertia * omega**2)
    turning = np.sum((chain.inertia - chain.dry_inertia) * omega**2)
    return Energies(
        bending=elastic * chain.swing,
        torsion=elastic * (1.0 - chain.swing),
        stretching=0.0,
        kinetic=float(0.5 * chain.h * kinetic),
        added_mass=chain.h * float(0.5 * turning + by_loads[1]),
        potential=chain.h * float(by_loads[0]),
    )


@kernel
def _sum(reference: Reference, phi: Array, motion: Motion, out: Array) -> float:
    """Write the energies of loads, and return that of the joints."""
    chain, loads, _, _, _, _, _ = reference.records
    add_energies(loads, STAGES - 1, motion, out)
    elastic, energy = chain.elastic, 0.0
    for j in range(len(chain.span)):
        strain = (phi[j + 1] - phi[j]) / chain.span[j] - elastic.kappa0[j]
        energy += chain.span[j] * strain_energy(elastic, j, strain)
    return energy


@kernel
def stage_powers(reference: Reference, out: Array) -> None:
    """Write the power (W) of the ends, of loads, and dissipated, at the stages, into `out`.

    `reference`: see `newton.step`.
    """
    chain, loads, _, _, stages, _, _ = reference.records
    N, by_loads = len(chain.mass), scratch(2)
    for i in range(STAGES):
        by_loads[0], by_loads[1] = 0.0, 0.0
        work = along(stages.F[i, N], end_velocity(chain, stages, i, 1)) + stages.q[i, N] * stages.omega[i, N + 1]
        work -= along(stages.F[i, 0], end_velocity(chain, stages, i, 0)) + stages.q[i, 0] * stages.omega[i, 0]
        add_powers(loads, i, motion_at(chain, stages, i), by_loads)
        out[i, 0], out[i, 1], out[i, 2] = work, chain.h * by_loads[0], chain.h * by_loads[1]
        if is_viscous(chain.elastic):
            for j in range(N + 1):
                rate = stages.omega[i, j + 1] - stages.omega[i, j]
                out[i, 2] += viscosity(chain.elastic, j) * rate * rate / chain.span[j]
