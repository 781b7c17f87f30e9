"""Drag in a current that depends on height and time: its tangents, what it does to a rod, and what becomes of it."""

from __future__ import annotations

from dataclasses import replace
from math import pi

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import quad, solve_ivp

from solver import Curve, End, Fluid, Frame, Initial, Numerics, Rod, Scene, Shear, VerifiedFrame, simulate
from solver.arrays import Array
from solver.physics.loads import sheared_drag
from solver.physics.loads.load import Point, Samples
from solver.physics.section import sample
from solver.run.first_mesh import first_mesh
from solver.run.trial import intervals_of
from tests.solver.physics.loads.test_fluid import act, frame
from tests.solver.scenes import DENSITY, DIAMETER, EJ, LENGTH, ROD

UP = (0.6, 0.0, 0.8)
TABLE = Shear(Curve.table([-1.0, 0.2, 1.5], [0.3, 1.0, -0.4], "pchip"), (3.0, 0.0, 4.0))
CURRENT = (0.5, -0.2, 0.1)
RATIO = 0.8
"""Of the fluid's density to that of the rod, which is across the current: it rests in it after RATE x some lengths."""
WATER = Fluid(RATIO * DENSITY, drag_normal=1.2, drag_tangential=0.1, current=CURRENT)
RATE = 0.5 * WATER.density * DIAMETER * 1.2 / (DENSITY * pi * DIAMETER**2 / 4)
"""Of a rod across the current: the relative velocity u falls by RATE u |u|, in 1/m."""


def free(fluid: Fluid, height: float, rod: Rod = ROD, method: str = "staggered", t_end: float = 2.0) -> Scene:
    """A rod along e2, free, at a height."""
    initial = Initial.straight((0.0, 0.0, height), (0.0, 1.0, 0.0))
    return Scene(rod, initial, End.free(), End.free(), t_end, 0.25, fluid=fluid,
                 numerics=Numerics(intervals=8, method=method, dt_max=0.01))  # fmt: skip


def frames_of(scene: Scene) -> list[Frame]:
    return list(simulate(scene))


def test_a_point_feels_the_current_of_its_height() -> None:
    source = sheared_drag.of(replace(free(WATER, 0.0), fluid=replace(WATER, shear=TABLE)), samples())
    for height in (-3.0, -1.0, -0.4, 0.2, 0.9, 1.5, 7.0):
        r = height * np.array(UP) + np.array([-0.8, 2.0, 0.6])
        assert_allclose(force(source.record, r, np.array(CURRENT) * TABLE.factor.value(height)), 0.0, atol=1e-12)


def samples() -> Samples:
    s = np.array([0.0, LENGTH])
    return Samples(s, sample(ROD, s), s, np.array([0.5, 0.5]), 1)


def at(r: Array, V: Array) -> Point:
    T = np.array([0.36, 0.48, 0.8])
    zero = (0.0, 0.0, 0.0)
    R = tuple(map(tuple, frame(T).tolist()))
    return Point(tuple(map(float, r)), tuple(map(float, V)), zero, tuple(T), R, zero)


def force(record: sheared_drag.Record, r: Array, V: Array) -> Array:
    return np.array(act(record, at(r, V))[0])


@pytest.mark.parametrize("height", [-2.0, -0.5, 0.9])
def test_the_tangents_are_its_derivatives(height: float) -> None:
    record = sheared_drag.of(replace(free(WATER, 0.0), fluid=replace(WATER, shear=TABLE)), samples()).record
    r, V, step = height * np.array(UP), np.array([0.2, 0.4, -0.3]), 1e-5
    by = act(record, at(r, V))[1]
    for tangent, differences in (
        (by.K, [force(record, r + step * e, V) - force(record, r - step * e, V) for e in np.eye(3)]),
        (by.C, [force(record, r, V + step * e) - force(record, r, V - step * e) for e in np.eye(3)]),
    ):
        scale = np.abs(by.C).max()
        assert_allclose(np.array(tangent), np.column_stack(differences) / (2 * step), atol=1e-7 * scale)
    assert np.abs(by.K).max() > 0.0 or height < -1.0


@pytest.mark.parametrize("method", ["staggered", "box"])
def test_a_table_of_ones_is_a_uniform_current(method: str) -> None:
    ones = Shear(Curve.table([-1.0, 1.0], [1.0, 1.0], "linear"))
    uniform, table = (frames_of(free(fluid, 0.0, method=method)) for fluid in (WATER, replace(WATER, shear=ones)))
    for one, other in zip(uniform, table, strict=True):
        # Newton's iteration ends at 1e-10 of what moves; about one axis the first has another one
        assert_allclose(one.r, other.r, atol=1e-8)
        assert one.work_loads == pytest.approx(other.work_loads, abs=1e-8)


@pytest.mark.parametrize("method", ["staggered", "box"])
@pytest.mark.parametrize(("height", "factor"), [(0.0, 1.0), (-0.5, 0.5), (-3.0, 0.0), (2.0, 1.0)])
def test_a_rod_drifts_with_the_current_of_its_height(method: str, height: float, factor: float) -> None:
    """u = U / (1 + RATE U t) across a current that sets in at once."""
    shear = Shear(Curve.table([-1.0, 0.0], [0.0, 1.0], "linear"))
    fluid = Fluid(RATIO * DENSITY, drag_normal=1.2, current=(0.4, 0.0, 0.0), shear=shear)
    *_, frame = simulate(free(fluid, height, method=method))
    U = 0.4 * factor
    allowed = 2e-5 if method == "staggered" else 2e-4  # whose steps damp what sets in at once
    assert_allclose(frame.r[:, 0], U * 2.0 - np.log1p(RATE * U * 2.0) / RATE, atol=allowed)
    assert_allclose(frame.r[:, 2], height, atol=1e-12)


def test_a_current_that_swells_takes_the_rod_along() -> None:
    """Against u' = g'(t) U - RATE u |u|; kinetic energy and what is lost are the work of the loads."""
    schedule = Curve.table([0.0, 1.5], [0.0, 1.0], "smoothstep")
    fluid = Fluid(RATIO * DENSITY, drag_normal=1.2, current=(0.4, 0.0, 0.0), schedule=schedule)

    def rates(t: float, y: Array) -> list[float]:
        u = 0.4 * schedule.value(t) - y[1]
        return [y[1], RATE * u * abs(u)]

    frames = frames_of(free(fluid, 0.0))
    exact = solve_ivp(rates, (0.0, 2.0), [0.0, 0.0], rtol=1e-10, atol=1e-12, t_eval=[frame.t for frame in frames]).y
    assert_allclose([frame.r[:, 0].mean() for frame in frames], exact[0], atol=2e-5)
    last = frames[-1]
    kinetic = 0.5 * DENSITY * pi * DIAMETER**2 / 4 * LENGTH * exact[1, -1] ** 2
    assert last.energy_kinetic == pytest.approx(kinetic, rel=1e-3)
    assert last.work_loads - last.dissipation == pytest.approx(last.energy_kinetic, rel=1e-3)


def test_a_post_on_the_sea_floor_bends_as_a_beam_does_under_the_sheared_load() -> None:
    """Small deflection of a cantilever: int q x^2 (3 L - x) / 6 EJ dx, q = 1/2 rho D Cdn (c U)^2."""
    speed = 0.003
    shear = Shear(Curve.table([0.0, 0.3, 1.0], [0.1, 0.7, 1.0], "pchip"))
    fluid = Fluid(1000.0, drag_normal=1.2, current=(speed, 0.0, 0.0), shear=shear)
    scene = Scene(ROD, Initial.straight(), End.clamp(), End.free(), 1.0, 1.0, fluid=fluid, analysis="static",
                  numerics=Numerics(intervals=64))  # fmt: skip
    *_, frame = simulate(scene)

    def bending(x: float) -> float:
        q = 500.0 * DIAMETER * 1.2 * (speed * shear.factor.value(x)) ** 2
        return q * x**2 * (3.0 * LENGTH - x) / (6.0 * EJ)

    expected = quad(bending, 0.0, LENGTH, points=[0.3], epsabs=1e-14)[0]
    assert frame.r[-1, 0] == pytest.approx(expected, rel=1e-3)
    assert expected > 5e-4


@pytest.mark.parametrize("interval", [2.0, 20.0])
def test_a_rod_that_sinks_through_a_thin_layer_is_taken_along(interval: float) -> None:
    """It passes the layer in a second, and a step might be as long as five frames."""
    layer = Shear(Curve.table([-15.5, -15.4, -15.2, -15.1], [0.0, 1.0, 1.0, 0.0]))
    water = Fluid(RATIO * DENSITY, drag_normal=1.2, current=(2.0, 0.0, 0.0), shear=layer)
    scene = replace(free(water, 0.0), gravity=(0.0, 0.0, -9.81), t_end=100.0, output_interval=interval,
                    numerics=Numerics("staggered", tolerance=1e-3))  # fmt: skip

    def rates(t: float, y: Array) -> Array:
        u = y[2:] - (2.0 * layer.factor.value(float(y[1])), 0.0)
        return np.array([*y[2:], *((0.0, -9.81 * (1.0 - RATIO)) - RATE * np.hypot(*u) * u)])

    exact = solve_ivp(rates, (0.0, 100.0), np.zeros(4), rtol=1e-10, atol=1e-12, max_step=0.02).y[:2, -1]
    *_, last = simulate(scene)
    assert isinstance(last, VerifiedFrame)
    assert exact[0] > 2.0 * LENGTH
    assert np.all(np.abs(last.r[0, [0, 2]] - exact) < 3.0 * last.error.r[0, [0, 2]] + 1e-3 * LENGTH)


def test_to_a_tolerance_the_first_mesh_sees_each_layer() -> None:
    jet = Shear(Curve.table([0.48 * LENGTH, 0.481 * LENGTH, 0.484 * LENGTH, 0.485 * LENGTH], [0.0, 1.0, 1.0, 0.0]))
    standing = replace(free(replace(WATER, shear=jet), 0.0), initial=Initial.straight(direction=(0.0, 0.0, 1.0)))
    lying = replace(standing, initial=Initial.straight(direction=(1.0, 0.0, 0.0)))
    assert intervals_of(first_mesh(standing, pressed=False)) >= 256
    assert intervals_of(first_mesh(lying, pressed=False)) == 16
    smooth = replace(WATER, shear=Shear(Curve.table(np.linspace(0.0, LENGTH, 200), np.linspace(0.0, 1.0, 200))))
    assert intervals_of(first_mesh(replace(standing, fluid=smooth), pressed=False)) == 16


def test_the_fastest_current_is_known() -> None:
    assert WATER.fastest == pytest.approx(float(np.linalg.norm(CURRENT)))
    assert replace(WATER, shear=TABLE, schedule=Curve.constant(2.0)).fastest == pytest.approx(2.0 * WATER.fastest)
    assert replace(WATER, schedule=Curve.constant(0.0)).fastest == 0.0


def test_a_shear_without_a_direction_is_refused() -> None:
    with pytest.raises(ValueError, match="normal must not be zero"):
        Shear(Curve.constant(1.0), (0.0, 0.0, 0.0))
