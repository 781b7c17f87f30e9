"""Applied loads: weight, distributed and point loads as densities at the nodes."""

from __future__ import annotations

from math import pi
from typing import NamedTuple

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from solver import Curve, DistributedLoad, End, Fluid, Initial, PointLoad, Rod, Scene, constant_vector
from solver.arrays import Array
from solver.physics.loads.applied import AppliedLoads
from solver.physics.loads.given import nodes_act
from solver.physics.loads.load import Samples
from solver.physics.section import sample

LENGTH, INTERVALS = 2.0, 8
S = np.linspace(0.0, LENGTH, INTERVALS + 1)
H = LENGTH / INTERVALS
ZERO = constant_vector((0.0, 0.0, 0.0))
ROD = Rod.circular(LENGTH, 0.02, 1e7, 5e6, 2000.0)
NODES = Samples(S, sample(ROD, S), *nodes_act(S), times=1)
MIDDLES = 0.5 * (S[1:] + S[:-1])
SEGMENTS = Samples(MIDDLES, sample(ROD, MIDDLES), MIDDLES, np.diff(S), times=1, rigid=True)
RAMP = Curve.table([0.0, 4.0], [0.0, 1.0])


def applied(**loads: object) -> AppliedLoads:
    scene = scene_with(**loads)
    return AppliedLoads(scene, sample(scene.rod, S), S)


class Now(NamedTuple):
    """What acts at one time: forces and moments (n, 6) along lab and along material axes."""

    lab: Array
    material: Array


def at(loads: AppliedLoads, t: float) -> Now:
    loads.set_time(t)
    dead, following, weight = loads.records.dead, loads.records.following, loads.records.weight
    lab = np.hstack([weight.weight + dead.force[0], following.moment[0]])
    return Now(lab, np.hstack([following.force[0], dead.moment[0]]))


def scene_with(**loads: object) -> Scene:
    return Scene(
        rod=ROD, initial=Initial.straight(), start=End.clamp(), end=End.free(),
        t_end=1.0, output_interval=1.0, **loads,  # type: ignore[arg-type]
    )  # fmt: skip


def force_and_moment_at_the_root(density: Array) -> tuple[float, float]:
    """What a clamp at s = 0 feels of a transverse density on a straight rod: the box scheme's own sums.

    Delta F = -h B_m from the free end on, and the moment is the sum of h F_m.
    """
    F = np.zeros(len(density))
    for j in range(len(density) - 1, 0, -1):
        F[j - 1] = F[j] + 0.5 * H * (density[j - 1] + density[j])
    return float(F[0]), float(np.sum(0.5 * H * (F[1:] + F[:-1])))


@given(st.floats(0.0, LENGTH))
def test_a_point_load_acts_with_its_force_and_its_moment_wherever_it_is(at: float) -> None:
    force, moment = force_and_moment_at_the_root(NODES.weights(at))
    assert force == pytest.approx(1.0, abs=1e-14)
    assert moment == pytest.approx(at, abs=1e-13)


@pytest.mark.parametrize("at", [0.0, 0.1 * H, 0.5 * H, 0.9 * H, LENGTH - 0.5 * H, LENGTH - 0.01 * H, LENGTH])
def test_a_point_load_near_an_end_is_as_exact_as_elsewhere(at: float) -> None:
    assert_allclose(force_and_moment_at_the_root(NODES.weights(at)), (1.0, at), atol=1e-14)


def test_a_point_load_on_a_node_is_that_nodes_alone() -> None:
    weights = NODES.weights(float(S[3]))
    assert weights[3] == pytest.approx(1.0 / H)
    assert np.count_nonzero(np.abs(weights) > 1e-12) == 1


def test_a_point_load_moves_smoothly_along_the_rod() -> None:
    along = np.linspace(0.0, LENGTH, 2001)
    weights = np.array([NODES.weights(float(at)) for at in along])
    # piecewise linear: a step of 1 mm may change a weight by 1e-3 m / (H/2) / (H/2)
    assert np.abs(np.diff(weights, axis=0)).max() <= 1e-3 / (0.5 * H) ** 2 * (1 + 1e-9)


@given(st.floats(0.0, LENGTH))
def test_on_rigid_segments_a_point_load_acts_where_it_is_and_nowhere_else(at: float) -> None:
    weights, levers = SEGMENTS.weights(at) * H, SEGMENTS.levers(at) * H
    assert weights.sum() == pytest.approx(1.0, abs=1e-14)
    assert (weights * MIDDLES + levers).sum() == pytest.approx(at, abs=1e-14)
    there = np.flatnonzero(weights)
    assert (np.abs(at - MIDDLES[there]) <= 0.5 * H * (1.0 + 1e-8)).all() and len(there) == (2 if at in S[1:-1] else 1)


def test_at_a_node_both_segments_bear_half_of_it_at_their_ends() -> None:
    assert_allclose(SEGMENTS.weights(float(S[3]))[[2, 3]] * H, 0.5)
    assert_allclose(SEGMENTS.levers(float(S[3]))[[2, 3]] * H, [0.25 * H, -0.25 * H])


def test_weight_is_less_buoyancy() -> None:
    scene = scene_with(gravity=(0.0, 0.0, -9.81), fluid=Fluid(density=1025.0))
    weight = AppliedLoads(scene, sample(scene.rod, S), S).records.weight.weight
    expected = -(2000.0 - 1025.0) * pi * 0.02**2 / 4 * 9.81
    assert_allclose(weight, np.tile([0.0, 0.0, expected], (INTERVALS + 1, 1)), rtol=1e-14)
    assert_allclose(at(applied(gravity=(0.0, 0.0, -9.81), fluid=Fluid(density=1025.0)), 0.0).lab[:, :3], weight)


def test_a_distributed_load_follows_its_profile_and_its_schedule() -> None:
    along = Curve.table([0.0, LENGTH], [1.0, 3.0])
    load = DistributedLoad(force=(along, ZERO[1], ZERO[2]), moment=(ZERO[0], along, ZERO[2]), schedule=RAMP)
    loads = applied(distributed=(load,))
    for t in (0.0, 1.0, 4.0, 9.0, 2.0):
        now = at(loads, t)
        assert_allclose(now.lab[:, 0], along(S) * min(t / 4.0, 1.0))
        assert_allclose(now.lab[:, 4], along(S) * min(t / 4.0, 1.0))
        assert_allclose(now.material, 0.0)
    assert loads.records.dead.present and loads.records.following.present  # the moments are along lab axes


def test_a_load_in_the_material_frame_follows_the_rod() -> None:
    moment = constant_vector((0.0, 0.0, 2.0))
    loads = applied(distributed=(DistributedLoad(moment=moment, frame="material"),))
    assert_allclose(at(loads, 0.0).material[:, 5], 2.0)
    assert_allclose(at(loads, 0.0).lab, 0.0)


def test_loads_add_up() -> None:
    one = DistributedLoad(force=constant_vector((1.0, 0.0, 0.0)))
    point = PointLoad(1.0, force=(Curve.constant(5.0), ZERO[1], ZERO[2]))
    now = at(applied(distributed=(one, one), points=(point, point)), 0.0)
    assert_allclose(now.lab[:, 0], 2.0 + 10.0 * NODES.weights(1.0))


def test_a_point_load_at_an_end_is_the_ends_and_no_density() -> None:
    force = (Curve.constant(1.0), RAMP, ZERO[2])
    loads = applied(points=(PointLoad(LENGTH, force=force), PointLoad(0.0, force=force, frame="material")))
    assert_allclose(at(loads, 2.0).lab, 0.0)
    # f at s = L is the force that the outside exerts on the rod; at s = 0 it is minus that
    assert_allclose(loads.at_end(2.0, LENGTH, "lab"), [1.0, 0.5, 0.0, 0.0, 0.0, 0.0])
    assert_allclose(loads.at_end(2.0, 0.0, "material"), [-1.0, -0.5, 0.0, 0.0, 0.0, 0.0])
    assert_allclose(loads.at_end(2.0, LENGTH, "material"), 0.0)
    assert_allclose(loads.at_end(2.0, 0.0, "lab"), 0.0)


def test_steps_are_aligned_with_the_corners_of_every_load() -> None:
    later = Curve.table([5.0, 6.0], [0.0, 1.0])
    load = DistributedLoad(force=constant_vector((1.0, 0.0, 0.0)), schedule=RAMP)
    points = (
        PointLoad(1.0, force=(later, ZERO[1], ZERO[2])),
        PointLoad(LENGTH, moment=(ZERO[0], ZERO[1], Curve.table([7.0, 8.0], [0.0, 1.0]))),
    )
    assert sorted(applied(distributed=(load,), points=points).corners()) == [0.0, 4.0, 5.0, 6.0, 7.0, 8.0]


def test_a_scene_without_loads_has_none() -> None:
    loads = applied()
    now = at(loads, 3.0)
    assert not any(record.present for record in loads.records)
    assert loads.corners() == []
    drag, added_mass = loads.records.drag, loads.records.added_mass
    for density in (now.lab, now.material, added_mass.mass, drag.normal, drag.tangential):
        assert_allclose(density, 0.0, atol=0.0)


def test_the_fluids_coefficients_are_morisons() -> None:
    fluid = Fluid(1025.0, added_mass=1.1, drag_normal=1.2, drag_tangential=0.01, current=(0.3, 0.0, 0.0))
    now = applied(fluid=fluid).records
    assert now.drag.present and now.added_mass.present
    assert_allclose(now.added_mass.mass, 1.1 * 1025.0 * pi * 0.02**2 / 4)
    assert_allclose(now.drag.normal, 0.5 * 1025.0 * 0.02 * 1.2)
    assert_allclose(now.drag.tangential, 0.5 * 1025.0 * pi * 0.02 * 0.01)
    assert_allclose(now.drag.current, [[0.3, 0.0, 0.0]])
    assert_allclose(now.added_mass.current, [[0.3, 0.0, 0.0]])
