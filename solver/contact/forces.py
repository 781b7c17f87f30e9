"""The forces of contact on the nodes, and how they change with the nodes' motion."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from solver.contact.law import Law, pair_force
from solver.contact.points import REACH, Points, place_point
from solver.contact.search import Pairs
from solver.kernel import kernel
from solver.rod import Array

LARGEST_APPROACH = 0.6
"""Part of a pair's distance that one Newton update may use."""


class Touch(NamedTuple):
    """Everything that contact needs in a step; `present` is False in a scene without contact.

    `moved` (M, 9): changes of p, t, w of the points. `push` (stages, n, 3): forces on the nodes, lab, N.
    """

    present: bool
    law: Law
    points: Points
    pairs: Pairs
    moved: Array
    push: Array


@kernel
def touching(touch: Touch) -> bool:
    """Whether there are pairs that may press."""
    return bool(touch.present and touch.pairs.counts[0] > 0)


@kernel
def press(touch: Touch, r: Array, velocity: Array, stage: int) -> None:
    """Write the forces on the nodes at a stage into `push`, from nodes `r` and lab `velocity`; keep the tangents."""
    points, pairs, push = touch.points, touch.pairs, touch.push[stage]
    push[:, :] = 0.0
    stored, lost = 0.0, 0.0
    for m in range(pairs.counts[1]):
        place_point(points, pairs.points[m], r, velocity)
    for pair in range(pairs.counts[0]):
        a, b = pairs.first[pair], pairs.second[pair]
        n = pairs.n[stage, pair]
        elastic, damping, _ = pair_force(touch.law, points, a, b, n, pairs.G[stage, pair], pairs.k[stage, pair])
        pairs.force[stage, pair, 0], pairs.force[stage, pair, 1] = elastic, damping
        if elastic == 0.0:
            continue
        opening = 0.0
        for k in range(3):
            opening += n[k] * (points.w[a, k] - points.w[b, k])
            force = (elastic + damping) * n[k]
            for m in range(REACH):
                push[points.first[a] + m, k] += points.weights[a, m] * force
                push[points.first[b] + m, k] -= points.weights[b, m] * force
        stored -= elastic * opening
        lost -= damping * opening
    pairs.power[stage, 0], pairs.power[stage, 1] = stored, lost


@kernel
def move_points(touch: Touch, moved: Array, accelerated: Array) -> None:
    """Write the changes of p, t, w of the points that take part, for changes of the nodes' own (n, 3)."""
    points, pairs = touch.points, touch.pairs
    for m in range(pairs.counts[1]):
        i = pairs.points[m]
        for k in range(3):
            place, along, speed = 0.0, 0.0, 0.0
            for e in range(REACH):
                node = points.first[i] + e
                place += points.weights[i, e] * moved[node, k]
                along += points.slopes[i, e] * moved[node, k]
                speed += points.weights[i, e] * accelerated[node, k]
            touch.moved[i, k], touch.moved[i, 3 + k], touch.moved[i, 6 + k] = place, along, speed


@kernel
def change_forces(touch: Touch, stage: int, y: Array) -> None:
    """Write the changes of the forces on the nodes that take part (3 per node) that belong to `touch.moved` into y."""
    points, pairs, moved = touch.points, touch.pairs, touch.moved
    y[: 3 * pairs.counts[2]] = 0.0
    for pair in range(pairs.counts[0]):
        if pairs.force[stage, pair, 0] == 0.0:
            continue
        a, b = pairs.first[pair], pairs.second[pair]
        n, k, G = pairs.n[stage, pair], pairs.k[stage, pair], pairs.G[stage, pair]
        along = 0.0
        for c in range(3):
            turned = k[0] * moved[a, 3 + c] + k[1] * moved[b, 3 + c]
            along += n[c] * (turned + k[2] * (moved[a, 6 + c] - moved[b, 6 + c]))
        for c in range(3):
            force = n[c] * along
            for e in range(3):
                force += G[c, e] * (moved[a, e] - moved[b, e])
            for m in range(REACH):
                y[3 * pairs.slot[points.first[a] + m] + c] += points.weights[a, m] * force
                y[3 * pairs.slot[points.first[b] + m] + c] -= points.weights[b, m] * force


@kernel
def allowed_fraction(touch: Touch) -> float:
    """How much of the change `touch.moved` may be taken without using up a pair's distance."""
    fraction, pairs, points, moved = 1.0, touch.pairs, touch.points, touch.moved
    for pair in range(pairs.counts[0]):
        a, b = pairs.first[pair], pairs.second[pair]
        change, distance = 0.0, 0.0
        for k in range(3):
            change += (moved[a, k] - moved[b, k]) ** 2
            distance += (points.p[a, k] - points.p[b, k]) ** 2
        if change * fraction**2 > LARGEST_APPROACH**2 * distance:
            fraction = LARGEST_APPROACH * np.sqrt(distance / change)
    return fraction
