"""Energies of the rod.

The box scheme's own quadrature: mean values over each interval, so that without loads and dissipation the sum of
bending, torsion and kinetic energy is conserved by the discretization in space.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from solver.arrays import Array
from solver.kernels.dispatch import for_each
from solver.kernels.handed import Reference
from solver.kernels.kernel import inner, kernel
from solver.kernels.rotation import matrices_of
from solver.kernels.vectors import middle
from solver.measures.energies import Energies
from solver.methods.space.box.fields import KAPPA, OMEGA, State, V
from solver.methods.space.box.nodes import Motion
from solver.physics.elasticity import strain_energy
from solver.physics.loads.load import energy, entrained, entrained_energy, has_energy, mean_entrained, point, prepare
from solver.physics.loads.registry import Loads


def energies(reference: Reference, state: State, h: float, R: Array) -> Energies:
    """The energies at a state, whose rotations are written into R (n, 3, 3)."""
    return _integrate(reference, state, h, R, np.zeros(2))


@kernel
def _integrate(reference: Reference, state: State, h: float, R: Array, by_loads: Array) -> Energies:
    """Bending, torsion and motion: each interval's mean density, of mean strains and velocities."""
    section, loads = reference.section, reference.loads
    matrices_of(state.quaternion, R)
    add_energies(loads, Motion(state.r, state.Y, state.aux, R, 0.0), h, by_loads)
    Y, elastic = state.Y, section.elastic
    bending, torsion, kinetic = 0.0, 0.0, 0.0
    for j in range(len(Y) - 1):
        mass = section.mass[j] + section.mass[j + 1]
        strain = middle(_strain(Y, elastic.kappa0, j), _strain(Y, elastic.kappa0, j + 1))
        for node in range(j, j + 2):
            bent, twisted = strain_energy(elastic, node, strain)
            bending += bent
            torsion += twisted
        for i in range(3):
            velocity, omega = Y[j, V + i] + Y[j + 1, V + i], Y[j, OMEGA + i] + Y[j + 1, OMEGA + i]
            kinetic += mass * velocity * velocity
            kinetic += (section.inertia[j, i] + section.inertia[j + 1, i]) * omega * omega
    kinetic *= 0.0625 * h  # 1/2, and three means of two
    return Energies(0.5 * h * bending, 0.5 * h * torsion, 0.0, kinetic, by_loads[1], by_loads[0])


@inner
def _strain(Y: Array, kappa0: Array, j: int) -> Any:
    """kappa - kappa0 at node j."""
    return (Y[j, KAPPA] - kappa0[j, 0], Y[j, KAPPA + 1] - kappa0[j, 1], Y[j, KAPPA + 2] - kappa0[j, 2])


@inner
def _add_energies(load: Any, motion: Motion, h: float, out: Array) -> None:
    """Means of the nodes' potential energies; entrained mass moves with the mean of the nodes' velocities."""
    prepare(load, 0, motion, False)
    at = point(motion, 0)
    stored, moving = energy(load, 0, 0, at), entrained(load, 0, at)
    for j in range(1, len(motion.r)):
        at = point(motion, j)
        behind, following = energy(load, 0, j, at), entrained(load, j, at)
        out[0] += 0.5 * h * (stored + behind)
        out[1] += h * entrained_energy(mean_entrained(moving, following))
        stored, moving = behind, following


def add_energies(loads: Loads, motion: Motion, h: float, out: Array) -> None:
    """Add the energies of every load that is present."""


for_each(add_energies, _add_energies, has_energy)
