"""Energies of the rod and the power that goes in and out.

The box scheme's own quadrature: mean values over each interval, so that without loads and dissipation the sum of
bending, torsion and kinetic energy is conserved by the discretization in space.
"""

from __future__ import annotations

import numpy as np

from solver.kernel import kernel
from solver.loads.applied import Loads
from solver.loads.fluid import fluid_power
from solver.measures.energies import Energies
from solver.methods.box.fields import KAPPA, OMEGA, F, Nodes, State, V
from solver.rod import Array, Section


def energies(state: State, section: Section, loads: Loads, weight: Array, tangent: Array, h: float) -> Energies:
    """The energies at a state; `weight` (n, 3) in N/m is what the potential comes from, `tangent` (n, 3)."""
    strain = state.Y[:, KAPPA : KAPPA + 3] - section.kappa0
    elastic = 0.5 * _mean_square(section.stiffness, strain, h)
    V_lab = state.Y[:, V : V + 3]
    across = V_lab - loads.current
    across = across - np.sum(across * tangent, axis=1)[:, None] * tangent
    kinetic = _mean_square(np.outer(section.mass, np.ones(3)), V_lab, h)
    kinetic = kinetic + _mean_square(section.inertia, state.Y[:, OMEGA : OMEGA + 3], h)
    added = _mean_square(np.outer(loads.added_mass, np.ones(3)), across, h)
    potential = -np.sum(weight * state.r, axis=1)
    return Energies(
        bending=float(elastic[0] + elastic[1]),
        torsion=float(elastic[2]),
        kinetic=float(0.5 * kinetic.sum()),
        added_mass=float(0.5 * added.sum()),
        potential=float(h * (potential.sum() - 0.5 * (potential[0] + potential[-1]))),
    )


def _mean_square(weight: Array, field: Array, h: float) -> Array:
    """int weight field^2 ds by components, from the means over the intervals."""
    mean = 0.5 * (field[1:] + field[:-1])
    return np.asarray(h * np.sum(0.5 * (weight[1:] + weight[:-1]) * mean**2, axis=0), dtype=float)


@kernel
def powers(state: State, nodes: Nodes, section: Section, loads: Loads, weight: Array, h: float, out: Array) -> None:
    """Write the power (W) of the ends, of the loads other than `weight`, and dissipated, into `out` (3,)."""
    last = len(state.Y) - 1
    out[:] = 0.0
    T_t = np.zeros(3)
    for i in range(3):
        for node, sign in ((0, -1.0), (last, 1.0)):
            out[0] += sign * state.Y[node, F + i] * state.Y[node, V + i]
            out[0] += sign * nodes.q[node, i] * state.Y[node, OMEGA + i]
    for j in range(last + 1):
        length = 0.5 * h if j == 0 or j == last else h
        lost, given = 0.0, 0.0
        for i in range(3):
            velocity, omega = state.Y[j, V + i], state.Y[j, OMEGA + i]
            given += (loads.lab[j, i] - weight[j, i]) * velocity + loads.material[j, 3 + i] * omega
            lost += loads.damping * (section.mass[j] * velocity**2 + section.inertia[j, i] * omega**2)
            for k in range(3):
                turning = loads.lab[j, 3 + i] * state.Y[j, OMEGA + k]
                given += nodes.R[j, i, k] * (loads.material[j, k] * velocity + turning)
        if loads.wet:
            for i in range(3):
                T_t[i] = nodes.R[j, i, 0] * state.Y[j, OMEGA + 1] - nodes.R[j, i, 1] * state.Y[j, OMEGA]
            from_current, to_fluid = fluid_power(
                loads.added_mass[j], loads.drag_normal[j], loads.drag_tangential[j], state.Y[j, V : V + 3],
                loads.current, state.rate[j, :3], nodes.T[j], T_t,
            )  # fmt: skip
            given += from_current
            lost += to_fluid
        out[1] += length * given
        out[2] += length * lost
