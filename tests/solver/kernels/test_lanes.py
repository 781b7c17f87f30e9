"""Loops eight abreast: to the bit what one node after the other gives, small and large angles side by side."""

from __future__ import annotations

from typing import Any, no_type_check

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from solver import End, Numerics, Scene
from solver.arrays import Array
from solver.kernels.kernel import kernel
from solver.kernels.lanes import abreast
from solver.kernels.rotation import cross, matrix_of, relative_rotation, turn
from solver.methods.box import BoxMethod
from solver.methods.space.box.nodes import place_nodes
from solver.methods.space.segments.joints import bend_joints
from solver.methods.space.segments.motion import extrapolate, spin_steadily
from solver.methods.staggered import StaggeredMethod
from solver.methods.time.radau.method import SCHEME
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


@abreast("a: 3, b: 3, weight: 1 -> moment: 3, swapped: 2x2")
@no_type_check
def moment_of(a, b, weight, factor):
    """Vectors number by number, by index, and by a star."""
    sum_of_both = a + factor * b
    lever = cross(*a, *sum_of_both)
    return weight * lever, (b[1], b[0], a[1], a[0])


@kernel
def moments_of(a: Any, b: Any, weight: Any, factor: float, moment: Any, swapped: Any) -> None:
    moment_of(a, b, weight, factor, moment, swapped)


def test_a_function_of_one_line_becomes_one_of_all_lines() -> None:
    rng = np.random.default_rng(1)
    a, b, weight = rng.normal(size=(13, 3)), rng.normal(size=(13, 5)), rng.normal(size=13)
    moment, swapped = np.empty((13, 3)), np.empty((13, 2, 2))
    moments_of(a, b, weight, 2.0, moment, swapped)
    assert moment == pytest.approx(weight[:, None] * np.cross(a, 2.0 * b[:, :3]), abs=1e-14)
    assert_array_equal(swapped, np.stack([b[:, 1::-1], a[:, 1::-1]], axis=1))


def test_a_generated_function_has_the_place_of_its_function_for_the_cache_on_disk() -> None:
    loop = moment_of.py_func
    assert (loop.__module__, loop.__qualname__, loop.__code__.co_filename) == (__name__, "moment_of", __file__)


def looping(a: Any) -> Any:
    for k in range(3):
        a = a + k
    return a


def clashing(a: Any) -> Any:
    a = a + 1.0
    return a + a


def uneven(a: Any, b: Any) -> Any:
    return a + b


@pytest.mark.parametrize("function", [looping, clashing, uneven])
def test_what_cannot_be_written_eight_abreast_is_refused(function: Any) -> None:
    with pytest.raises(SyntaxError, match="eight abreast"):
        abreast("a: 3, b: 2 -> c: 3")(function)
