"""The forces of contact on the nodes, and how they change with the nodes' motion."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from solver.arrays import Array
from solver.kernels.kernel import inner, kernel
from solver.kernels.scratch import scratch
from solver.physics.contact.law import Law, pair_force, sees
from solver.physics.contact.members import Members, dismiss, take_in
from solver.physics.contact.points import REACH, Points, move_point, place_point, square_between, turn_point
from solver.physics.contact.search import Pairs

LARGEST_APPROACH = 0.6
"""Part of a pair's distance that one Newton update may use."""
LARGEST_CLOSING = 0.8
"""Part of the gap of a pressing pair that one Newton update may close: the force has a pole where it ends."""
LARGEST_FORESEEN = 0.5
"""Part of the gap of a pair that the first guess of a step may close."""


class Pressing(NamedTuple):
    """The pairs that press on each other at the current iterate, at each stage of a step.

    `many` (stages,): their numbers; `first`, `second` (stages, capacity) their points; `n` (stages, capacity, 3): see
    `pair_force`; `gap` (stages, capacity): by how much d is more than where the force has its pole (m); `nearest`
    (stages,): the least d (m) of all listed pairs; `power` (stages, 2): into the elastic part and taken by damping, W.
    """

    many: Array
    first: Array
    second: Array
    n: Array
    gap: Array
    nearest: Array
    power: Array

    @classmethod
    def empty(cls, stages: int, capacity: int) -> Pressing:
        """No pairs, with room for `capacity`."""
        each = (stages, capacity)
        return cls(np.zeros(stages, np.int64), np.zeros(each, np.int64), np.zeros(each, np.int64), np.zeros((*each, 3)),
                   np.zeros(each), np.zeros(stages), np.zeros((stages, 2)))  # fmt: skip


class Tangents(NamedTuple):
    """How the forces of the pairs change that pressed on each other at one stage of some iterate.

    `many` (1,): their number; `first`, `second` (capacity,) their points; `n`, `g`, `k` (capacity, 3): see
    `pair_force`; `pull` (capacity,): force/d (N/m). `members` that take part.
    """

    many: Array
    first: Array
    second: Array
    n: Array
    g: Array
    k: Array
    pull: Array
    members: Members

    @classmethod
    def empty(cls, capacity: int, points: int, nodes: int) -> Tangents:
        """No pairs, with room for `capacity`."""
        n, g, k = np.zeros((3, capacity, 3))
        return cls(np.zeros(1, np.int64), np.zeros(capacity, np.int64), np.zeros(capacity, np.int64), n, g, k,
                   np.zeros(capacity), Members.none(points, nodes))  # fmt: skip


class Passed(NamedTuple):
    """What points pass on between the nodes: their changes `moved` (M, 6) of p and t, and the forces `borne` (M, 3) on
    them; real, or complex as the motion of the nodes is."""

    moved: Array
    borne: Array

    @classmethod
    def empty(cls, points: int, dtype: type = np.float64) -> Passed:
        """Zeros."""
        return cls(np.zeros((points, 6), dtype), np.zeros((points, 3), dtype))


class Touch(NamedTuple):
    """Everything that contact needs in a step; `present` is False in a scene without contact.

    `pressing`: the pairs at the current iterate; `tangents`: of one stage, perhaps of an earlier iterate. `passed` by
    the points, and `passed_pair` likewise for complex motion. `push` (stages, n, 3): forces on the nodes, lab, N.
    """

    present: bool
    law: Law
    points: Points
    pairs: Pairs
    pressing: Pressing
    tangents: Tangents
    passed: Passed
    passed_pair: Passed
    push: Array

    @classmethod
    def empty(cls, present: bool, law: Law, points: Points, nodes: int, stages: int, capacity: int) -> Touch:
        """No pairs of these points on so many nodes, with room for `capacity`."""
        M = len(points.p)
        return cls(
            present, law, points, Pairs.empty(capacity, M, nodes), Pressing.empty(stages, capacity),
            Tangents.empty(capacity, M, nodes), Passed.empty(M), Passed.empty(M, np.complex128),
            np.zeros((stages, nodes, 3)),
        )  # fmt: skip


@kernel
def touching(touch: Touch) -> bool:
    """Whether there are pairs that may press."""
    return bool(touch.present and touch.pairs.counts[0] > 0)


@kernel
def press(touch: Touch, r: Array, velocity: Array, tangent: int) -> None:
    """Write the forces on the nodes at all stages into `push`, from nodes `r` (stages, n, 3) and their lab velocities
    (stages, n, >= 3); list the pairs that press, and write the tangents of the stage `tangent`, of none where it is -1.
    """
    for stage in range(len(touch.pressing.many)):
        _press_at(touch, r[stage], velocity[stage], stage, stage == tangent)
    if tangent >= 0:
        tangents = touch.tangents
        dismiss(tangents.members)
        for pair in range(tangents.many[0]):
            take_in(tangents.members, touch.points, tangents.first[pair])
            take_in(tangents.members, touch.points, tangents.second[pair])


@inner
def _press_at(touch: Touch, r: Array, velocity: Array, stage: int, wanted: bool) -> None:
    """See `press`, of one stage, with its tangents if these are `wanted`."""
    points, pairs, push, borne = touch.points, touch.pairs, touch.push[stage], touch.passed.borne
    pressing, tangents, spare = touch.pressing, touch.tangents, scratch((2, 3))
    push[:, :] = 0.0
    stored, lost, nearest, many = 0.0, 0.0, np.inf, 0
    for m in range(pairs.members.counts[0]):
        i = pairs.members.points[m]
        place_point(points, i, r, velocity)
        borne[i, 0], borne[i, 1], borne[i, 2] = 0.0, 0.0, 0.0
    for pair in range(pairs.counts[0]):
        a, b = pairs.first[pair], pairs.second[pair]
        square = square_between(points.p, a, b)
        nearest = min(nearest, square)
        if not sees(touch.law, points, a, b, square):  # most pairs: before any view of an array is made
            continue
        n = pressing.n[stage, many]
        g, k = (tangents.g[many], tangents.k[many]) if wanted else (spare[0], spare[1])
        elastic, damping, gap = pair_force(touch.law, points, a, b, n, g, k)
        if elastic == 0.0:
            continue
        force = elastic + damping
        pressing.first[stage, many], pressing.second[stage, many], pressing.gap[stage, many] = a, b, gap
        if wanted:
            tangents.first[many], tangents.second[many] = a, b
            tangents.n[many, 0], tangents.n[many, 1], tangents.n[many, 2] = n[0], n[1], n[2]
            tangents.pull[many] = force / np.sqrt(square)
        many += 1
        opening = 0.0
        for c in range(3):
            opening += n[c] * (points.w[a, c] - points.w[b, c])
            borne[a, c] += force * n[c]
            borne[b, c] -= force * n[c]
        stored -= elastic * opening
        lost -= damping * opening
    for m in range(pairs.members.counts[0]):
        i = pairs.members.points[m]
        for e in range(REACH):
            for c in range(3):
                push[points.first[i] + e, c] += points.weights[i, e] * borne[i, c]
    pressing.many[stage], pressing.nearest[stage] = many, np.sqrt(nearest)
    pressing.power[stage, 0], pressing.power[stage, 1] = stored, lost
    if wanted:
        tangents.many[0] = many


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
def change_forces(touch: Touch, rate: complex, nodes: Array, passed: Passed, y: Array) -> None:
    """Write the changes of the forces on the nodes near others (3 per node), by the tangents, into y: as the nodes move
    by `nodes` (n, 3) and their velocities change by `rate` (1/s) times that; all real or complex."""
    points, tangents, moved, borne = touch.points, touch.tangents, passed.moved, passed.borne
    slot, members, turns = touch.pairs.members.slot, tangents.members, not touch.law.automatic
    first, second, n, g, k, pull = (
        tangents.first, tangents.second, tangents.n, tangents.g, tangents.k, tangents.pull
    )  # fmt: skip
    for m in range(members.counts[0]):
        i = members.points[m]
        move_point(points, i, nodes, moved)
        if turns:
            turn_point(points, i, nodes, moved)
        borne[i, 0], borne[i, 1], borne[i, 2] = 0.0, 0.0, 0.0
    for pair in range(tangents.many[0]):
        a, b = first[pair], second[pair]
        x, v, z = moved[a, 0] - moved[b, 0], moved[a, 1] - moved[b, 1], moved[a, 2] - moved[b, 2]
        along = g[pair, 0] * x + g[pair, 1] * v + g[pair, 2] * z
        along += k[pair, 2] * rate * (n[pair, 0] * x + n[pair, 1] * v + n[pair, 2] * z)
        if turns:
            for c in range(3):
                along += n[pair, c] * (k[pair, 0] * moved[a, 3 + c] + k[pair, 1] * moved[b, 3 + c])
        x, v, z = (pull[pair] * x + n[pair, 0] * along, pull[pair] * v + n[pair, 1] * along,
                    pull[pair] * z + n[pair, 2] * along)  # fmt: skip
        borne[a, 0], borne[a, 1], borne[a, 2] = borne[a, 0] + x, borne[a, 1] + v, borne[a, 2] + z
        borne[b, 0], borne[b, 1], borne[b, 2] = borne[b, 0] - x, borne[b, 1] - v, borne[b, 2] - z
    y[: 3 * touch.pairs.members.counts[1]] = 0.0
    for m in range(members.counts[0]):
        i = members.points[m]
        for e in range(REACH):
            at, weight = 3 * slot[points.first[i] + e], points.weights[i, e]
            for c in range(3):
                y[at + c] += weight * borne[i, c]


@kernel
def allowed_fraction(touch: Touch, nodes: Array, stage: int) -> float:
    """How much of the nodes' change (n, 3) at a stage may be taken without using up a pair's distance or gap."""
    fraction, pairs, points, moved, pressing = 1.0, touch.pairs, touch.points, touch.passed.moved, touch.pressing
    farthest = 0.0
    for m in range(pairs.members.counts[0]):
        i = pairs.members.points[m]
        move_point(points, i, nodes, moved)
        farthest = max(farthest, moved[i, 0] ** 2 + moved[i, 1] ** 2 + moved[i, 2] ** 2)
    if not 4.0 * farthest <= (LARGEST_APPROACH * pressing.nearest[stage]) ** 2:
        for pair in range(pairs.counts[0]):
            a, b = pairs.first[pair], pairs.second[pair]
            change, distance = square_between(moved, a, b), square_between(points.p, a, b)
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
