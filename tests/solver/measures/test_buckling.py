"""What lets a straight rod buckle, against textbooks."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from math import pi, sqrt

import numpy as np
import pytest
from scipy.optimize import brentq

from solver import Condition, Curve, End, Initial, PointLoad, Rod, Scene
from solver.measures.buckling import can_buckle, growth_rate
from solver.physics.loads.solids import Floor
from solver.scene.ends import FIXED, FREE
from tests.solver.scenes import LENGTH, ROD

EJ, MASS = float(ROD.stiffness[0](0.0)), float(ROD.mass(0.0))
S = np.linspace(0.0, LENGTH, 101)
CLAMP, PIN, FREE_END, SLIDER = End.clamp(), End.pin(), End.free(), End.slider()


def scene_of(start: End, end: End, rod: Rod = ROD, **more: object) -> Scene:
    return Scene(rod, Initial.straight(), start, end, 1.0, 0.1, **more)  # type: ignore[arg-type]


def critical(grows: Callable[[float], float], low: float, high: float) -> float:
    """From where on something grows."""
    return float(brentq(lambda load: 1.0 if grows(load) > 1e-4 else -1.0, low, high, xtol=1e-4 * high))


@pytest.mark.parametrize(("ends", "expected"), [
    ((PIN, PIN), pi**2), ((CLAMP, SLIDER), 4 * pi**2), ((CLAMP, PIN), 20.19), ((CLAMP, FREE_END), pi**2 / 4),
    ((FREE_END, CLAMP), pi**2 / 4),
])  # fmt: skip
def test_a_column_buckles_by_eulers_load(ends: tuple[End, End], expected: float) -> None:
    def rate(load: float) -> float:
        return growth_rate(scene_of(*ends), S, np.full(101, -load * EJ / LENGTH**2), 0.0 * S, 0.0 * S)

    assert critical(rate, 1.0, 60.0) == pytest.approx(expected, rel=5e-3)


def test_a_mast_buckles_by_its_weight() -> None:
    """Greenhill's 7.837 EJ/L^3 per length."""
    def rate(load: float) -> float:
        return growth_rate(scene_of(CLAMP, FREE_END), S, -load * EJ / LENGTH**3 * (LENGTH - S), 0.0 * S, 0.0 * S)

    assert critical(rate, 1.0, 20.0) == pytest.approx(7.837, rel=5e-3)


def _torque(tension: float) -> float:
    """M L/EJ by which a rod between a clamp and one that slides buckles under a tension T in EJ/L^2.

    Across it d4u + i M d3u - T d2u = 0, and u and du are zero at both ends.
    """
    def determinant(M: float) -> float:
        a, b = 1j * (-M / 2 + sqrt(M**2 / 4 - tension)), 1j * (-M / 2 - sqrt(M**2 / 4 - tension))
        rows = [[1, 0, 1, 1], [0, 1, a, b], [1, 1, np.exp(a), np.exp(b)], [0, 1, a * np.exp(a), b * np.exp(b)]]
        return float((np.linalg.det(np.array(rows)) * np.exp(0.5j * M)).imag)

    return float(brentq(determinant, 2.0 * sqrt(tension) + 1.0, max(9.5, 2.0 * sqrt(tension) + 4.0)))


@pytest.mark.parametrize("twist", [0.0, 20.0])
@pytest.mark.parametrize("tension", [0.01, 20.0])
def test_a_wrung_rod_buckles_by_greenhills_torque(twist: float, tension: float) -> None:
    """However its section turns along it; between clamps, without tension, M L/EJ = 8.987."""
    def rate(torque: float) -> float:
        along = tension * EJ / LENGTH**2 + 0.0 * S, torque * EJ / LENGTH + 0.0 * S, twist + 0.0 * S
        return growth_rate(scene_of(CLAMP, SLIDER), S, *along)

    assert _torque(0.01) == pytest.approx(8.987, rel=1e-3)
    assert critical(rate, 1.0, 40.0) == pytest.approx(_torque(tension), rel=1e-2)


def test_a_tape_buckles_about_its_softer_axis() -> None:
    tape = replace(ROD, stiffness=(Curve.constant(9.0 * EJ), *ROD.stiffness[1:]))

    def rate(load: float) -> float:
        return growth_rate(scene_of(CLAMP, FREE_END, tape), S, np.full(101, -load * EJ / LENGTH**2), 0.0 * S, 0.0 * S)

    assert critical(rate, 1.0, 20.0) == pytest.approx(pi**2 / 4, rel=5e-3)


@pytest.mark.parametrize(("damping", "expected"), [(0.0, 1.0), (1.5, 0.5)])
def test_what_grows_does_so_as_in_the_mode_of_a_column(damping: float, expected: float) -> None:
    """Between pins under twice Euler's load by pi^2 sqrt(EJ / m) / L^2, in which the damping is given."""
    unit = pi**2 * sqrt(EJ / MASS) / LENGTH**2
    scene = scene_of(PIN, PIN, damping=damping * unit)
    rate = growth_rate(scene, S, np.full(101, -2.0 * pi**2 * EJ / LENGTH**2), 0.0 * S, 0.0 * S)
    assert rate == pytest.approx(expected * unit, rel=1e-2)


def test_it_is_not_asked_where_loads_turn_or_something_else_holds_the_rod() -> None:
    push = Condition("load", Curve.constant(-1.0))
    following, guided = End((FREE, FREE, (push,)), (FREE,) * 3), End((FIXED, FIXED, (push,)), (FIXED,) * 3)
    assert can_buckle(scene_of(CLAMP, FREE_END)) and can_buckle(scene_of(CLAMP, guided))
    assert can_buckle(scene_of(CLAMP, replace(following, frame="lab")))
    assert not can_buckle(scene_of(CLAMP, following))
    assert not can_buckle(scene_of(CLAMP, FREE_END, loads=(Floor(1.0),)))
    assert not can_buckle(scene_of(CLAMP, FREE_END, points=(PointLoad(0.5 * LENGTH, frame="material"),)))
