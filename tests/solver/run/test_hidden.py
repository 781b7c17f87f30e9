"""What cancels within an interval, or lies between nodes: no two meshes that are blind to it may agree."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from solver import Curve, DistributedLoad, Initial, Numerics, PointLoad, constant_vector
from solver.arrays import Array
from solver.measures.topology import writhe
from solver.methods.space.segments.initial import chain_of, lay_out, segments_of
from solver.physics.loads.solids import Obstacle
from solver.run.first_mesh import first_mesh
from solver.run.hidden import cancelled
from solver.run.trial import intervals_of
from solver.scene.layout import nodes_at_rest
from tests.solver.scenes import EJ, LENGTH, ROD, last
from tests.solver.statics.resting import ZERO, ramp, static

CLOSE = 0.63 * LENGTH, 0.65 * LENGTH
MOMENT = 5.0 * EJ / LENGTH
BENT = MOMENT * (CLOSE[1] - CLOSE[0]) / EJ
"""By what angle (rad) two opposite moments MOMENT at CLOSE bend a cantilever."""
BY_TOLERANCE = Numerics("staggered", tolerance=1e-3)


def bend(at: float, half: float, angle: float) -> tuple[list[float], list[float]]:
    return [at - half, at, at + half], [0.0, angle / half, 0.0]


def table(*bends: tuple[list[float], list[float]]) -> tuple[Curve, Curve, Curve]:
    """Natural curvature about a2 of some bends."""
    s, kappa = np.hstack(bends)
    return ZERO, Curve.table(s, kappa), ZERO


def pair(at: float, moment: float) -> PointLoad:
    return PointLoad(at, moment=(ZERO, ramp(moment), ZERO))


def patch(at: float, moment: float) -> DistributedLoad:
    """A moment on a hundredth of the rod."""
    half = 0.005 * LENGTH
    density = Curve.table(*bend(at, half, moment))
    return DistributedLoad(moment=(ZERO, density, ZERO), schedule=ramp(1.0))


@pytest.mark.parametrize("loads", [
    {"points": (pair(CLOSE[0], MOMENT), pair(CLOSE[1], -MOMENT))},
    {"distributed": (patch(CLOSE[0], MOMENT), patch(CLOSE[1], -MOMENT))},
])  # fmt: skip
def test_two_moments_that_cancel_within_an_interval_bend_the_rod(loads: dict[str, object]) -> None:
    """The tip is displaced by the arc between them and the straight end behind it."""
    tip = last(static(numerics=BY_TOLERANCE, **loads)).r[-1]
    across = (1.0 - np.cos(BENT)) / BENT * (CLOSE[1] - CLOSE[0]) + (LENGTH - CLOSE[1]) * np.sin(BENT)
    assert_allclose(np.hypot(tip[0], tip[1]), across, rtol=5e-3)


def test_a_natural_shape_that_turns_to_and_fro_within_an_interval_is_seen() -> None:
    """A jog: two opposite bends of 1 rad, 9 mm apart in a rod of 1 m."""
    jog = table(*(bend(at * LENGTH, 1e-3 * LENGTH, angle) for at, angle in ((0.64, 1.0), (0.649, -1.0))))
    tip = last(static(rod=replace(ROD, kappa0=jog), numerics=BY_TOLERANCE)).r[-1]
    assert_allclose(np.hypot(tip[0], tip[1]), 0.009 * LENGTH * np.sin(1.0), atol=5e-4 * LENGTH)


@pytest.mark.parametrize("at", [0.611, 0.674, 0.7, 0.808])
def test_a_crease_bends_the_rod_where_it_is(at: float) -> None:
    """On every mesh: its angle and where this turns the rod, to first order."""
    s = np.linspace(0.0, LENGTH, 17)
    rod = replace(ROD, kappa0=table(bend(at * LENGTH, 1e-3 * LENGTH, 0.5)))
    chain = chain_of(rod, segments_of(rod, s), np.zeros(16), s)
    lay_out(static(rod=rod, initial=Initial.straight()), chain, s)
    angles = chain.elastic.kappa0[:, 1] * chain.span
    assert_allclose(angles.sum(), 0.5)
    assert_allclose(angles @ s, 0.5 * at * LENGTH)


@pytest.mark.parametrize("at", [0.2, 0.37, 0.51, 0.7367])
def test_a_moment_bends_the_rod_up_to_where_it_acts(at: float) -> None:
    """All before it is an arc; not up to the middle of a segment."""
    angle = 0.3
    load = pair(at * LENGTH, angle * EJ / (at * LENGTH))
    tip = last(static(points=(load,), numerics=Numerics("staggered", intervals=16))).r[-1]
    across = (1.0 - np.cos(angle)) / angle * at * LENGTH + (1.0 - at) * LENGTH * np.sin(angle)
    assert_allclose(np.hypot(tip[0], tip[1]), across, rtol=1e-3)


def sines(waves: int, angle: float) -> tuple[Curve, Curve, Curve]:
    """Natural curvature that turns the rod to and fro by so much."""
    s = np.linspace(0.0, LENGTH, 20 * waves + 1)
    phase = 2.0 * np.pi * waves * s / LENGTH
    return ZERO, Curve.table(s, angle * 2.0 * np.pi * waves / LENGTH * np.cos(phase)), ZERO


@pytest.mark.parametrize(("waves", "mesh"), [(1, 0), (64, 3)])
def test_the_first_mesh_sees_many_waves_and_needs_none_for_one(waves: int, mesh: int) -> None:
    scene = static(rod=replace(ROD, kappa0=sines(waves, 0.3)), numerics=BY_TOLERANCE)
    assert first_mesh(scene, pressed=False) == mesh


def curl(part: float) -> Initial:
    """A straight rod with one turn of a helix on a part of its length in the middle."""
    s = np.linspace(0.0, LENGTH, 4001)
    along = np.clip((s / LENGTH - 0.5) / part + 0.5, 0.0, 1.0)
    turn, rise = 2.0 * np.pi * along - np.sin(2.0 * np.pi * along), 0.15 * np.sin(np.pi * along) ** 2
    tangent = np.stack([np.sin(turn) * np.cos(rise), np.sin(rise), np.cos(turn) * np.cos(rise)], axis=1)
    middles = 0.5 * (tangent[1:] + tangent[:-1]) * (s[1] - s[0])
    points = np.vstack([np.zeros(3), np.cumsum(middles, axis=0)])
    return Initial.through(points[(np.arange(4001) % 10 == 0) | (abs(s / LENGTH - 0.5) < part)], LENGTH)


@pytest.mark.parametrize("part", [0.3, 0.03])
def test_a_small_loop_in_a_long_rod_has_its_writhe_from_the_first_mesh_on(part: float) -> None:
    """A joint about which the rod turned by 2 pi would count it as none."""
    scene = replace(static(initial=curl(part), numerics=BY_TOLERANCE), analysis="dynamic")
    intervals = intervals_of(first_mesh(scene, pressed=False))
    r = nodes_at_rest(scene.initial, np.linspace(0.0, LENGTH, intervals + 1))[0]
    z = np.array([0.0, 0.0, 1.0])
    assert_allclose(writhe(r, np.array([z, z])), 0.89, atol=0.03)
    assert intervals <= 10.0 / part


def test_a_natural_turn_within_an_interval_is_seen() -> None:
    """kappa0 of a whole turn in a 50th of the rod, which is straight at first."""
    s = LENGTH * np.array([0.4, 0.41, 0.42])
    kappa0 = table((list(s), [0.0, 2.0 * np.pi / (0.01 * LENGTH), 0.0]))
    scene = replace(static(rod=replace(ROD, kappa0=kappa0), numerics=BY_TOLERANCE), analysis="dynamic")
    assert intervals_of(first_mesh(scene, pressed=False)) == 256


def test_loads_that_do_not_cancel_ask_for_no_finer_mesh() -> None:
    """Two weights beside each other, one pull down and one aside, and two opposite ones far apart."""
    for one, other, apart in (((1.0, 0.0, 0.0), (2.0, 0.0, 0.0), 0.01), ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), 0.01),
                              ((1.0, 0.0, 0.0), (-1.0, 0.0, 0.0), 0.1)):  # fmt: skip
        loads = [PointLoad(s, constant_vector(tuple(EJ / LENGTH**2 * np.array(force))))
                 for s, force in ((0.3 * LENGTH, one), ((0.3 + apart) * LENGTH, other))]  # fmt: skip
        assert first_mesh(static(points=tuple(loads), numerics=BY_TOLERANCE), pressed=False) == 0


@pytest.mark.parametrize(("axis", "intervals"), [
    ((0.01, 0.0, 0.0), 128), ((0.0, 0.0, 0.01), 16), ((0.0, 0.0, 0.0), 128), ((0.0, 0.004, 0.01), 64),
])  # fmt: skip
def test_an_obstacle_lies_between_no_two_nodes_of_a_rod_that_does_not_lie_along_it(
    axis: tuple[float, float, float], intervals: int
) -> None:
    bar = Obstacle((0.0, 0.0, 0.0), axis, 0.01 * LENGTH, 1e3)
    mesh = first_mesh(replace(static(numerics=BY_TOLERANCE, loads=(bar,)), analysis="dynamic"), pressed=False)
    assert intervals_of(mesh) == intervals


@pytest.mark.parametrize(("h", "most"), [(0.1, 0.0), (0.25, 2.0), (1.0, 4.0)])
def test_what_cancels_within_a_length(h: float, most: float) -> None:
    places: Array = np.array([0.0, 0.2, 0.4, 0.6])
    assert cancelled(places, np.array([[1.0], [-1.0], [1.0], [-1.0]]), h) == most
