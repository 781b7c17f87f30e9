"""The rod at t = 0: curvature, twist and frames from a centreline."""

from __future__ import annotations

from math import cos, pi, sin, sqrt

import numpy as np
import pytest
from numpy.testing import assert_allclose

from solver.arrays import Array
from solver.kernels.rotation import rotate
from solver.scene.curve import Curve
from solver.scene.initial import Initial, arclength_spline
from solver.scene.layout import nodes_at_rest

RADIUS, PITCH = 0.2, 0.1
"""Of a helix, m and m per radian: curvature R / (R^2 + p^2), torsion p / (R^2 + p^2)."""
SLANT = sqrt(RADIUS**2 + PITCH**2)
CURVATURE, TORSION = RADIUS / SLANT**2, PITCH / SLANT**2
LENGTH = 1.5


def helix(s: Array) -> Array:
    phase = s / SLANT
    return np.column_stack([RADIUS * np.cos(phase), RADIUS * np.sin(phase), PITCH * phase])


def frames(quaternion: Array) -> Array:
    """(n, 3, 3): a1, a2, a3 as rows, lab."""
    return np.stack([rotate(quaternion, np.tile(axis, (len(quaternion), 1))) for axis in np.eye(3)], axis=1)


@pytest.fixture
def s() -> Array:
    return np.linspace(0.0, LENGTH, 41)


def test_a_straight_rod_is_straight_and_untwisted(s: Array) -> None:
    r, quaternion, kappa = nodes_at_rest(Initial.straight(direction=(0.0, 1.0, 1.0)), s)
    assert_allclose(r, np.outer(s, [0.0, sqrt(0.5), sqrt(0.5)]), atol=1e-15)
    assert_allclose(frames(quaternion)[:, 2], np.tile([0.0, sqrt(0.5), sqrt(0.5)], (41, 1)), atol=1e-12)
    assert_allclose(frames(quaternion)[:, 0], np.tile([1.0, 0.0, 0.0], (41, 1)), atol=1e-12)
    assert_allclose(kappa, 0.0, atol=1e-9)


def test_the_frames_are_orthonormal_and_follow_the_tangent(s: Array) -> None:
    _, quaternion, _ = nodes_at_rest(Initial(helix), s)
    assert_allclose(np.linalg.norm(quaternion, axis=1), 1.0, atol=1e-15)
    x, y, _ = helix(s).T
    tangent = np.column_stack([-y, x, np.full_like(s, PITCH)]) / SLANT
    # differences of order 6 over ds = LENGTH / 1280 have tangents good to their rounding
    assert_allclose(frames(quaternion)[:, 2], tangent, atol=(LENGTH / 320 / SLANT) ** 3)


def test_a_helix_has_its_curvature_and_by_parallel_transport_no_twist(s: Array) -> None:
    _, _, kappa = nodes_at_rest(Initial(helix), s)
    assert_allclose(np.hypot(kappa[:, 0], kappa[:, 1]), CURVATURE, rtol=1e-9)
    assert_allclose(kappa[:, 2], 0.0, atol=1e-12)


def test_the_curvature_of_a_helix_turns_about_a_transported_frame_by_its_torsion(s: Array) -> None:
    _, _, kappa = nodes_at_rest(Initial(helix), s)
    angle = np.unwrap(np.arctan2(kappa[:, 1], kappa[:, 0]))
    assert_allclose(angle - angle[0], TORSION * s, atol=1e-3)


def test_a_frame_twisted_by_the_torsion_sees_a_constant_curvature(s: Array) -> None:
    twist = Curve.table([0.0, LENGTH], [0.0, TORSION * LENGTH])
    _, _, kappa = nodes_at_rest(Initial(helix, twist=twist), s)
    assert_allclose(kappa[:, 2], TORSION, rtol=1e-10)
    assert_allclose(kappa, np.tile(kappa[20], (41, 1)), atol=2e-3 * CURVATURE)


def test_the_first_axis_is_a1_made_normal_to_the_tangent() -> None:
    s = np.linspace(0.0, 1.0, 5)
    _, quaternion, _ = nodes_at_rest(Initial.straight(a1=(0.0, 2.0, 5.0)), s)
    assert_allclose(frames(quaternion)[0, 0], [0.0, 1.0, 0.0], atol=1e-14)


@pytest.mark.parametrize("direction", [(1.0, 0.0, 0.0), (-3.0, 0.0, 0.0)])
def test_where_no_first_axis_is_given_a_rod_along_e1_has_e2(direction: tuple[float, float, float]) -> None:
    _, quaternion, _ = nodes_at_rest(Initial.straight(direction=direction), np.linspace(0.0, 1.0, 5))
    assert_allclose(frames(quaternion)[0, 0], [0.0, 1.0, 0.0], atol=1e-14)


def test_the_twist_turns_the_frame_about_the_tangent() -> None:
    s = np.linspace(0.0, 1.0, 5)
    _, quaternion, kappa = nodes_at_rest(Initial.straight(twist=Curve.table([0.0, 1.0], [0.3, 2.3])), s)
    assert_allclose(frames(quaternion)[0, 0], [cos(0.3), sin(0.3), 0.0], atol=1e-12)
    assert_allclose(frames(quaternion)[4, 0], [cos(2.3), sin(2.3), 0.0], atol=1e-12)
    assert_allclose(kappa, np.tile([0.0, 0.0, 2.0], (5, 1)), atol=1e-9)


def test_bending_towards_a1_is_curvature_about_a2() -> None:
    def arc(s: Array) -> Array:
        return np.column_stack([1.0 - np.cos(s), np.zeros_like(s), np.sin(s)])

    s = np.linspace(0.0, 1.0, 21)
    _, _, kappa = nodes_at_rest(Initial(arc), s)
    assert_allclose(kappa, np.tile([0.0, 1.0, 0.0], (21, 1)), atol=1e-4)


def test_the_frames_turn_from_node_to_node_by_the_curvature(s: Array) -> None:
    """R_s = R [kappa], checked in the middle of each interval to second order in ds."""
    twist = Curve.table([0.0, LENGTH], [0.0, 4.0], "smoothstep")
    _, quaternion, kappa = nodes_at_rest(Initial(helix, twist=twist), s)
    ds = s[1]
    axes = frames(quaternion)
    rates, middle = np.diff(axes, axis=0) / ds, 0.5 * (axes[1:] + axes[:-1])
    k = 0.5 * (kappa[1:] + kappa[:-1])
    # a1' = kappa3 a2 - kappa2 a3, a3' = kappa2 a1 - kappa1 a2
    size = np.abs(kappa).max()
    tolerance = size * (size * ds) ** 2
    assert_allclose(rates[:, 0], k[:, 2:] * middle[:, 1] - k[:, 1:2] * middle[:, 2], atol=tolerance)
    assert_allclose(rates[:, 2], k[:, 1:2] * middle[:, 0] - k[:, :1] * middle[:, 1], atol=tolerance)


def test_a_first_axis_along_the_tangent_is_refused() -> None:
    with pytest.raises(ValueError, match=r"a1 must not be parallel to the tangent at s = 0, got \[0"):
        nodes_at_rest(Initial.straight(a1=(0.0, 0.0, 1.0)), np.linspace(0.0, 1.0, 5))


def test_points_of_any_spacing_become_a_curve_of_unit_speed() -> None:
    uneven = LENGTH * np.linspace(0.0, 1.0, 60) ** 1.3
    curve = arclength_spline(helix(uneven), LENGTH)
    fine = np.linspace(0.0, LENGTH, 500)
    step = 1e-5
    inside = fine[1:-1]
    speed = np.linalg.norm(curve(inside + step) - curve(inside - step), axis=1) / (2 * step)
    assert_allclose(speed, 1.0, atol=1e-4)
    assert_allclose(curve(fine), helix(fine), atol=1e-5)


def test_a_length_that_is_slightly_off_is_taken_up_about_the_first_point() -> None:
    points = helix(np.linspace(0.0, LENGTH, 60))
    stretched = arclength_spline(points, 1.0005 * LENGTH)
    ends = stretched(np.array([0.0, 1.0005 * LENGTH]))
    assert_allclose(ends[0], points[0], atol=1e-15)
    assert_allclose(ends[1] - ends[0], 1.0005 * (points[-1] - points[0]), rtol=1e-5, atol=1e-12)


def directions_at_its_ends(points: Array, length: float) -> Array:
    h = 1e-6 * length
    along = np.diff(arclength_spline(points, length)(np.array([0.0, h, length - h, length])), axis=0)[[0, 2]]
    return np.asarray(along / np.linalg.norm(along, axis=1)[:, None])


def test_a_ring_goes_on_where_it_began_in_the_same_direction() -> None:
    angle = np.linspace(0.0, 2.0 * pi, 13)
    begin, end = directions_at_its_ends(np.stack([np.sin(angle), 1.0 - np.cos(angle), 0.0 * angle], axis=1), 2.0 * pi)
    assert_allclose(begin, end, atol=1e-5)  # each is within 1e-6 of the length of its end
    assert_allclose(begin, [1.0, 0.0, 0.0], atol=1e-5)


def test_a_loop_with_a_corner_keeps_it() -> None:
    half = np.linspace(0.0, pi, 121)
    begin, end = directions_at_its_ends(np.stack([np.sin(half), 0.5 * np.sin(2.0 * half), 0.0 * half], axis=1), 3.04861)
    assert abs(begin @ end) < 0.1


@pytest.mark.parametrize("length", [0.99 * LENGTH, 1.01 * LENGTH])
def test_a_centreline_of_another_length_than_the_rod_is_refused(length: float) -> None:
    with pytest.raises(ValueError, match=rf"the centreline is 1\.5 m long, the rod {length:.6g} m"):
        Initial.through(helix(np.linspace(0.0, LENGTH, 60)), length)


@pytest.mark.parametrize(
    "points",
    [np.zeros((3, 3)), np.zeros((5, 2)), np.zeros(12), np.full((5, 3), np.nan)],
)
def test_points_that_are_no_curve_are_refused(points: Array) -> None:
    with pytest.raises(ValueError, match="at least 4 finite points of 3 coordinates"):
        arclength_spline(points, 1.0)


def test_a_point_given_twice_in_a_row_is_refused() -> None:
    points = helix(np.linspace(0.0, LENGTH, 10))
    points[4] = points[3]
    with pytest.raises(ValueError, match="successive points of a centreline must differ"):
        arclength_spline(points, LENGTH)


def test_a_closed_turn_of_the_twist_counts_as_a_turn(s: Array) -> None:
    _, quaternion, kappa = nodes_at_rest(Initial.straight(twist=Curve.table([0.0, LENGTH], [0.0, 2 * pi])), s)
    assert_allclose(np.trapezoid(kappa[:, 2], s), 2 * pi, rtol=1e-12)
    assert_allclose(frames(quaternion)[-1], frames(quaternion)[0], atol=1e-12)
