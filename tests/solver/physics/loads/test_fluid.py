"""Morison's forces: values, tangents against finite differences, and what becomes of their power."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from scipy.spatial.transform import Rotation

from solver import End, Initial, Scene
from solver.arrays import Array
from solver.kernels.kernel import kernel
from solver.methods.space.segments.balances import Motion
from solver.physics.loads import added_mass as mass_law
from solver.physics.loads import drag as drag_law
from solver.physics.loads.applied import AppliedLoads
from solver.physics.loads.load import Point, add_powers, force, tangents
from solver.physics.loads.registry import Loads
from solver.physics.section import sample
from tests.solver.scenes import ROD

NORMAL, TANGENTIAL, MASS = 6.0, 0.4, 3.0
R0 = Rotation.from_rotvec([0.4, -0.8, 0.3])
SPEEDS = [(0.3, -0.5, 0.8), (-2.0, 1.0, 0.1), (1e-3, 0.0, 2e-3), (0.0, 0.0, -1.0)]


def tangent(psi: Array) -> Array:
    """T after a small material rotation psi from R0."""
    return np.asarray((R0 * Rotation.from_rotvec(psi)).as_matrix()[:, 2].copy(), dtype=float)


def tangent_by_rotation() -> Array:
    """dT/d psi = -R [a3]."""
    R = R0.as_matrix()
    return np.column_stack([-R[:, 1], R[:, 0], np.zeros(3)])


NONE = np.zeros((1, 3))
DRAG = drag_law.Record(True, np.array([NORMAL]), np.array([TANGENTIAL]), NONE, np.zeros((1, 2)))
CREEPING = DRAG._replace(creeping=np.array([[2.5, 1.4]]))
ADDED_MASS = mass_law.Record(True, np.array([MASS]), NONE)


def frame(T: Array) -> Array:
    """A rotation (3, 3) with the tangent T."""
    across = np.cross(T, R0.as_matrix()[:, 0])
    across /= np.linalg.norm(across)
    return np.column_stack([np.cross(across, T), across, T])


def point(V: Array, A: Array, T: Array, omega: Array | None = None) -> Point:
    """A point whose frame has the tangent T."""
    R = frame(T)
    turn = np.zeros(3) if omega is None else omega
    return Point((0.0, 0.0, 0.0), *(tuple(map(float, x)) for x in (V, A, T)), tuple(map(tuple, R.tolist())),
                 tuple(map(float, turn)))  # fmt: skip


@kernel
def act(load: Any, at: Point) -> Any:
    """A load's force at a point, and its tangents."""
    return force(load, 0, 0, at)[0], tangents(load, 0, 0, at)


def drag(u: Array, T: Array, load: drag_law.Record = DRAG) -> tuple[Array, Array, Array]:
    """The force against the motion, and its derivatives by the velocity and by a rotation from R0."""
    at = point(u, np.zeros(3), T)
    lab, by = act(load, at)
    return -np.array(lab), -np.array(by.C), -np.array(by.by_T) @ tangent_by_rotation()


def added_mass(acceleration: Array, T: Array, c0: float = 1.0) -> tuple[Array, Array, Array]:
    load, at = ADDED_MASS, point(np.zeros(3), acceleration, T)
    lab, by = act(load, at)
    return (-np.array(lab), -c0 * np.array(by.M),
            -np.array(by.by_T) @ tangent_by_rotation())  # fmt: skip


def by_differences(force: object, at: Array, step: float) -> Array:
    assert callable(force)
    columns = [(force(at + step * e) - force(at - step * e)) / (2 * step) for e in np.eye(3)]
    return np.column_stack(columns)


def test_drag_across_is_half_rho_d_cd_times_the_square_of_the_speed() -> None:
    T = tangent(np.zeros(3))
    across = R0.as_matrix()[:, 0]
    assert_allclose(drag(2.0 * across, T)[0], NORMAL * 4.0 * across, atol=1e-14)
    assert_allclose(drag(-2.0 * across, T)[0], -NORMAL * 4.0 * across, atol=1e-14)


def test_drag_along_is_half_rho_pi_d_ct_times_the_square_of_the_speed() -> None:
    T = tangent(np.zeros(3))
    assert_allclose(drag(3.0 * T, T)[0], TANGENTIAL * 9.0 * T, atol=1e-14)
    assert_allclose(drag(-3.0 * T, T)[0], -TANGENTIAL * 9.0 * T, atol=1e-14)


def test_still_water_exerts_nothing_on_a_rod_at_rest() -> None:
    for array in drag(np.zeros(3), tangent(np.zeros(3))):
        assert_allclose(array, 0.0, atol=0.0)


@pytest.mark.parametrize("load", [DRAG, CREEPING], ids=["Morison", "creeping"])
@pytest.mark.parametrize("u", SPEEDS)
def test_the_tangents_of_drag_are_its_derivatives(u: tuple[float, float, float], load: drag_law.Record) -> None:
    velocity, still = np.array(u), np.zeros(3)
    _, P_V, P_w = drag(velocity, tangent(still), load)
    speed = float(np.linalg.norm(velocity))
    # third derivatives of |u| u are some 1 / |u|: with a step of 1e-4 |u| the differences are good to 1e-8 |u|
    tolerance = 1e-7 * NORMAL * speed
    if np.linalg.norm(np.cross(velocity, tangent(still))) > 1e-3 * speed:
        difference = by_differences(lambda x: drag(x, tangent(still), load)[0], velocity, 1e-4 * speed)
        assert_allclose(P_V, difference, atol=tolerance)
    difference = by_differences(lambda psi: drag(velocity, tangent(psi), load)[0], still, 1e-4)
    assert_allclose(P_w, difference, atol=tolerance * speed)


def test_the_tangents_of_the_added_mass_are_its_derivatives() -> None:
    acceleration, still, c0 = np.array([0.7, -1.2, 0.4]), np.zeros(3), 7.0
    _, P_V, P_w = added_mass(acceleration, tangent(still), c0)
    # linear in the acceleration; quadratic in T: a step of 1e-4 leaves 1e-8
    by_velocity = c0 * by_differences(lambda a: added_mass(a, tangent(still))[0], acceleration, 0.1)
    assert_allclose(P_V, by_velocity, atol=1e-12)
    assert_allclose(P_w, by_differences(lambda psi: added_mass(acceleration, tangent(psi))[0], still, 1e-4), atol=1e-6)


def test_added_mass_resists_only_the_acceleration_across() -> None:
    T, across = tangent(np.zeros(3)), R0.as_matrix()[:, 1]
    assert_allclose(added_mass(5.0 * T, T)[0], 0.0, atol=1e-14)
    assert_allclose(added_mass(2.0 * across + 5.0 * T, T)[0], MASS * 2.0 * across, atol=1e-13)


@given(st.tuples(*[st.floats(-5.0, 5.0)] * 3))
@settings(deadline=None)
def test_drag_never_feeds_the_motion(u: tuple[float, float, float]) -> None:
    velocity, T = np.array(u), tangent(np.zeros(3))
    assert float(drag(velocity, T)[0] @ velocity) >= -1e-15


def fluid_power(mass: float, normal: float, tangential: float, V: Array, current: Array, A: Array, T: Array,
                T_t: Array) -> tuple[float, float]:  # fmt: skip
    """What the current gives to one point, and what the fluid takes for good."""
    R, alone = frame(T), Scene(ROD, Initial.straight(), End.clamp(), End.free(), 1.0, 1.0)
    absent = AppliedLoads(alone, sample(ROD, np.array([0.0, 1.0])), np.array([0.0, 1.0])).records
    turning = R.T @ T_t  # = omega x a3
    omega = np.array([-turning[1], turning[0], 0.0])
    morison = DRAG._replace(normal=np.array([normal]), tangential=np.array([tangential]), current=current[None])
    loads = absent._replace(drag=morison, added_mass=mass_law.Record(mass > 0.0, np.array([mass]), current[None]))
    motion = Motion(np.zeros((1, 3)), V[None], A[None], np.stack([R] * 3), np.stack([omega] * 3))
    powers = np.zeros(2)
    sum_powers(loads, motion, powers)
    return float(powers[0]), float(powers[1])


@kernel
def sum_powers(loads: Loads, motion: Motion, powers: Array) -> None:
    add_powers(loads, 0, motion, powers)


@given(st.tuples(*[st.floats(-5.0, 5.0)] * 3))
@settings(deadline=None)
def test_in_still_water_drag_dissipates_all_of_its_power(u: tuple[float, float, float]) -> None:
    velocity, T, none = np.array(u), tangent(np.zeros(3)), np.zeros(3)
    given_, lost = fluid_power(0.0, NORMAL, TANGENTIAL, velocity, none, none, T, none)
    assert given_ == 0.0
    assert lost == pytest.approx(float(drag(velocity, T)[0] @ velocity), rel=1e-12, abs=1e-12)


def test_the_fluids_power_is_accounted_for() -> None:
    """Power of the force = given by the current - lost - d/dt of 1/2 Ca rho_w A |u_n|^2, along any motion."""
    current = np.array([0.2, -0.1, 0.4])
    step = 1e-5

    def velocity(t: float) -> Array:
        return np.array([np.sin(t), 0.5 + t**2, np.cos(2 * t)])

    def direction(t: float) -> Array:
        return tangent(np.array([0.7 * t, np.sin(t), 0.0]))

    def stored(t: float) -> float:
        u, T = velocity(t) - current, direction(t)
        across = u - (u @ T) * T
        return float(0.5 * MASS * across @ across)

    t = 0.8
    acceleration = (velocity(t + step) - velocity(t - step)) / (2 * step)
    T, T_t = direction(t), (direction(t + step) - direction(t - step)) / (2 * step)
    force = -drag(velocity(t) - current, T)[0] - added_mass(acceleration, T)[0]
    given_, lost = fluid_power(MASS, NORMAL, TANGENTIAL, velocity(t), current, acceleration, T, T_t)
    rate = (stored(t + step) - stored(t - step)) / (2 * step)
    # differences with a step of 1e-5 of functions of size 10: 1e-9
    assert float(force @ velocity(t)) == pytest.approx(given_ - lost - rate, abs=1e-8)
