"""Loops eight abreast: to the bit what one node after the other gives, small and large angles side by side."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from solver import End, Numerics, Scene
from solver.arrays import Array
from solver.kernels.rotation import matrix_of, relative_rotation, turn
from solver.methods.box import BoxMethod
from solver.methods.space.box.nodes import place_nodes
from solver.methods.space.segments.joints import bend_joints
from solver.methods.space.segments.motion import extrapolate, spin_steadily
from solver.methods.staggered import SCHEME, StaggeredMethod
from tests.solver.scenes import ARC, ROD

SIZES = (4, 7, 8, 21)
"""Intervals: less than eight nodes, eight, and some over."""


def scene(intervals: int) -> Scene:
    return Scene(rod=ROD, initial=ARC, start=End.clamp(), end=End.free(), t_end=1.0, output_interval=1.0,
                 numerics=Numerics(intervals=intervals))  # fmt: skip


def vectors(n: int) -> Array:
    """Rotation vectors (n, 3): from tiny ones to those of more than half a turn, in no order."""
    rng = np.random.default_rng(n)
    directions = rng.normal(size=(n, 3))
    angles = rng.permutation(np.geomspace(1e-9, 5.0, n))
    return angles[:, None] * directions / np.linalg.norm(directions, axis=1)[:, None]


def turned(quaternion: Array, theta: Array) -> Array:
    result = np.empty((len(theta), 4))
    for one, by, to in zip(quaternion, theta, result, strict=True):
        turn(one, by, to)
    return result


def matrices(quaternion: Array) -> Array:
    result = np.empty((len(quaternion), 3, 3))
    for one, R in zip(quaternion, result, strict=True):
        matrix_of(one, R)
    return result


@pytest.mark.parametrize("intervals", SIZES)
def test_nodes_are_placed_as_one_by_one(intervals: int) -> None:
    method = BoxMethod(scene(intervals))
    past, nodes, theta = method.work.past, method.work.nodes, vectors(intervals + 1)
    past[:, 3:6] = theta
    place_nodes(method.state, method.trial, past, 1.0, nodes)
    expected = turned(method.state.quaternion, theta)
    assert_array_equal(method.trial.quaternion, expected)
    assert_array_equal(nodes.R, matrices(expected))
    assert_array_equal(method.trial.r, past[:, :3])


@pytest.mark.parametrize("intervals", SIZES)
def test_joints_bend_as_one_by_one(intervals: int) -> None:
    method = StaggeredMethod(scene(intervals))
    quaternion = turned(np.tile([1.0, 0.0, 0.0, 0.0], (intervals + 2, 1)), vectors(intervals + 2))
    bend, moment, left, right = np.empty((4, intervals + 1, 3))
    bend_joints(method.chain, quaternion, bend, moment, left, right)
    for i in range(intervals + 1):
        theta = np.empty(3)
        relative_rotation(quaternion[i], quaternion[i + 1], theta)
        assert_array_equal(bend[i], theta)
        assert_array_equal(
            moment[i], method.chain.elastic.K[i] @ (theta / method.chain.span[i] - method.chain.elastic.kappa0[i])
        )
        # B q - B^t q = Theta x q
        assert left[i] - right[i] == pytest.approx(np.cross(theta, moment[i]), rel=1e-9, abs=1e-12)


@pytest.mark.parametrize("intervals", SIZES)
def test_segments_spin_as_one_by_one(intervals: int) -> None:
    method = StaggeredMethod(scene(intervals))
    state, stages = method.state, method.stages
    state.omega[:] = vectors(intervals + 2)
    spin_steadily(state, SCHEME.nodes, 1.0, stages)
    for i, tau in enumerate(SCHEME.nodes):
        steady = turned(np.tile([1.0, 0.0, 0.0, 0.0], (intervals + 2, 1)), state.omega * tau)
        assert_array_equal(stages.steady[i], steady)
        assert_array_equal(stages.S[i], matrices(steady))


@pytest.mark.parametrize("intervals", SIZES)
def test_a_steady_spin_is_guessed_to_go_on(intervals: int) -> None:
    method = StaggeredMethod(scene(intervals))
    before, state, n = method.state, method.trial, intervals + 2
    before.omega[:] = state.omega[:] = vectors(n)
    state.quaternion[:] = turned(before.quaternion, before.omega)
    extrapolate(before, np.zeros((3, n, 3)), 1.0, state, SCHEME.nodes, np.eye(3), 0.5, method.stages.theta)
    assert method.stages.theta == pytest.approx(np.zeros((3, n, 3)), abs=1e-14)
