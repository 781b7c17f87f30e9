"""The energy that flows in and out of the rod within a step.

Given loads, the ends and damping by what the rod has moved in the step, so that the work of a load that stays is exact.
By their mean power it is not: where a step is far longer than a wave takes, rates ring; displacements do not. Fluid and
contact by their mean power.
Over each interval the mean load acts on the mean motion, as in the scheme's own balance: the sum over the intervals of
(2) . q_m, (3) . F_m, (4) . V_m and (5) . omega_m. So h leaves no error of its own where the section is uniform.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from solver.arrays import Array
from solver.kernels.handed import Reference
from solver.kernels.kernel import kernel
from solver.kernels.scratch import scratch
from solver.methods.space.box.fields import KAPPA, OMEGA, F, Nodes, State, V
from solver.physics.loads.applied import Loads
from solver.physics.section import Section


class Flows(NamedTuple):
    """What flowed in the last step, and what acts at its end and at its begin.

    `energy` (4,) in J: from the ends, from loads other than weight, dissipated, into contact. (2, ...), now and before:
    `given` (n, 6), force (lab) and moment (material) per length but for weight; `power` (3,) in W: from the current, to
    fluid and friction, into contact. `moved` (n, 6): displacement (lab) and rotation (material) in the step.
    """

    energy: Array
    given: Array
    power: Array
    moved: Array

    @classmethod
    def empty(cls, n: int) -> Flows:
        """Zeros for n nodes."""
        return cls(np.zeros(4), np.zeros((2, n, 6)), np.zeros((2, 3)), np.zeros((n, 6)))


@kernel
def enter_step(given: Reference, old: State, new: State, weight: Array, contact: Array, c0: float, dt: float,
               late: float, h: float, flows: Flows) -> None:  # fmt: skip
    """Write what flowed in the step of dt from `old` to `new` into `flows`.

    `given`: see `newton.step`; `contact` (2,): power stored and taken by it; c0: see `history`; `late`: the part in the
    means over the step of what acts at its end.
    """
    section, loads, _, _, work = given.records
    nodes, past = work.nodes, work.past
    early, power = 1.0 - late, flows.power
    flows.given[1, :] = flows.given[0]
    power[1, :] = power[0]
    _given_loads(nodes, loads, weight, flows.given[0])
    power[0, 0], power[0, 1] = _fluid_power(new, nodes, loads, h) if loads.wet else (0.0, 0.0)
    power[0, 1] += contact[1]
    power[0, 2] = contact[0]
    for i in range(3):
        flows.energy[1 + i] = dt * (late * power[0, i] + early * power[1, i])
    for j in range(len(past)):
        for i in range(3):
            flows.moved[j, i] = new.r[j, i] - old.r[j, i]
            flows.moved[j, 3 + i] = past[j, 3 + i] + new.Y[j, OMEGA + i] / c0
    flows.energy[0] = _work_of_ends(old.Y, new.Y, section, flows.moved, late)
    flows.energy[1] += _work_of_loads(flows, late, h)
    if loads.damping > 0.0:
        flows.energy[2] += loads.damping / dt * _damped(section, flows.moved, h)


@kernel
def _given_loads(nodes: Nodes, loads: Loads, weight: Array, given: Array) -> None:
    for j in range(len(given)):
        for i in range(3):
            given[j, i] = loads.lab[j, i] - weight[j, i]
            given[j, 3 + i] = loads.material[j, 3 + i]
    if loads.follows or loads.turns:
        for j in range(len(given)):
            R, force, moment = nodes.R[j], loads.material[j], loads.lab[j]
            for i in range(3):
                given[j, i] += R[i, 0] * force[0] + R[i, 1] * force[1] + R[i, 2] * force[2]
                given[j, 3 + i] += R[0, i] * moment[3] + R[1, i] * moment[4] + R[2, i] * moment[5]


@kernel
def _work_of_ends(old: Array, new: Array, section: Section, moved: Array, late: float) -> float:
    """From Y (n, 12) at both ends of the step."""
    early, work = 1.0 - late, 0.0
    for node, sign in ((0, -1.0), (len(new) - 1, 1.0)):
        for i in range(3):
            force = late * new[node, F + i] + early * old[node, F + i]
            strain = late * new[node, KAPPA + i] + early * old[node, KAPPA + i] - section.kappa0[node, i]
            work += sign * (force * moved[node, i] + section.stiffness[node, i] * strain * moved[node, 3 + i])
    return work


@kernel
def _work_of_loads(flows: Flows, late: float, h: float) -> float:
    early, given, moved, work = 1.0 - late, flows.given, flows.moved, 0.0
    for j in range(len(moved) - 1):
        for i in range(6):
            load = late * (given[0, j, i] + given[0, j + 1, i]) + early * (given[1, j, i] + given[1, j + 1, i])
            work += load * (moved[j, i] + moved[j + 1, i])
    return 0.25 * h * work


@kernel
def _damped(section: Section, moved: Array, h: float) -> float:
    """The integral over s of rho_c A |displacement|^2 + rotation . I rotation."""
    total = 0.0
    for j in range(len(moved) - 1):
        for i in range(3):
            momentum = section.mass[j] * moved[j, i] + section.mass[j + 1] * moved[j + 1, i]
            spin = section.inertia[j, i] * moved[j, 3 + i] + section.inertia[j + 1, i] * moved[j + 1, 3 + i]
            total += momentum * (moved[j, i] + moved[j + 1, i]) + spin * (moved[j, 3 + i] + moved[j + 1, 3 + i])
    return 0.25 * h * total


VELOCITY, FORCE, U_N, U_N_RATE = 0, 1, 2, 3
"""At a node: V, the fluid's force, u_n and its rate (lab)."""


@kernel
def _fluid_power(state: State, nodes: Nodes, loads: Loads, h: float) -> tuple[float, float]:
    """What the current gives, and what the fluid takes less what goes into the kinetic energy of the added mass, W."""
    left, right = scratch((4, 3)), scratch((4, 3))
    from_current, to_fluid = 0.0, 0.0
    _load_by_fluid(0, state, nodes, loads, right)
    for j in range(len(state.Y) - 1):
        left, right = right, left
        _load_by_fluid(j + 1, state, nodes, loads, right)
        added_mass = 0.5 * (loads.added_mass[j] + loads.added_mass[j + 1])
        for i in range(3):
            velocity, fluid = 0.5 * (left[VELOCITY, i] + right[VELOCITY, i]), 0.5 * (left[FORCE, i] + right[FORCE, i])
            from_current += fluid * loads.current[i]
            to_fluid -= fluid * (velocity - loads.current[i])
            to_fluid -= added_mass * 0.25 * (left[U_N, i] + right[U_N, i]) * (left[U_N_RATE, i] + right[U_N_RATE, i])
    return h * from_current, h * to_fluid


@kernel
def _load_by_fluid(j: int, state: State, nodes: Nodes, loads: Loads, at: Array) -> None:
    """Write what the fluid does at node j into `at` (4, 3)."""
    R, T, w0, w1 = nodes.R[j], nodes.T[j], state.Y[j, OMEGA], state.Y[j, OMEGA + 1]
    acceleration, u = state.rate[j], at[U_N]
    along, swing, turn = 0.0, 0.0, 0.0
    for i in range(3):
        at[VELOCITY, i] = state.Y[j, V + i]
        u[i] = state.Y[j, V + i] - loads.current[i]
        along += u[i] * T[i]
        swing += acceleration[i] * T[i]
        turn += u[i] * (R[i, 0] * w1 - R[i, 1] * w0)
    for i in range(3):
        u[i] -= along * T[i]
    speed = np.sqrt(u[0] * u[0] + u[1] * u[1] + u[2] * u[2])
    for i in range(3):
        across = acceleration[i] - swing * T[i]
        at[FORCE, i] = -loads.added_mass[j] * across - loads.drag_normal[j] * speed * u[i]
        at[FORCE, i] -= loads.drag_tangential[j] * abs(along) * along * T[i]
        at[U_N_RATE, i] = across - turn * T[i] - along * (R[i, 0] * w1 - R[i, 1] * w0)
