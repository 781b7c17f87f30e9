"""Where points come to solids and leave them, against formulas."""

from __future__ import annotations

from math import inf, pi, sqrt

import numpy as np
import pytest

from solver import End, Initial, Scene
from solver.arrays import Array
from solver.kernels.kernel import kernel
from solver.physics.loads import blows, solids
from solver.physics.loads.solids import Floor, Obstacle
from solver.physics.loads.surfaces import near
from tests.solver.scenes import ROD

G, STIFFNESS, MASS = 9.81, 400.0, np.ones(1)
W = sqrt(STIFFNESS)
FLOOR = Floor(STIFFNESS, 0.1, (0.6, 0.0, 0.8))
BAR = Obstacle((-0.1, 0.0, 0.0), (0.3, 0.1, 0.0), 0.2, STIFFNESS)
BALL = Obstacle((0.1, 0.05, 0.3), (0.1, 0.05, 0.3), 0.25, STIFFNESS)


def record(*given: solids.Given) -> solids.Record:
    scene = Scene(ROD, Initial.straight(), End.clamp(), End.free(), 1.0, 1.0, loads=given)
    return solids.of(scene, None).record  # type: ignore[arg-type, no-any-return]


def line(*r: float) -> Array:
    return np.array([r], dtype=float)


@kernel
def height(load: solids.Record, x: float, y: float, z: float) -> float:
    return near(load, 0, (x, y, z)).height  # type: ignore[no-any-return]


@pytest.mark.parametrize("solid", [FLOOR, BAR, BALL], ids=["floor", "bar", "ball"])
def test_a_place_is_as_high_above_a_solid_as_it_is_not_deep(solid: solids.Given) -> None:
    places = np.random.default_rng(3).normal(0.0, 0.3, (50, 3))
    heights = [height(record(solid), *place) for place in places.tolist()]
    assert heights == pytest.approx(-solid.depth(places), abs=1e-15)


def next_blow(r: Array, V: Array, A: Array, *given: solids.Given) -> float:
    return float(blows.next_blow(record(*given or (Floor(STIFFNESS),)), r, V, A, MASS, 10.0))


def test_a_point_in_free_flight_meets_a_floor_where_its_parabola_does() -> None:
    fall = line(0.0, 0.0, -G)
    assert next_blow(line(0.0, 0.0, 2.0), line(0.0, 0.0, -1.0), fall) == pytest.approx((sqrt(1 + 4 * G) - 1) / G)
    assert next_blow(line(0.0, 0.0, 2.0), line(0.0, 0.0, 1.0), fall) == pytest.approx((sqrt(1 + 4 * G) + 1) / G)
    assert next_blow(line(0.0, 0.0, 2.0), line(0.0, 0.0, 1.0), 0.0 * fall) == inf
    assert next_blow(line(0.0, 0.0, 2.0), line(1.0, 0.0, -0.1), fall) == inf  # it slides by


def test_a_point_that_swings_on_a_solid_leaves_it_after_half_a_turn() -> None:
    """Without weight; `A` is what the solid gives it."""
    deep = line(0.0, 0.0, -0.01)
    assert next_blow(deep, line(0.0, 0.0, 0.01 * W), -(W**2) * deep) == pytest.approx(pi / 4.0 / W)
    assert next_blow(0.0 * deep, line(0.0, 0.0, -1.0), 0.0 * deep) == pytest.approx(pi / W)


def test_a_step_ends_before_a_bar_is_half_as_near() -> None:
    bar = record(Obstacle((0.0, -1.0, 0.0), (0.0, 1.0, 0.0), 0.1, STIFFNESS))
    assert blows.longest_step(bar, line(0.0, 0.0, 0.5), line(0.0, 3.0, -2.0)) == pytest.approx(0.5 * 0.4 / 2.0)
    assert blows.longest_step(bar, line(0.0, 0.0, 0.15), line(0.0, 0.0, -2.0)) == pytest.approx(0.5 * 0.1 / 2.0)
    assert blows.longest_step(bar, line(0.0, 0.0, 0.5), line(0.0, 0.0, 2.0)) > 1e99


def test_what_a_step_misses_counts_on_the_side_where_it_goes_less() -> None:
    floor, dt = record(Floor(STIFFNESS)), 0.01
    path = np.array([[[0.0, 0.0, z]] for z in (0.03, 0.01, 0.0, -0.02)])
    assert blows.missed(floor, path, MASS, dt) == pytest.approx(2.0 * 0.02 * (W * dt) ** 2 * 0.02)
    assert blows.missed(floor, path + line(0.0, 0.0, 1.0), MASS, dt) == 0.0
    assert blows.missed(floor, path - line(0.0, 0.0, 1.0), MASS, dt) == 0.0
