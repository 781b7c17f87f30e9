"""The energy that flows in and out of the rod within a step.

Given loads, the ends and viscous damping by what the rod has moved in the step, so that the work of a load that stays
is exact. By their mean power it is not: where a step is far longer than a wave takes, rates ring; displacements do not.
What is lost otherwise, and contact, by their mean power.
Over each interval the mean load acts on the mean motion, as in the scheme's own balance: the sum over the intervals of
(2) . q_m, (3) . F_m, (4) . V_m and (5) . omega_m. So h leaves no error of its own where the section is uniform.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from solver.arrays import Array
from solver.kernels.copying import copy
from solver.kernels.dispatch import for_each
from solver.kernels.handed import Reference
from solver.kernels.kernel import inner, kernel
from solver.kernels.vectors import add_vector, middle, plus, times, without
from solver.methods.space.box.fields import KAPPA, OMEGA, F, State
from solver.methods.space.box.nodes import Motion
from solver.physics.elasticity import moment
from solver.physics.loads.load import (
    GIVEN,
    LOST,
    STORED,
    VISCOUS,
    Point,
    account,
    carried_power,
    carrier,
    conservative,
    entrained,
    entrained_power,
    force,
    has_power,
    mean_entrained,
    point,
    prepare,
    total_power,
)
from solver.physics.loads.registry import Loads
from solver.physics.section import Section


class Flows(NamedTuple):
    """What flowed in the last step, and what acts at its end and at its begin.

    `energy` (4,) in J: from the ends, from loads other than weight, dissipated, into contact. (2, ...), now and before:
    `given` (n, 6), force (lab) and moment (material) per length of given loads; `power` (3,) in W: from what carries
    loads (a current), lost, into contact. `moved` (n, 6): displacement (lab) and rotation (material) in the step;
    `rubbed` (1,) in J: taken by viscous loads.
    """

    energy: Array
    given: Array
    power: Array
    moved: Array
    rubbed: Array

    @classmethod
    def empty(cls, n: int) -> Flows:
        """Zeros for n nodes."""
        return cls(np.zeros(4), np.zeros((2, n, 6)), np.zeros((2, 3)), np.zeros((n, 6)), np.zeros(1))


@kernel
def enter_step(reference: Reference, old: State, new: State, contact: Array, c0: float, dt: float, late: float,
               h: float, flows: Flows) -> None:  # fmt: skip
    """Write what flowed in the step of dt from `old` to `new` into `flows`.

    `contact` (2,): power stored and taken by it; c0: see `history`; `late`: the part in the means over the step of what
    acts at its end.
    """
    section, loads, work = reference.section, reference.loads, reference.work
    past, early, power = work.past, 1.0 - late, flows.power
    copy(flows.given[0], flows.given[1])
    flows.given[0, :] = 0.0
    copy(power[0], power[1])
    power[0, 0], power[0, 1], power[0, 2] = 0.0, contact[1], contact[0]
    for j in range(len(past)):
        for i in range(3):
            flows.moved[j, i] = new.r[j, i] - old.r[j, i]
            flows.moved[j, 3 + i] = past[j, 3 + i] + new.Y[j, OMEGA + i] / c0
    flows.rubbed[0] = 0.0
    add_flows(loads, Motion(new.r, new.Y, past, work.nodes.R, c0), dt, h, flows)
    for i in range(3):
        flows.energy[1 + i] = dt * (late * power[0, i] + early * power[1, i])
    flows.energy[0] = _work_of_ends(old.Y, new.Y, section, flows.moved, late)
    flows.energy[1] += _work_of_loads(flows, late, h)
    flows.energy[2] += flows.rubbed[0]


@inner
def _work_of_ends(old: Array, new: Array, section: Section, moved: Array, late: float) -> float:
    """From Y (n, 12) at both ends of the step."""
    early, work = 1.0 - late, 0.0
    for node, sign in ((0, -1.0), (len(new) - 1, 1.0)):
        kappa = plus(times(late, (new[node, KAPPA], new[node, KAPPA + 1], new[node, KAPPA + 2])),
                     times(early, (old[node, KAPPA], old[node, KAPPA + 1], old[node, KAPPA + 2])))  # fmt: skip
        q = moment(section.elastic, node, kappa)
        for i in range(3):
            pull = late * new[node, F + i] + early * old[node, F + i]
            work += sign * (pull * moved[node, i] + q[i] * moved[node, 3 + i])
    return work


@inner
def _work_of_loads(flows: Flows, late: float, h: float) -> float:
    early, given, moved, work = 1.0 - late, flows.given, flows.moved, 0.0
    for j in range(len(moved) - 1):
        for i in range(6):
            load = late * (given[0, j, i] + given[0, j + 1, i]) + early * (given[1, j, i] + given[1, j + 1, i])
            work += load * (moved[j, i] + moved[j + 1, i])
    return 0.25 * h * work


@inner
def _add_flows(load: Any, motion: Motion, dt: float, h: float, flows: Flows) -> None:
    """Enter a load, by its account."""
    what = account(load)
    if what == STORED:
        return
    prepare(load, 0, motion, False)
    if what == GIVEN:
        for j in range(len(motion.r)):
            at = point(motion, j)
            lab, material = force(load, 0, j, at)
            add_vector(1.0, lab, flows.given[0, j, :3])
            add_vector(1.0, material, flows.given[0, j, 3:])
    elif what == LOST:
        _add_power(load, motion, h, flows.power[0])
    elif what == VISCOUS:
        flows.rubbed[0] += _rubbed(load, motion, dt, h, flows.moved)


@inner
def _add_power(load: Any, motion: Motion, h: float, power: Array) -> None:
    """Add what the load's carrier gives, and what the load takes for good, W: mean forces times mean velocities."""
    f, m, V, omega, carried, taken = _at_node(load, motion, 0)
    for j in range(1, len(motion.r)):
        f_next, m_next, V_next, omega_next, carried_next, taken_next = _at_node(load, motion, j)
        mean = middle(f, f_next)
        through = carried_power(mean, middle(carried, carried_next))
        done = total_power(mean, middle(m, m_next), middle(V, V_next), middle(omega, omega_next))
        power[0] += h * through
        power[1] += h * (through - done - entrained_power(mean_entrained(taken, taken_next)))
        f, m, V, omega, carried, taken = f_next, m_next, V_next, omega_next, carried_next, taken_next


@inner
def _at_node(load: Any, motion: Motion, j: int) -> Any:
    """The load's force but for its conservative part, its moment, velocity and angular velocity, and those of what
    carries the load, and the mass that it entrains, at node j."""
    at = point(motion, j)
    lab, material = force(load, 0, j, at)
    across, carried = without(lab, conservative(load, 0, j, at)), carrier(load, 0, j, at)
    return across, material, at.V, at.omega, carried, entrained(load, j, at)


@inner
def _rubbed(load: Any, motion: Motion, dt: float, h: float, moved: Array) -> float:
    """What a load that is proportional to the velocity has taken in the step, by what the nodes have moved (J)."""
    total = 0.0
    f, m, d, turned = _rub(load, motion, dt, moved, 0)
    for j in range(1, len(moved)):
        f_next, m_next, d_next, turned_next = _rub(load, motion, dt, moved, j)
        total -= total_power(middle(f, f_next), middle(m, m_next), middle(d, d_next), middle(turned, turned_next))
        f, m, d, turned = f_next, m_next, d_next, turned_next
    return h * total


@inner
def _rub(load: Any, motion: Motion, dt: float, moved: Array, j: int) -> Any:
    """Force and moment at the mean velocity of the step, and what node j has moved."""
    at, d, turned = point(motion, j), (moved[j, 0], moved[j, 1], moved[j, 2]), (moved[j, 3], moved[j, 4], moved[j, 5])
    lab, material = force(load, 0, j, Point(at.r, times(1.0 / dt, d), at.A, at.T, at.R, times(1.0 / dt, turned)))
    return lab, material, d, turned


def add_flows(loads: Loads, motion: Motion, dt: float, h: float, flows: Flows) -> None:
    """Enter every load that is present."""


for_each(add_flows, _add_flows, has_power)
