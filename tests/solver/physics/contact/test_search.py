"""The pair search against brute force, and the bound that makes it needless."""

from __future__ import annotations

from math import ceil, cos, inf, pi, sqrt

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from solver.arrays import Array
from solver.methods.space.box.fields import KAPPA
from solver.methods.space.box.trial import total_bending
from solver.physics.contact.law import Law
from solver.physics.contact.points import Points, contact_points, farthest, place_points
from solver.physics.contact.search import (
    Pairs,
    find_pairs,
    foresee,
    harmless_bending,
    largest_displacement,
    most_bent,
    smallest_distance,
    straight_arc,
    used,
)
from solver.physics.contact.self_contact import BENT
from solver.scene.contact import Contact
from solver.scene.rod import Rod

LENGTH, INTERVALS = 1.0, 40
S = np.linspace(0.0, LENGTH, INTERVALS + 1)
SPACING = LENGTH / 150
SKIP = 0.0712
"""No multiple of the spacing, so that no pair is exactly that far apart."""
CONTACT = Contact(k1=1e-7, k2=3.0, k3=1e-6, k4=1.0, aperture=1.0, cutoff=0.03, skip=SKIP, spacing=SPACING)
ROD = Rod.circular(LENGTH, 0.01, 1e7, 5e6, 1500.0)

seeds = st.integers(0, 10**6)
wildness = st.floats(0.1, 8.0)


def tangents(s: Array, seed: int, amplitude: float) -> Array:
    """A smooth random field of unit tangents."""
    random = np.random.default_rng(seed)
    angles = np.zeros((2, len(s)))
    for wave in range(1, 5):
        size, phase = random.normal(size=(2, 1)), random.uniform(0, 2 * pi, (2, 1))
        angles += amplitude / wave * size * np.sin(wave * pi * s + phase)
    polar, azimuth = angles
    return np.stack([np.cos(polar) * np.cos(azimuth), np.cos(polar) * np.sin(azimuth), np.sin(polar)], axis=1)


def curve_of(T: Array, h: float) -> Array:
    """Nodes of an inextensible rod with tangents T: Delta r = h T_m, as in the solver."""
    return np.vstack([np.zeros(3), np.cumsum(0.5 * h * (T[1:] + T[:-1]), axis=0)])


def points_of(T: Array) -> Points:
    points = contact_points(CONTACT, ROD, S)
    place_points(points, curve_of(T, S[1]), np.zeros((len(S), 12)))
    return points


def distances(points: Points, skip: float = SKIP) -> dict[tuple[int, int], float]:
    """Of all pairs more than `skip` of arc apart."""
    first, second = np.triu_indices(len(points.p), int(skip / points.spacing) + 1)
    apart = np.linalg.norm(points.p[first] - points.p[second], axis=1)
    return {(int(a), int(b)): float(d) for a, b, d in zip(first, second, apart, strict=True)}


def found_by(points: Points, radius: float, capacity: int = 12000) -> Pairs:
    pairs = Pairs.empty(capacity, len(points.p), len(S))
    find_pairs(points, SKIP, radius, pairs)
    return pairs


def listed(pairs: Pairs) -> set[tuple[int, int]]:
    count = pairs.counts[0]
    return {(int(a), int(b)) for a, b in zip(pairs.first[:count], pairs.second[:count], strict=True)}


@given(seeds, wildness)
@settings(max_examples=40, deadline=None)
def test_the_smallest_distance_is_that_of_brute_force(seed: int, amplitude: float) -> None:
    points = points_of(tangents(S, seed, amplitude))
    assert smallest_distance(points, SKIP, inf, 0.0) == pytest.approx(min(distances(points).values()), rel=1e-12)


@given(seeds, wildness)
@settings(max_examples=40, deadline=None)
def test_the_pairs_found_are_those_of_brute_force(seed: int, amplitude: float) -> None:
    points = points_of(tangents(S, seed, amplitude))
    every = distances(points)
    for radius in (0.03, 1.5 * min(every.values())):
        assert listed(found_by(points, radius)) == {pair for pair, d in every.items() if d < radius}


@given(seeds, wildness)
@settings(max_examples=40, deadline=None)
def test_pairs_are_listed_that_may_come_near_as_their_points_go(seed: int, amplitude: float) -> None:
    points = points_of(tangents(S, seed, amplitude))
    whole, points.w[:] = np.random.default_rng(seed).exponential(size=(2, *points.w.shape)) ** 2
    foresee(points.w, whole, points.slack, 0.01, 0.005, 0.08)
    assert_allclose(points.slack, np.clip(0.01 * np.linalg.norm(points.w - whole, axis=1), 0.005, 0.08))
    every, reach = distances(points), 0.03
    near = {(a, b) for (a, b), d in every.items() if d < reach + points.slack[a] + points.slack[b]}
    assert listed(found_by(points, reach)) == near


def test_how_much_of_its_slack_a_point_has_used_and_how_soon_it_will() -> None:
    points = points_of(tangents(S, 1, 2.0))
    points.checked[:], points.slack[:], points.w[:] = points.p, 0.1, 0.0
    still = np.zeros_like(points.w)
    assert used(points.p, points.checked, points.slack) == used(points.w, still, points.slack) == 0.0
    points.slack[7], points.checked[7] = 0.02, points.p[7] + [0.003, 0.0, -0.004]
    points.w[9], points.slack[9] = [0.0, 3.0, 4.0], 0.2
    assert used(points.p, points.checked, points.slack) == pytest.approx(0.25)
    assert used(points.w, still, points.slack) == pytest.approx(1.0 / 0.04)


@given(seeds, wildness)
@settings(max_examples=40, deadline=None)
def test_the_smallest_gap_is_that_of_brute_force_on_a_rod_whose_thickness_varies(seed: int, amplitude: float) -> None:
    points = points_of(tangents(S, seed, amplitude))
    points.diameter[:] = 0.03 * np.random.default_rng(seed).uniform(0.1, 1.0, len(points.p))
    gaps = [d - 0.5 * (points.diameter[a] + points.diameter[b]) for (a, b), d in distances(points).items()]
    assert smallest_distance(points, SKIP, inf, 0.5) == pytest.approx(min(gaps), rel=1e-12)


def test_a_distance_that_is_enough_is_returned_if_none_is_smaller() -> None:
    points = points_of(tangents(S, 1, 6.0))
    smallest = min(distances(points).values())
    assert smallest_distance(points, SKIP, 0.5 * smallest, 0.0) == 0.5 * smallest
    assert smallest_distance(points, SKIP, 2.0 * smallest, 0.0) == pytest.approx(smallest, rel=1e-12)


def test_a_rod_shorter_than_the_skip_has_no_pairs() -> None:
    points = points_of(tangents(S, 1, 6.0))
    assert smallest_distance(points, 1.5 * LENGTH, inf, 0.0) == inf


def test_a_folded_rod_is_found_out_although_the_search_marches() -> None:
    """Two straight strands, side by side, joined by a tight bend."""
    T = np.tile([0.0, 0.0, 1.0], (len(S), 1))
    bend = slice(19, 23)
    angle = np.linspace(0.0, pi, 6)[1:-1]
    T[bend] = np.column_stack([np.sin(angle), np.zeros(4), np.cos(angle)])
    T[23:] = [0.0, 0.0, -1.0]
    points = points_of(T)
    every = distances(points)
    radius = 1.1 * max(min(every.values()), 0.05)
    assert listed(found_by(points, radius)) == {pair for pair, d in every.items() if d < radius}


@pytest.mark.parametrize("closing", [inf, 0.01])
def test_in_a_coil_all_are_found_although_all_are_near(closing: float) -> None:
    angle = 2.0 * pi * 5.0 * S
    T = np.column_stack([np.cos(angle), np.sin(angle), np.full(len(S), 0.1)]) / sqrt(1.01)
    points = points_of(T)._replace(closing=closing)
    last = [farthest(points, SKIP, a) for a in range(len(points.p))]
    every = {pair: d for pair, d in distances(points).items() if pair[1] <= last[pair[0]]}
    assert listed(found_by(points, 0.03)) == {pair for pair, d in every.items() if d < 0.03} != set()
    assert smallest_distance(points, SKIP, inf, 0.0) == pytest.approx(min(every.values()), rel=1e-12)
    assert smallest_distance(points, SKIP, inf, 0.5) == pytest.approx(min(every.values()) - 0.01, rel=1e-12)


def test_what_does_not_fit_is_counted() -> None:
    points = points_of(tangents(S, 3, 7.0))
    everything = found_by(points, 0.2)
    assert everything.counts[1] == 0
    total = int(everything.counts[0])
    assert total > 10
    some = found_by(points, 0.2, capacity=10)
    assert (some.counts[0], some.counts[1]) == (10, total - 10)
    assert listed(some) <= listed(everything)


def test_the_points_and_nodes_of_the_pairs_are_listed_once_each() -> None:
    points = points_of(tangents(S, 3, 7.0))
    pairs = found_by(points, 0.1)
    members = {i for pair in listed(pairs) for i in pair}
    assert members
    taking = pairs.members
    assert sorted(taking.points[: taking.counts[0]]) == sorted(members)
    assert set(np.flatnonzero(taking.taken)) == members
    nodes = {int(points.first[i]) + side for i in members for side in range(4)}
    assert sorted(taking.nodes[: taking.counts[1]]) == sorted(nodes)
    for place, node in enumerate(taking.nodes[: taking.counts[1]]):
        assert taking.slot[node] == place
    assert np.count_nonzero(taking.slot >= 0) == len(nodes)


def test_points_lie_on_the_rod_evenly_from_end_to_end() -> None:
    T = tangents(S, 5, 0.5)
    points = points_of(T)
    r = curve_of(T, S[1])
    assert len(points.p) == round(LENGTH / SPACING) + 1
    assert_allclose(points.p[[0, -1]], r[[0, -1]], atol=1e-15)
    assert_allclose(np.linalg.norm(np.diff(points.p, axis=0), axis=1), points.spacing, rtol=0.01)
    assert_allclose(np.linalg.norm(points.t, axis=1), 1.0, rtol=0.01)


def test_points_lie_on_a_circle_to_the_fourth_order_of_the_nodes_spacing() -> None:
    def error(intervals: int) -> float:
        s = np.linspace(0.0, LENGTH, intervals + 1)
        circle = np.column_stack([np.cos(s), np.sin(s), 0.0 * s])
        points = contact_points(CONTACT, ROD, s)
        place_points(points, circle, np.zeros_like(circle))
        inside = slice(len(points.p) // 4, 3 * len(points.p) // 4)
        return float(np.abs(np.linalg.norm(points.p[inside], axis=1) - 1.0).max())

    assert error(20) / error(40) == pytest.approx(16.0, rel=0.2)


def test_a_force_on_a_point_acts_on_the_nodes_with_its_own_resultant_and_moment() -> None:
    points = contact_points(CONTACT, ROD, S)
    assert_allclose(points.weights.sum(axis=1), 1.0, atol=1e-14)
    along = np.linspace(0.0, LENGTH, len(points.p))
    nodes = points.first[:, None] + np.arange(4)
    assert_allclose((points.weights * S[nodes]).sum(axis=1), along, atol=1e-14)


def test_points_of_a_straight_rod_are_where_linear_interpolation_puts_them() -> None:
    points = points_of(np.tile([0.0, 0.0, 1.0], (len(S), 1)))
    assert_allclose(points.p[:, 2], np.linspace(0.0, LENGTH, len(points.p)), atol=1e-14)
    assert_allclose(points.t, np.tile([0.0, 0.0, 1.0], (len(points.p), 1)))


@given(seeds, wildness, st.floats(0.05, 0.9))
@settings(max_examples=150, deadline=None)
def test_where_the_bound_says_that_nothing_touches_nothing_does(seed: int, amplitude: float, skip: float) -> None:
    """An arc of length l and total curvature K < pi has a chord of at least l cos(K/2)."""
    s = np.linspace(0.0, LENGTH, 401)
    T = tangents(s, seed, amplitude)
    r = curve_of(T, s[1])
    turns = 2.0 * np.arcsin(np.clip(0.5 * np.linalg.norm(np.diff(T, axis=0), axis=1), 0.0, 1.0))
    apart = ceil(skip / s[1])
    nearest = min(float(np.linalg.norm(r[b:] - r[: len(r) - b], axis=1).min()) for b in range(apart, len(r)))
    law = Law.of(CONTACT, SPACING)._replace(skip=skip)
    assert float(turns.sum()) >= harmless_bending(nearest * (1 + 1e-12), law)


@pytest.mark.parametrize("corner", [0.5, 1.5, 2.5])
def test_the_bound_is_sharp(corner: float) -> None:
    """A V is as near to itself as an arc of its total curvature can be."""
    law = Law.of(CONTACT, SPACING)
    chord = SKIP * cos(0.5 * corner)
    assert corner < harmless_bending(0.999 * chord, law)
    assert corner >= harmless_bending(1.001 * chord, law)


@pytest.mark.parametrize("bending", [pi, 4.0, 12.0, 4 * pi])
def test_a_rod_that_turns_by_pi_may_touch_itself(bending: float) -> None:
    assert bending >= harmless_bending(1e-9, Law.of(CONTACT, SPACING))


def test_the_total_bending_counts_both_axes_and_not_the_twist() -> None:
    Y = np.zeros((len(S), 12))
    Y[:, KAPPA : KAPPA + 3] = [3.0, -4.0, 100.0]
    assert total_bending(Y, S[1]) == pytest.approx(5.0 * LENGTH, rel=1e-12)


@given(seeds, wildness)
@settings(max_examples=20, deadline=None)
def test_the_largest_displacement_is_since_the_last_look(seed: int, amplitude: float) -> None:
    points = points_of(tangents(S, seed, amplitude))
    points.checked[:] = points.p
    assert largest_displacement(points.p, points.checked) == 0.0
    points.checked[7] += [0.3, 0.0, -0.4]
    assert largest_displacement(points.p, points.checked) == pytest.approx(0.5)


@given(seeds, wildness, st.floats(0.3, 2.5))
@settings(max_examples=60, deadline=None)
def test_arcs_that_bend_little_are_as_long_as_brute_force_has_it(seed: int, amplitude: float, bending: float) -> None:
    nodes = curve_of(tangents(S, seed, amplitude), S[1])
    chords = np.diff(nodes, axis=0)
    chords /= np.linalg.norm(chords, axis=1)[:, None]
    angles = np.pad(np.arccos(np.clip(np.sum(chords[1:] * chords[:-1], axis=1), -1.0, 1.0)), 1)
    bent = 0.5 * (angles[1:] + angles[:-1])
    most = [np.convolve(bent, np.ones(many), "valid").max() for many in range(1, len(bent) + 1)]
    straight = sum(each <= bending for each in most)
    arc = straight_arc(nodes, bending)
    assert arc == straight - 1 if straight > 1 else arc <= 1.0
    assert most_bent(nodes, arc) <= bending * (1.0 + 1e-9)
    assert [most_bent(nodes, many) for many in range(1, len(bent))] == pytest.approx(most[1:], abs=1e-6)


@pytest.mark.parametrize("intervals", [8, 12, 20, INTERVALS])
@given(seeds, wildness)
@settings(max_examples=30, deadline=None)
def test_no_two_points_on_an_arc_that_bends_little_are_near(intervals: int, seed: int, amplitude: float) -> None:
    """Schur's bound for each arc of the length that a search leaves out, on meshes down to such as arcs lie within."""
    law, s = Law.of(CONTACT, SPACING), np.linspace(0.0, LENGTH, intervals + 1)
    nodes = curve_of(tangents(s, seed, amplitude), s[1])
    points = contact_points(CONTACT, ROD, s)
    place_points(points, nodes, np.zeros_like(nodes))
    arc = straight_arc(nodes, BENT * harmless_bending(CONTACT.cutoff, law)) * s[1]
    near = {pair for pair, d in distances(points).items() if d < CONTACT.cutoff}
    assert all((b - a) * points.spacing > arc for a, b in near)


def ring(closing: float) -> Points:
    """Contact points of a rod of one turn that lacks `closing` (m) of a ring."""
    radius = (LENGTH + closing) / (2 * pi)
    points = contact_points(CONTACT, ROD, S, closing)
    circle = radius * np.column_stack([np.cos(S / radius), np.sin(S / radius), 0.0 * S])
    place_points(points, circle, np.zeros_like(circle))
    return points


@pytest.mark.parametrize("closing", [0.0, 0.3 * SKIP])
def test_where_a_ring_meets_itself_its_ends_are_neighbours(closing: float) -> None:
    points = ring(closing)
    pairs = found_by(points, 1.5 * SKIP)
    around = LENGTH + closing - (pairs.second - pairs.first)[: pairs.counts[0]] * points.spacing
    assert pairs.counts[0] > 0
    assert around.min() >= SKIP * (1.0 - 1e-9)
    assert smallest_distance(points, SKIP, inf, 0.5) > 0.9 * SKIP - float(points.diameter.max())
