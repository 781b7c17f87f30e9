"""An elastic floor with friction: what rests on it, what slides on it, and its tangents."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose

from service.cases import apply_settings, build_scene, load_case, parse_case
from solver import End, Frame, Initial, Numerics, Scene, simulate
from solver.arrays import Array
from solver.kernels.kernel import kernel
from solver.physics.loads import floor
from solver.physics.loads.load import Point, energy, force, tangents
from tests.solver.methods.problem import problem
from tests.solver.methods.test_box_tangents import LARGEST_ERROR, error
from tests.solver.scenes import ROD

METHODS = ["box", "staggered"]
G, MU, STIFFNESS = 9.81, 0.3, 2000.0
MASS = float(ROD.mass(np.zeros(1))[0])


def lying(height: float, **motion: tuple[float, float, float]) -> Initial:
    return Initial.straight((0.0, 0.0, height), (1.0, 0.0, 0.0), a1=(0.0, 1.0, 0.0), **motion)


def frames(method: str, initial: Initial, given: floor.Given, t_end: float, dt: float,
           damping: float = 0.0) -> list[Frame]:  # fmt: skip
    numerics = Numerics(method=method, intervals=10, dt_max=dt, rho_inf=0.9)  # type: ignore[arg-type]
    return list(simulate(Scene(ROD, initial, End.free(), End.free(), t_end, t_end / 10, gravity=(0.0, 0.0, -G),
                               loads=(given,), numerics=numerics, damping=damping)))  # fmt: skip


@kernel
def act(load: floor.Record, at: Point):  # type: ignore[no-untyped-def]
    return force(load, 0, 0, at)[0], tangents(load, 0, 0, at), energy(load, 0, 0, at)


def at(r: Array, V: Array) -> Point:
    zero, R = (0.0, 0.0, 0.0), ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    return Point(tuple(map(float, r)), tuple(map(float, V)), zero, (0.0, 0.0, 1.0), R, zero)


def test_its_tangents_are_its_derivatives() -> None:
    load = floor.Record(True, np.array([[0.6, 0.0, 0.8]]), np.array([0.1, STIFFNESS, MU, 0.2]))
    r, V = np.array([-0.2, 0.1, 0.05]), np.array([0.3, -0.5, 0.4])
    _, by, _ = act(load, at(r, V))
    for k, e in enumerate(1e-6 * np.eye(3)):
        K = np.subtract(act(load, at(r + e, V))[0], act(load, at(r - e, V))[0]) / 2e-6
        C = np.subtract(act(load, at(r, V + e))[0], act(load, at(r, V - e))[0]) / 2e-6
        assert_allclose(np.array(by.K)[:, k], K, atol=1e-5)
        assert_allclose(np.array(by.C)[:, k], C, atol=1e-5)


def test_the_box_method_has_its_tangents() -> None:
    given = floor.Given(40.0, 0.01, (0.1, 0.2, 1.0), friction=0.4, slip=0.5)
    assert error(problem(12, others=(given,))) <= LARGEST_ERROR  # type: ignore[arg-type]


@pytest.mark.parametrize("method", METHODS)
def test_a_rod_comes_to_rest_where_the_floor_bears_its_weight(method: str) -> None:
    last = frames(method, lying(0.0), floor.Given(STIFFNESS), 2.0, 0.02, damping=8.0)[-1]
    assert_allclose(last.r[:, 2], -MASS * G / STIFFNESS, rtol=1e-3)


@pytest.mark.parametrize("method", METHODS)
def test_a_rod_that_slides_is_stopped_by_friction_which_takes_its_energy(method: str) -> None:
    sunk = -MASS * G / STIFFNESS
    speed, slip = 0.5, 1e-3
    thrown = lying(sunk, velocity=(0.0, speed, 0.0))
    early, *_, last = frames(method, thrown, floor.Given(STIFFNESS, friction=MU, slip=slip), 0.4, 0.002)
    assert early.energy_kinetic == pytest.approx(0.5 * MASS * speed**2, rel=1e-3)
    assert np.abs(last.v).max() < 2.0 * slip
    # it slides v^2 / (2 mu g), but for the slip at its end
    assert last.r[:, 1].mean() == pytest.approx(speed**2 / (2.0 * MU * G), rel=0.02)
    assert last.dissipation == pytest.approx(early.energy_kinetic, rel=5e-3)
    assert abs(last.energy_balance) < 5e-3 * early.energy_kinetic


def test_a_case_has_a_floor() -> None:
    given = {"stiffness": 50.0, "height": -0.2, "friction": 0.1}
    raw = apply_settings(load_case("free-flight"), {"loads.floor": given})
    assert build_scene(parse_case(raw)).loads == (floor.Given(50.0, -0.2, (0.0, 0.0, 1.0), 0.1, 1e-3),)


def test_a_second_floor_is_refused() -> None:
    floors = (floor.Given(STIFFNESS), floor.Given(STIFFNESS, normal=(1.0, 0.0, 0.0)))
    with pytest.raises(ValueError, match="one floor at the most, got 2"):
        simulate(Scene(ROD, lying(0.1), End.free(), End.free(), 1.0, 1.0, loads=floors))
