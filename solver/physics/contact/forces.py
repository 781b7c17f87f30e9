"""The forces of contact on the nodes, and how they change with the nodes' motion."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from solver.arrays import Array
from solver.kernels.kernel import inner, kernel
from solver.physics.contact.law import Law, pair_force, sees
from solver.physics.contact.members import Members, dismiss, take_in
from solver.physics.contact.points import REACH, Points, between_nodes, place_point
from solver.physics.contact.search import Pairs

LARGEST_APPROACH = 0.6
"""Part of a pair's distance that one Newton update may use."""
LARGEST_CLOSING = 0.8
"""Part of the gap of a pressing pair that one Newton update may close: the force has a pole where it ends."""
LARGEST_FORESEEN = 0.5
"""Part of the gap of a pair that the first guess of a step may close."""


class Pressing(NamedTuple):
    """The pairs that press on each other at the current iterate, at each stage of a step.

    `many` (stages,): their numbers; `first`, `second` (stages, capacity) their points; `n`, `g`, `k`
    (stages, capacity, 3): see `pair_force`; `pull` (stages, capacity): force/d (N/m); `gap` likewise: by how much d is
    more than where the force has its pole (m);
    `power` (stages, 2): into the elastic part and taken by damping, W. `members` that take part at some stage.
    """

    many: Array
    first: Array
    second: Array
    n: Array
    g: Array
    k: Array
    pull: Array
    gap: Array
    power: Array
    members: Members

    @classmethod
    def empty(cls, stages: int, capacity: int, points: int, nodes: int) -> Pressing:
        """No pairs, with room for `capacity`."""
        each = (stages, capacity)
        return cls(
            np.zeros(stages, np.int64), np.zeros(each, np.int64), np.zeros(each, np.int64), np.zeros((*each, 3)),
            np.zeros((*each, 3)), np.zeros((*each, 3)), np.zeros(each), np.zeros(each), np.zeros((stages, 2)),
            Members.none(points, nodes),
        )  # fmt: skip


class Touch(NamedTuple):
    """Everything that contact needs in a step; `present` is False in a scene without contact.

    `pressing`: the pairs at the current iterate; `tangents`: at an earlier one, whose tangents serve on.
    `moved` (M, 9): changes of p, t, w of the points; `borne` (M, 3): forces on them. `push` (stages, n, 3): forces on
    the nodes, lab, N.
    """

    present: bool
    law: Law
    points: Points
    pairs: Pairs
    pressing: Pressing
    tangents: Pressing
    moved: Array
    borne: Array
    push: Array


@kernel
def touching(touch: Touch) -> bool:
    """Whether there are pairs that may press."""
    return bool(touch.present and touch.pairs.counts[0] > 0)


@kernel
def press(touch: Touch, pressing: Pressing, r: Array, velocity: Array) -> None:
    """Write the forces on the nodes at all stages into `push`, from nodes `r` (stages, n, 3) and their lab velocities
    (stages, n, >= 3); list the pairs that press, with their tangents, in `pressing`."""
    dismiss(pressing.members)
    for stage in range(len(pressing.many)):
        _press_at(touch, pressing, r[stage], velocity[stage], stage)
        for pair in range(pressing.many[stage]):
            take_in(pressing.members, touch.points, pressing.first[stage, pair])
            take_in(pressing.members, touch.points, pressing.second[stage, pair])


@inner
def _press_at(touch: Touch, pressing: Pressing, r: Array, velocity: Array, stage: int) -> None:
    points, pairs, push, borne = touch.points, touch.pairs, touch.push[stage], touch.borne
    push[:, :] = 0.0
    stored, lost, many = 0.0, 0.0, 0
    for m in range(pairs.members.counts[0]):
        i = pairs.members.points[m]
        place_point(points, i, r, velocity)
        borne[i, 0], borne[i, 1], borne[i, 2] = 0.0, 0.0, 0.0
    for pair in range(pairs.counts[0]):
        a, b = pairs.first[pair], pairs.second[pair]
        if not sees(touch.law, points, a, b):  # most pairs: before any view of an array is made
            continue
        n = pressing.n[stage, many]
        elastic, damping, gap = pair_force(touch.law, points, a, b, n, pressing.g[stage, many], pressing.k[stage, many])
        if elastic == 0.0:
            continue
        pressing.first[stage, many], pressing.second[stage, many], pressing.gap[stage, many] = a, b, gap
        pole = touch.law.pole * (0.5 * (points.diameter[a] + points.diameter[b]))
        pressing.pull[stage, many] = (elastic + damping) / (gap + pole)
        many += 1
        opening = 0.0
        for k in range(3):
            opening += n[k] * (points.w[a, k] - points.w[b, k])
            borne[a, k] += (elastic + damping) * n[k]
            borne[b, k] -= (elastic + damping) * n[k]
        stored -= elastic * opening
        lost -= damping * opening
    for m in range(pairs.members.counts[0]):
        i = pairs.members.points[m]
        for e in range(REACH):
            for k in range(3):
                push[points.first[i] + e, k] += points.weights[i, e] * borne[i, k]
    pressing.many[stage] = many
    pressing.power[stage, 0], pressing.power[stage, 1] = stored, lost


@kernel
def keeps_apart(points: Points, pairs: Pairs, r: Array) -> bool:
    """Whether nodes at r (n, 3) leave the pairs enough of the gaps that they had at the start of the step."""
    for m in range(pairs.members.counts[0]):
        place_point(points, pairs.members.points[m], r, r)
    for pair in range(pairs.counts[0]):
        a, b = pairs.first[pair], pairs.second[pair]
        now, before = 0.0, 0.0
        for k in range(3):
            now += (points.p[a, k] - points.p[b, k]) ** 2
            before += (points.start[a, k] - points.start[b, k]) ** 2
        radius = 0.25 * (points.diameter[a] + points.diameter[b])
        gap = np.sqrt(before) - radius
        if np.sqrt(now) - radius < (1.0 - LARGEST_FORESEEN) * gap and gap > 0.0:
            return False
    return True


@kernel
def move_points(touch: Touch, members: Members, moved: Array, accelerated: Array) -> None:
    """Write the changes of p, t, w of the points of `members`, for changes of the nodes' own (n, 3)."""
    change = touch.moved
    for m in range(members.counts[0]):
        i = members.points[m]
        for k in range(3):
            change[i, k], change[i, 3 + k], change[i, 6 + k] = between_nodes(touch.points, i, k, moved, accelerated)


@kernel
def change_forces(touch: Touch, pressing: Pressing, stage: int, y: Array) -> None:
    """Write the changes of the forces on the nodes near others (3 per node) that belong to `touch.moved` into y."""
    points, moved, borne = touch.points, touch.moved, touch.borne
    slot, members = touch.pairs.members.slot, pressing.members
    first, second = pressing.first[stage], pressing.second[stage]
    n, g, k, pull = pressing.n[stage], pressing.g[stage], pressing.k[stage], pressing.pull[stage]
    for m in range(members.counts[0]):
        i = members.points[m]
        borne[i, 0], borne[i, 1], borne[i, 2] = 0.0, 0.0, 0.0
    for pair in range(pressing.many[stage]):
        a, b = first[pair], second[pair]
        along = 0.0
        for c in range(3):
            turned = k[pair, 0] * moved[a, 3 + c] + k[pair, 1] * moved[b, 3 + c]
            turned += k[pair, 2] * (moved[a, 6 + c] - moved[b, 6 + c])
            along += n[pair, c] * turned + g[pair, c] * (moved[a, c] - moved[b, c])
        for c in range(3):
            force = n[pair, c] * along + pull[pair] * (moved[a, c] - moved[b, c])
            borne[a, c] += force
            borne[b, c] -= force
    y[: 3 * touch.pairs.members.counts[1]] = 0.0
    for m in range(members.counts[0]):
        i = members.points[m]
        for e in range(REACH):
            at, weight = 3 * slot[points.first[i] + e], points.weights[i, e]
            for c in range(3):
                y[at + c] += weight * borne[i, c]


@kernel
def allowed_fraction(touch: Touch, pressing: Pressing, stage: int) -> float:
    """How much of the change `touch.moved` may be taken without using up a pair's distance or gap."""
    fraction, pairs, points, moved = 1.0, touch.pairs, touch.points, touch.moved
    for pair in range(pairs.counts[0]):
        a, b = pairs.first[pair], pairs.second[pair]
        change, distance = 0.0, 0.0
        for k in range(3):
            change += (moved[a, k] - moved[b, k]) ** 2
            distance += (points.p[a, k] - points.p[b, k]) ** 2
        if change * fraction**2 > LARGEST_APPROACH**2 * distance:
            fraction = LARGEST_APPROACH * np.sqrt(distance / change)
    for pair in range(pressing.many[stage]):
        a, b, n = pressing.first[stage, pair], pressing.second[stage, pair], pressing.n[stage, pair]
        closing = 0.0
        for k in range(3):
            closing -= n[k] * (moved[a, k] - moved[b, k])
        gap = LARGEST_CLOSING * pressing.gap[stage, pair]
        if gap > 0.0 and closing * fraction > gap:
            fraction = gap / closing
    return fraction
