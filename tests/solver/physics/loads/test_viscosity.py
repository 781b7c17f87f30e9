"""A fluid that creeps past the rod: drag in proportion to the velocity and to the spin, against closed forms."""

from __future__ import annotations

from math import log, pi

import numpy as np
import pytest
from numpy.testing import assert_allclose

from solver import Curve, End, Fluid, Initial, Numerics, PointLoad, Scene, Shear, simulate
from solver.scene.curve import Vector
from tests.solver.scenes import DENSITY, DIAMETER, EJ, LENGTH, MASS, ROD, SPIN_INERTIA

VISCOSITY = 50.0
GLYCERINE = Fluid(1000.0, viscosity=VISCOSITY)
ACROSS = 4.0 * pi * VISCOSITY / (log(LENGTH / DIAMETER) + 0.84)
ALONG = 2.0 * pi * VISCOSITY / (log(LENGTH / DIAMETER) - 0.21)
FIRST_MODE = 1.8751040687
"""q L of a cantilever's first mode."""


def fine(method: str, intervals: int, dt: float) -> Numerics:
    return Numerics(method=method, intervals=intervals, dt_max=dt)


METHODS = pytest.mark.parametrize(
    "numerics", [fine("staggered", 16, 0.01), fine("box", 16, 0.01)], ids=["staggered", "box"]
)


@METHODS
@pytest.mark.parametrize(("direction", "drag"), [((1.0, 0.0, 0.0), ACROSS), ((0.0, 0.0, 1.0), ALONG)])
def test_a_rod_sinks_as_fast_as_its_drag_lets_it(numerics: Numerics, direction: tuple[float, ...], drag: float) -> None:
    """By its weight less its buoyancy; what it loses of its height is dissipated."""
    initial = Initial.straight(direction=(direction[0], direction[1], direction[2]))
    scene = Scene(ROD, initial, End.free(), End.free(), 1.0, 0.25, gravity=(0.0, 0.0, -9.81), fluid=GLYCERINE,
                  numerics=numerics)  # fmt: skip
    first, *_, before, last = simulate(scene)
    weight = MASS * (1.0 - GLYCERINE.density / DENSITY) * 9.81
    assert_allclose((last.r - before.r) / 0.25, [[0.0, 0.0, -weight / drag]] * len(last.r), atol=1e-6 * weight / drag)
    sunk = first.r[0, 2] - last.r[0, 2]
    assert last.dissipation == pytest.approx(weight * sunk * LENGTH - last.energy_kinetic, rel=1e-3)


def test_a_spin_about_its_axis_fades() -> None:
    """I omega' = -pi mu D^2 omega."""
    rate = pi * 0.05 * DIAMETER**2 / SPIN_INERTIA
    scene = Scene(ROD, Initial.straight(angular_velocity=(0.0, 0.0, 3.0)), End.free(), End.free(), 0.3, 0.1,
                  fluid=Fluid(1000.0, viscosity=0.05), numerics=fine("staggered", 8, 0.01))  # fmt: skip
    for frame in simulate(scene):
        assert_allclose(frame.omega[:, 2], 3.0 * np.exp(-rate * frame.t), rtol=1e-5)


@METHODS
def test_a_cantilever_comes_to_rest_at_the_rate_of_its_first_mode(numerics: Numerics) -> None:
    """zeta u' = -EJ u'''': without inertia each mode fades by EJ q^4 / zeta."""
    rate, deflection = EJ * (FIRST_MODE / LENGTH) ** 4 / ACROSS, 1e-3 * LENGTH
    force: Vector = (Curve.constant(3.0 * EJ * deflection / LENGTH**3), Curve.constant(0.0), Curve.constant(0.0))
    scene = Scene(ROD, Initial.straight(), End.clamp(), End.free(), 3.0 / rate, 1.0 / rate,
                  points=(PointLoad(LENGTH, force=force),), fluid=GLYCERINE,
                  numerics=fine(numerics.method, 64, 0.05 / rate))  # fmt: skip
    _, one, two, three = [deflection - frame.r[-1, 0] for frame in simulate(scene)]
    assert log(one / two) == pytest.approx(1.0, abs=2e-3)
    assert log(two / three) == pytest.approx(1.0, abs=2e-3)


@pytest.mark.parametrize("height", [-1.0, 0.5])
def test_a_rod_goes_with_the_current_of_its_height(height: float) -> None:
    sheared = Shear(Curve.table([-1.0, 1.0], [-2.0, 2.0], "linear"))
    fluid = Fluid(1000.0, current=(0.1, 0.0, 0.0), shear=sheared, viscosity=VISCOSITY)
    level = Initial.straight((0.0, 0.0, height), (0.0, 1.0, 0.0))
    *_, before, last = simulate(Scene(ROD, level, End.free(), End.free(), 0.5, 0.25, fluid=fluid,
                                      numerics=fine("staggered", 8, 0.01)))  # fmt: skip
    assert_allclose((last.r - before.r) / 0.25, [[0.2 * height, 0.0, 0.0]] * len(last.r), atol=1e-6)


def test_what_damps_a_scene_is_its_damping_and_its_fluid() -> None:
    scene = Scene(ROD, Initial.straight(), End.free(), End.free(), 1.0, 0.5, damping=2.0, fluid=GLYCERINE)
    assert scene.damping_rate == pytest.approx(2.0 + ACROSS * LENGTH / MASS, rel=1e-12)
