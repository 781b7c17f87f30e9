"""Energies of the rod.

The box scheme's own quadrature: mean values over each interval, so that without loads and dissipation the sum of
bending, torsion and kinetic energy is conserved by the discretization in space.
"""

from __future__ import annotations

from solver.arrays import Array
from solver.kernels.kernel import kernel
from solver.measures.energies import Energies
from solver.methods.space.box.fields import KAPPA, OMEGA, State, V
from solver.physics.loads.applied import Loads
from solver.physics.section import Section


def energies(state: State, section: Section, loads: Loads, weight: Array, tangent: Array, h: float) -> Energies:
    """The energies at a state; `weight` (n, 3) in N/m is what the potential comes from, `tangent` (n, 3)."""
    return Energies(*_integrate(state, section, loads, weight, tangent, h))


@kernel
def _integrate(state: State, section: Section, loads: Loads, weight: Array, tangent: Array,
               h: float) -> tuple[float, float, float, float, float]:  # fmt: skip
    """The energies in their order: each interval's mean density, of mean strains and velocities."""
    Y, kappa0, T = state.Y, section.kappa0, tangent
    bending, torsion, kinetic, added, potential = 0.0, 0.0, 0.0, 0.0, 0.0
    for j in range(len(Y) - 1):
        mass, added_mass = section.mass[j] + section.mass[j + 1], loads.added_mass[j] + loads.added_mass[j + 1]
        along, along_next = 0.0, 0.0
        for i in range(3):
            along += T[j, i] * (Y[j, V + i] - loads.current[i])
            along_next += T[j + 1, i] * (Y[j + 1, V + i] - loads.current[i])
        for i in range(3):
            stiffness = section.stiffness[j, i] + section.stiffness[j + 1, i]
            strain = Y[j, KAPPA + i] - kappa0[j, i] + Y[j + 1, KAPPA + i] - kappa0[j + 1, i]
            if i < 2:
                bending += stiffness * strain * strain
            else:
                torsion += stiffness * strain * strain
            velocity, omega = Y[j, V + i] + Y[j + 1, V + i], Y[j, OMEGA + i] + Y[j + 1, OMEGA + i]
            kinetic += mass * velocity * velocity
            kinetic += (section.inertia[j, i] + section.inertia[j + 1, i]) * omega * omega
            across = velocity - 2.0 * loads.current[i] - along * T[j, i] - along_next * T[j + 1, i]
            added += added_mass * across * across
            potential -= (weight[j, i] + weight[j + 1, i]) * (state.r[j, i] + state.r[j + 1, i])
    part = 0.0625 * h  # 1/2, and three means of two
    return part * bending, part * torsion, part * kinetic, part * added, 0.25 * h * potential
