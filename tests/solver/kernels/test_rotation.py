"""Rotations: the exponential map, its tangent, its inverse, and changes of frame."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from scipy.linalg import expm
from scipy.spatial.transform import Rotation

from solver.arrays import Array
from solver.kernels.rotation import (
    any_jacobian,
    jacobian_series,
    matrix_of,
    quaternion_of,
    relative_rotation,
    right_jacobian,
    rotate,
    rotate_back,
    tangents_of,
    turn,
)

ANGLES = [0.0, 1e-12, 1e-6, 0.99e-4, 1.01e-4, 9e-3, 1.1e-2, 0.5, 2.0, 3.1, 6.0]
"""On both sides of where the kernels change from series to closed formulas."""


def cross_matrix(x: Array) -> Array:
    return np.array([[0.0, -x[2], x[1]], [x[2], 0.0, -x[0]], [-x[1], x[0], 0.0]])


def matrix(quaternion: Array) -> Array:
    R = np.empty((3, 3))
    matrix_of(quaternion, R)
    return R


def turned(quaternion: Array, theta: Array) -> Array:
    new = np.empty(4)
    turn(quaternion, theta, new)
    return new


def rotation_between(left: Array, right: Array) -> Array:
    theta = np.empty(3)
    relative_rotation(left, right, theta)
    return theta


def random_quaternions(n: int, seed: int = 0) -> Array:
    q = np.random.default_rng(seed).normal(size=(n, 4))
    return np.asarray(q / np.linalg.norm(q, axis=1)[:, None], dtype=float)


def vectors_of_length(angle: float, n: int = 5) -> Array:
    x = np.random.default_rng(1).normal(size=(n, 3))
    return np.asarray(angle * x / np.linalg.norm(x, axis=1)[:, None], dtype=float)


def test_the_matrix_of_a_quaternion_is_scipys() -> None:
    for q in random_quaternions(10):
        assert_allclose(matrix(q), Rotation.from_quat(q, scalar_first=True).as_matrix(), atol=1e-15)


@pytest.mark.parametrize("angle", ANGLES)
def test_turn_is_the_exponential_of_a_material_rotation(angle: float) -> None:
    for q, theta in zip(random_quaternions(5), vectors_of_length(angle), strict=True):
        # expm itself is good to some 1e-15; it is the reference
        assert_allclose(matrix(turned(q, theta)), matrix(q) @ expm(cross_matrix(theta)), atol=1e-14)


def test_turn_keeps_unit_length_over_many_turns() -> None:
    q, theta = random_quaternions(1)[0], np.array([0.3, -0.2, 0.1])
    for _ in range(1000):
        q = turned(q, theta)
    assert np.linalg.norm(q) == pytest.approx(1.0, abs=1e-15)


def jacobian(theta: Array) -> Array:
    """J_r (3, 3) of a rotation vector, by the series or not as the solver does it."""
    square = float(theta @ theta)
    first, second = jacobian_series(square) if square < 1.0 else any_jacobian(square)
    return np.array(right_jacobian(*theta, first, second)).reshape(3, 3)


@pytest.mark.parametrize("angle", ANGLES)
def test_the_right_jacobian_is_the_derivative_of_turn(angle: float) -> None:
    step = 1e-5
    for theta in vectors_of_length(angle):
        J = 2.0 * jacobian(theta)
        start = expm(cross_matrix(theta))
        for k in range(3):
            change = np.zeros(3)
            change[k] = step
            difference = expm(cross_matrix(theta + change)) - expm(cross_matrix(theta - change))
            psi = start.T @ difference / (2 * step)
            # the central difference is off by step^2 / 6 = 2e-11 and 1e-15 / step = 1e-10
            assert_allclose(2.0 * np.array([psi[2, 1], psi[0, 2], psi[1, 0]]), J[:, k], atol=1e-9)


def test_the_right_jacobian_has_no_seam() -> None:
    direction = vectors_of_length(1.0, 1)[0]
    assert_allclose(jacobian(direction * (1 + 1e-15)), jacobian(direction * (1 - 1e-15)), atol=1e-14)


@given(
    theta=st.tuples(*[st.floats(-1.0, 1.0)] * 3),
    angle=st.floats(1e-9, pi - 1e-6),
    seed=st.integers(0, 1000),
    sign=st.sampled_from([1.0, -1.0]),
)
@settings(max_examples=200, deadline=None)
def test_relative_rotation_undoes_turn(
    theta: tuple[float, float, float], angle: float, seed: int, sign: float
) -> None:
    axis = np.array(theta) + 1e-3
    vector = angle * axis / np.linalg.norm(axis)
    q = random_quaternions(1, seed)[0]
    # the quaternion's components are good to a few 1e-16, and half the angle is what they hold
    assert_allclose(rotation_between(q, sign * turned(q, vector)), vector, rtol=0.0, atol=5e-15)


def test_relative_rotation_takes_the_shorter_way() -> None:
    q, long = random_quaternions(1)[0], np.array([0.0, 0.0, pi + 0.5])
    assert_allclose(rotation_between(q, turned(q, long)), [0.0, 0.0, 0.5 - pi], atol=1e-14)


def test_equal_orientations_have_no_relative_rotation() -> None:
    q = random_quaternions(1)[0]
    assert_allclose(rotation_between(q, q), 0.0, atol=1e-16)
    assert_allclose(rotation_between(q, -q), 0.0, atol=1e-16)


def test_tangents_are_a3_in_the_lab_frame() -> None:
    quaternions = random_quaternions(8)
    T = np.empty((8, 3))
    tangents_of(quaternions, T)
    assert_allclose(T, [matrix(q)[:, 2] for q in quaternions], atol=1e-15)


def test_rotate_takes_material_vectors_to_the_lab_and_rotate_back_returns_them() -> None:
    quaternions, vectors = random_quaternions(8), np.random.default_rng(2).normal(size=(8, 3))
    lab = rotate(quaternions, vectors)
    assert_allclose(lab, [matrix(q) @ x for q, x in zip(quaternions, vectors, strict=True)], atol=1e-15)
    assert_allclose(rotate_back(quaternions, lab), vectors, atol=2e-15)


def test_rotate_leaves_its_arguments_alone() -> None:
    quaternions, vectors = random_quaternions(3), np.ones((3, 3))
    rotate(quaternions, vectors)
    rotate_back(quaternions, vectors)
    assert_allclose(vectors, 1.0, rtol=0)


def test_the_quaternions_of_a_turning_frame_are_continuous() -> None:
    angles = np.linspace(0.0, 6 * pi, 100)
    R = Rotation.from_rotvec(np.outer(angles, [0.6, 0.0, 0.8])).as_matrix()
    quaternions = quaternion_of(R)
    assert quaternions[0, 0] >= 0
    assert np.all(np.sum(quaternions[1:] * quaternions[:-1], axis=1) > 0.9)
    assert_allclose([matrix(q) for q in quaternions], R, atol=1e-14)
