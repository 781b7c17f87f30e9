"""Energies of the rod and the power that goes in and out.

The box scheme's own quadrature: mean values over each interval, so that without loads and dissipation the sum of
bending, torsion and kinetic energy is conserved by the discretization in space.
"""

from __future__ import annotations

import numpy as np

from solver.kernel import kernel
from solver.loads.applied import Loads
from solver.measures.energies import Energies
from solver.methods.box.fields import KAPPA, OMEGA, F, Nodes, State, V
from solver.rod import Array, Section


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


@kernel
def powers(state: State, nodes: Nodes, section: Section, loads: Loads, weight: Array, h: float, out: Array) -> None:
    """Write the power (W) of the ends, of the loads other than `weight`, and dissipated, into `out` (3,).

    Over each interval the mean load acts on the mean motion, as in the scheme's own balance: the sum over the intervals
    of (2) . q_m, (3) . F_m, (4) . V_m and (5) . omega_m. So h leaves no error of its own where the section is uniform.
    """
    last = len(state.Y) - 1
    out[:] = 0.0
    for i in range(3):
        for node, sign in ((0, -1.0), (last, 1.0)):
            out[0] += sign * state.Y[node, F + i] * state.Y[node, V + i]
            out[0] += sign * nodes.q[node, i] * state.Y[node, OMEGA + i]
    left, right = np.zeros((QUANTITIES, 3)), np.zeros((QUANTITIES, 3))
    _load_node(0, state, nodes, section, loads, weight, right)
    for j in range(last):
        left, right = right, left
        _load_node(j + 1, state, nodes, section, loads, weight, right)
        added_mass = 0.5 * (loads.added_mass[j] + loads.added_mass[j + 1])
        for i in range(3):
            velocity, omega = 0.5 * (left[0, i] + right[0, i]), 0.5 * (left[1, i] + right[1, i])
            fluid = 0.5 * (left[6, i] + right[6, i])
            given = 0.5 * (left[2, i] + right[2, i]) * velocity + 0.5 * (left[3, i] + right[3, i]) * omega
            lost = 0.5 * (left[4, i] + right[4, i]) * velocity + 0.5 * (left[5, i] + right[5, i]) * omega
            # what the fluid takes, less what goes into the kinetic energy of the added mass
            lost -= fluid * (velocity - loads.current[i])
            lost -= added_mass * 0.25 * (left[7, i] + right[7, i]) * (left[8, i] + right[8, i])
            out[1] += h * (given + fluid * loads.current[i])
            out[2] += h * lost


QUANTITIES = 9
"""At a node: V (lab), omega (material), given force (lab) and moment (material), damping force and moment, the fluid's
force, u_n and its rate (lab)."""


@kernel
def _load_node(j: int, state: State, nodes: Nodes, section: Section, loads: Loads, weight: Array, at: Array) -> None:
    """Write what moves and what acts at node j into `at` (QUANTITIES, 3)."""
    R = nodes.R[j]
    for i in range(3):
        velocity, omega = state.Y[j, V + i], state.Y[j, OMEGA + i]
        at[0, i], at[1, i] = velocity, omega
        at[2, i] = loads.lab[j, i] - weight[j, i]
        at[3, i] = loads.material[j, 3 + i]
        if loads.follows:
            at[2, i] += R[i, 0] * loads.material[j, 0] + R[i, 1] * loads.material[j, 1] + R[i, 2] * loads.material[j, 2]
        if loads.turns:
            at[3, i] += R[0, i] * loads.lab[j, 3] + R[1, i] * loads.lab[j, 4] + R[2, i] * loads.lab[j, 5]
        at[4, i] = loads.damping * section.mass[j] * velocity
        at[5, i] = loads.damping * section.inertia[j, i] * omega
    if loads.wet:
        _load_by_fluid(j, state, nodes, loads, at)


@kernel
def _load_by_fluid(j: int, state: State, nodes: Nodes, loads: Loads, at: Array) -> None:
    """Write the fluid's force, u_n and its rate at node j into the last rows of `at`."""
    R, T = nodes.R[j], nodes.T[j]
    acceleration, u = state.rate[j], at[7]
    along, swing, turn = 0.0, 0.0, 0.0
    for i in range(3):
        u[i] = at[0, i] - loads.current[i]
        along += u[i] * T[i]
        swing += acceleration[i] * T[i]
        T_t = R[i, 0] * at[1, 1] - R[i, 1] * at[1, 0]
        turn += u[i] * T_t
    for i in range(3):
        u[i] -= along * T[i]
    speed = np.sqrt(u[0] * u[0] + u[1] * u[1] + u[2] * u[2])
    for i in range(3):
        T_t = R[i, 0] * at[1, 1] - R[i, 1] * at[1, 0]
        across = acceleration[i] - swing * T[i]
        at[6, i] = -loads.added_mass[j] * across - loads.drag_normal[j] * speed * u[i]
        at[6, i] -= loads.drag_tangential[j] * abs(along) * along * T[i]
        at[8, i] = across - turn * T[i] - along * T_t
