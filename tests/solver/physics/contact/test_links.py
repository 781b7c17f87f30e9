"""Links between contact points: their distance against brute force, and what a step may do with them."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose

from solver.arrays import Array
from solver.physics.contact.links import link_distance, links_meet, links_reach
from solver.physics.contact.points import Points, contact_points
from solver.physics.contact.search import Pairs, find_pairs
from solver.scene.contact import Contact
from solver.scene.rod import Rod

LENGTH, SPACING, SKIP = 0.3, 0.01, 0.1
THIN, THICK = 1e-5, 4e-3
"""Diameters (m): a thread that all but vanishes, and a rod thinner than its points are apart."""


def test_the_distance_of_links_is_the_smallest_there_is() -> None:
    random = np.random.default_rng(5)
    along = np.linspace(0.0, 1.0, 201)
    for _ in range(50):
        p = random.normal(size=(4, 3))
        u = p[0] + along[:, None] * (p[1] - p[0])
        v = p[2] + along[:, None] * (p[3] - p[2])
        nearest = np.linalg.norm(u[:, None] - v[None], axis=2).min()
        # a place is missed by half a step of the brute search at the most, on either link
        missed = 0.25 * along[1] * (np.linalg.norm(p[1] - p[0]) + np.linalg.norm(p[3] - p[2]))
        assert nearest - 2.0 * missed <= link_distance(p, 0, 2) <= nearest * (1.0 + 1e-12)


@pytest.mark.parametrize("lift", [0.0, 0.3])
def test_parallel_links_have_the_distance_of_their_lines(lift: float) -> None:
    p = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.3, lift, 0.0], [1.3, lift, 0.0]])
    assert_allclose(link_distance(p, 0, 2), lift, atol=1e-7)  # a root of rounding errors


def hairpin(gap: float, shift: float = 0.0, turned: float = 0.0) -> Array:
    """Points of two strands, `gap` above each other, that cross at a right angle half way between two points of each.

    The upper one is shifted along the lower one; the whole is turned about the lower one.
    """
    count = round(LENGTH / SPACING) + 1
    p = np.full((count, 3), 1.0)
    x = (np.arange(count) - 5.5) * SPACING
    p[:12] = np.column_stack([x, 0.0 * x, 0.0 * x])[:12]
    p[12:-12] += np.arange(count - 24)[:, None] * [SPACING, 0.0, 0.0]
    p[-12:] = np.column_stack([0.0 * x + shift, x, 0.0 * x + gap])[:12]
    cos, sin = np.cos(turned), np.sin(turned)
    return np.asarray(p @ np.array([[1.0, 0.0, 0.0], [0.0, cos, sin], [0.0, -sin, cos]]))


def step(diameter: float, before: Array, after: Array) -> tuple[Points, Pairs]:
    contact = Contact(k1=1e-7, k2=3.0, k3=0.0, k4=1.0, aperture=1.0, cutoff=1e-4, skip=SKIP, spacing=SPACING)
    rod = Rod.circular(LENGTH, diameter, 1e7, 5e6, 1500.0)
    points = contact_points(contact, rod, np.linspace(0.0, LENGTH, 41))
    points.start[:], points.p[:] = before, after
    pairs = Pairs.empty(1000, len(points.p), 41)
    find_pairs(points, SKIP, links_reach(points), pairs)
    assert pairs.counts[1] == 0
    return points, pairs


def test_strands_that_cross_between_their_points_are_seen() -> None:
    """Found among the stress test's random cases, [1, 363]: no pair of points came near another one."""
    points, pairs = step(THIN, hairpin(1e-3), hairpin(-1e-3))
    nearest = np.linalg.norm(points.p[:12, None] - points.p[None, -12:], axis=2).min()
    assert nearest > 0.7 * SPACING
    assert links_meet(points, pairs)


@pytest.mark.parametrize(
    ("before", "after"),
    [
        (hairpin(1e-3), hairpin(0.6e-3)),
        (hairpin(1e-3), hairpin(1e-3, shift=0.9e-3)),
        (hairpin(1e-3), hairpin(1e-3, turned=0.02)),
        (hairpin(1e-3), hairpin(1e-3) + 0.1),
    ],
    ids=["come nearer", "slide", "turn", "fly together"],
)
def test_strands_that_keep_apart_are_let_pass(before: Array, after: Array) -> None:
    assert not links_meet(*step(THIN, before, after))


def test_strands_within_each_other_are_seen_though_they_hardly_move() -> None:
    assert not links_meet(*step(THICK, hairpin(1.2e-3), hairpin(1.1e-3)))
    assert links_meet(*step(THICK, hairpin(1.1e-3), hairpin(0.9e-3)))


def test_neighbours_along_the_rod_are_no_strangers() -> None:
    """However little rod may lie between points that see each other."""
    count = round(LENGTH / SPACING) + 1
    straight = np.arange(count)[:, None] * np.array([SPACING, 0.0, 0.0])
    points, pairs = step(1.5 * SPACING, straight, straight)
    find_pairs(points, SPACING, 4.0 * SPACING, pairs)
    assert pairs.counts[0] > 2 * count
    assert not links_meet(points, pairs)
