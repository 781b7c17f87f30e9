"""The contact force of a pair: its law, and its tangents against finite differences."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from solver.arrays import Array
from solver.physics.contact.law import LINEAR_BELOW, PAPER_SPACING, TAPER, Law, pair_force
from solver.physics.contact.points import Points, unsearched
from solver.scene.contact import Contact

D, MASS = 0.01, 0.12
CONTACT = Contact(k1=1e-6, k2=3.0, k3=0.02, k4=1.0, aperture=1.0, cutoff=0.05, skip=0.04, spacing=1e-3)
LAW = Law.of(CONTACT, CONTACT.spacing)
AXIS = np.array([0.48, 0.6, 0.64])
"""Unit vector from b to a."""
ACROSS = np.array([0.8, -0.6, 0.0]) / np.linalg.norm([0.8, -0.6, 0.0])


def two_points(d: float, tilt_a: float = 0.1, tilt_b: float = -0.2, closing: float = 0.0) -> Points:
    """A pair d apart; the tilts are the sines of the tangents out of the plane across the separation."""
    normal = ACROSS - (ACROSS @ AXIS) * AXIS
    normal /= np.linalg.norm(normal)
    other = np.cross(AXIS, normal)
    p = np.array([d * AXIS, np.zeros(3)]) + np.array([1.0, 2.0, 3.0])
    t = np.array([np.sqrt(1 - tilt_a**2) * normal + tilt_a * AXIS, np.sqrt(1 - tilt_b**2) * other + tilt_b * AXIS])
    w = np.array([-0.5 * closing * AXIS + 0.3 * other, 0.5 * closing * AXIS - 0.1 * normal])
    return Points(
        np.zeros(2, np.int64), np.zeros((2, 4)), np.zeros((2, 4)), np.full(2, MASS), np.full(2, D), 1e-3,
        p, t, w, *np.zeros((2, 2, 3)), *unsearched(2),
    )  # fmt: skip


def force(points: Points, law: Law = LAW) -> Array:
    """Force on point 0 from point 1."""
    n, G, k = np.zeros(3), np.zeros((3, 3)), np.zeros(3)
    elastic, damping, _ = pair_force(law, points, 0, 1, n, G, k)
    return np.asarray((elastic + damping) * n, dtype=float)


def elastic_force(d: float, law: Law = LAW) -> float:
    return float(pair_force(law, two_points(d, 0.0, 0.0), 0, 1, np.zeros(3), np.zeros(3), np.zeros(3))[0])


def damping_force(points: Points, law: Law = LAW) -> float:
    return float(pair_force(law, points, 0, 1, np.zeros(3), np.zeros(3), np.zeros(3))[1])


def test_the_force_is_equation_6_where_nothing_fades_it() -> None:
    """rho_c A k1 / (d - D/2)^k2, on a grid of 1 mm: a density, times the 1 mm that a grid point stands for."""
    d = 0.02
    assert elastic_force(d) == pytest.approx(1e-3 * MASS * 1e-6 / (d - D / 2) ** 3, rel=1e-12)
    moving = two_points(d, 0.0, 0.0, closing=0.7)
    assert damping_force(moving) == pytest.approx(1e-3 * MASS * 0.02 / d * 0.7**2, rel=1e-12)


def test_the_gap_is_told_where_there_is_a_force() -> None:
    for d, gap in ((0.02, 0.015), (0.003, -0.002), (0.2, 0.0)):
        told = pair_force(LAW, two_points(d), 0, 1, np.zeros(3), np.zeros(3), np.zeros(3))[2]
        assert told == pytest.approx(gap, rel=1e-12)


CASES = {
    "near": (0.02, 0.1, -0.2, 0.5),
    "opening": (0.02, 0.1, -0.2, -0.5),
    "at rest": (0.02, 0.1, -0.2, 0.0),
    "fading with distance": (0.042, 0.1, -0.2, 0.5),
    "fading at the aperture": (0.02, 0.4, -0.45, 0.5),
    "fading at both": (0.045, 0.4, -0.2, -0.5),
    "linear": (0.006, 0.1, -0.2, 0.5),
    "overlapping": (0.003, 0.1, -0.2, 0.5),
}


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("k4", [0.0, 1.0, 2.0])
def test_the_tangents_are_the_derivatives_of_the_force(name: str, k4: float) -> None:
    law = Law.of(replace(CONTACT, k4=k4), CONTACT.spacing)
    d = CASES[name][0]
    points = two_points(*CASES[name])
    n, g, k = np.zeros(3), np.zeros(3), np.zeros(3)
    elastic, damping, _ = pair_force(law, points, 0, 1, n, g, k)
    nn, G = np.outer(n, n), np.outer(n, g) + (elastic + damping) / d * np.eye(3)
    # the force's scale of length is the gap or a tenth of the cutoff, that of its other arguments 0.1; a relative
    # step of 1e-5 leaves 1e-10 of the truncation, and 1e-11 of rounding
    length = min(abs(d - D / 2) + LINEAR_BELOW * D, 0.1 * LAW.cutoff)
    size = np.linalg.norm(force(points, law))
    for arrays, tangent in ((points.p, G), (points.t, k[0] * nn), (points.w, k[2] * nn)):
        scale = length if arrays is points.p else 0.1
        for c in range(3):
            before = arrays[0, c]
            arrays[0, c] = before + 1e-5 * scale
            ahead = force(points, law)
            arrays[0, c] = before - 1e-5 * scale
            behind = force(points, law)
            arrays[0, c] = before
            tolerance = 1e-7 * (size + np.abs(scale * tangent).max())
            assert_allclose((ahead - behind) / 2e-5, scale * tangent[:, c], atol=tolerance)
    turned = points.t[1].copy()
    for c in range(3):
        points.t[1] = turned + 1e-6 * np.eye(3)[c]
        ahead = force(points, law)
        points.t[1] = turned - 1e-6 * np.eye(3)[c]
        behind = force(points, law)
        points.t[1] = turned
        assert_allclose((ahead - behind) / 2e-6, k[1] * nn[:, c], atol=1e-7 * (size + abs(k[1])))


@pytest.mark.parametrize("name", CASES)
def test_action_is_reaction(name: str) -> None:
    points = two_points(*CASES[name])
    n, other = np.zeros(3), np.zeros(3)
    on_a = pair_force(LAW, points, 0, 1, n, np.zeros(3), np.zeros(3))
    on_b = pair_force(LAW, points, 1, 0, other, np.zeros(3), np.zeros(3))
    assert_allclose(n, -other, rtol=0)
    assert_allclose(on_a, on_b, rtol=1e-14)


def test_the_force_and_its_slope_vanish_at_the_cutoff() -> None:
    near = LAW.cutoff * (1 - np.array([1e-3, 1e-4, 1e-5]))
    forces = np.array([elastic_force(float(d)) for d in near])
    assert np.all(forces > 0)
    # smoothstep: a quadratic end
    assert_allclose(forces[1:] / forces[:-1], 1e-2, rtol=0.02)
    assert elastic_force(LAW.cutoff * (1 + 1e-12)) == 0.0
    assert elastic_force(2 * LAW.cutoff) == 0.0


def test_the_force_fades_over_the_outer_part_of_the_cutoff_only() -> None:
    inner = (1 - TAPER) * LAW.cutoff
    unfaded = 1e-3 * MASS * 1e-6 / (inner - D / 2) ** 3
    assert elastic_force(inner) == pytest.approx(unfaded, rel=1e-9)
    middle = (1 - TAPER / 2) * LAW.cutoff
    assert elastic_force(middle) == pytest.approx(0.5 * 1e-3 * MASS * 1e-6 / (middle - D / 2) ** 3, rel=1e-9)


def test_points_beyond_each_others_aperture_do_not_press() -> None:
    edge = LAW.sine
    assert_allclose(force(two_points(0.02, edge + 1e-9, 0.0)), 0.0, atol=0.0)
    assert_allclose(force(two_points(0.02, 0.0, -edge - 1e-9)), 0.0, atol=0.0)
    whole = np.linalg.norm(force(two_points(0.02, 0.0, 0.0)))
    # at the edge 1 - c^2/sine^2 = 2e-6, and smoothstep makes 3 x^2 of it
    assert 0 < np.linalg.norm(force(two_points(0.02, edge * (1 - 1e-6), 0.0))) < 13e-12 * whole


def test_a_wide_open_aperture_lets_every_direction_press() -> None:
    law = Law.of(replace(CONTACT, aperture=np.pi), CONTACT.spacing)
    assert np.linalg.norm(force(two_points(0.02, 0.95, -0.9), law)) > 0


def test_damping_opposes_the_motion_whichever_way_it_goes() -> None:
    for closing in (-2.0, -0.1, 0.1, 2.0):
        damping = damping_force(two_points(0.02, closing=closing))
        assert damping * closing > 0, "approaching: pushed apart; parting: held back"
    assert damping_force(two_points(0.02, closing=0.0)) == pytest.approx(0.0, abs=1e-30)


@pytest.mark.parametrize("name", CASES)
def test_damping_never_feeds_the_pair(name: str) -> None:
    points = two_points(*CASES[name])
    n = np.zeros(3)
    damping = pair_force(LAW, points, 0, 1, n, np.zeros(3), np.zeros(3))[1]
    assert damping * float(n @ (points.w[0] - points.w[1])) <= 0


def test_below_a_small_gap_the_force_goes_on_linearly() -> None:
    floor = D / 2 + LINEAR_BELOW * D
    below = np.linspace(0.1 * D, floor, 12)
    forces = np.array([elastic_force(float(d)) for d in below])
    assert_allclose(np.diff(forces, 2), 0.0, atol=1e-12 * forces.max())
    step = 4e-6 * LINEAR_BELOW * D
    just_above = (elastic_force(floor + step) - elastic_force(floor)) / step
    just_below = (elastic_force(floor) - elastic_force(floor - step)) / step
    # the slope changes by some k2 + 1 times the step over the gap
    assert just_above == pytest.approx(just_below, rel=1e-4)


def test_the_force_stays_finite_and_repulsive_down_to_a_touch_of_the_centrelines() -> None:
    forces = [elastic_force(d) for d in (0.5 * D, 0.25 * D, 1e-3 * D, 1e-9 * D)]
    assert np.all(np.diff(forces) > 0)
    assert np.isfinite(forces).all()


def line_density(spacing: float, kind: str) -> float:
    """Force per length on a strand from a parallel one 0.02 m away, whose points are `spacing` apart."""
    contact = replace(CONTACT, spacing=spacing, sum=kind)  # type: ignore[arg-type]
    law = Law.of(contact, spacing)
    along = spacing * (np.arange(-100, 101) + 0.3)
    p = np.vstack([[0.02, 0.0, 0.0], np.column_stack([np.zeros_like(along), np.zeros_like(along), along])])
    M = len(p)
    t = np.tile([0.0, 0.0, 1.0], (M, 1))
    points = Points(
        np.zeros(M, np.int64), np.zeros((M, 4)), np.zeros((M, 4)), np.full(M, MASS), np.full(M, D), spacing,
        p, t, *np.zeros((3, M, 3)), *unsearched(M),
    )  # fmt: skip
    total = 0.0
    for b in range(1, M):
        n = np.zeros(3)
        elastic, _, _ = pair_force(law, points, 0, b, n, np.zeros(3), np.zeros(3))
        total += elastic * float(n[0])
    return total / spacing


def test_the_force_per_length_does_not_depend_on_the_spacing() -> None:
    densities = [line_density(spacing, "density") for spacing in (2e-3, 1e-3, 5e-4)]
    # the sum over b is a quadrature of a C1 function that is 0.02 m wide: good to (spacing / width)^2 or better
    assert densities[0] == pytest.approx(densities[2], rel=1e-2)
    assert densities[1] == pytest.approx(densities[2], rel=2.5e-3)


def test_the_sum_over_grid_points_grows_as_the_grid_is_refined_and_agrees_at_the_papers() -> None:
    assert line_density(PAPER_SPACING, "grid_points") == pytest.approx(line_density(PAPER_SPACING, "density"))
    ratio = line_density(5e-4, "grid_points") / line_density(1e-3, "grid_points")
    assert ratio == pytest.approx(2.0, rel=1e-2)


def test_uneven_strands_press_with_their_mean_mass_and_diameter() -> None:
    points = two_points(0.02, 0.0, 0.0)
    points.mass[:] = 0.1, 0.3
    points.diameter[:] = 0.008, 0.012
    assert np.linalg.norm(force(points)) == pytest.approx(1e-3 * 0.2 * 1e-6 / (0.02 - 0.005) ** 3, rel=1e-12)
