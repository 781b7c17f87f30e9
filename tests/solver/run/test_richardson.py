"""Extrapolation over meshes, on sequences whose limit is known."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from solver.run.richardson import alike, error_of_steps, extrapolate

MESHES = (16, 32, 64)


def solution(intervals: int, order: float = 2.0) -> np.ndarray:
    """Two frames of two columns, of a sine and its error."""
    s = np.linspace(0.0, 1.0, intervals + 1)
    exact = np.stack([np.sin(3.0 * s), np.cos(2.0 * s)], axis=-1)
    error = np.stack([1.0 + s**2, np.sin(s)], axis=-1) * (intervals / 16.0) ** -order * 1e-2
    rest = np.stack([np.cos(s), s], axis=-1) * (intervals / 16.0) ** -4 * 1e-3
    return np.stack([exact + error + rest, 2.0 * exact - error])


def exact(intervals: int) -> np.ndarray:
    s = np.linspace(0.0, 1.0, intervals + 1)
    told = np.stack([np.sin(3.0 * s), np.cos(2.0 * s)], axis=-1)
    return np.stack([told, 2.0 * told])


@pytest.mark.parametrize("meshes", [MESHES[:2], MESHES, (16, 64), (16, 64, 128)])
def test_of_order_two_nearly_nothing_is_left_and_that_is_within_its_error(meshes: tuple[int, ...]) -> None:
    ratios = [b // a for a, b in pairwise(meshes)]
    value, error = extrapolate([solution(n) for n in meshes], ratios)
    true = np.abs(value - exact(meshes[-1]))
    assert value.shape == exact(meshes[-1]).shape
    assert true.max() < 0.05 * np.abs(solution(meshes[-1]) - exact(meshes[-1])).max()
    assert (true <= error + 1e-6).all()


def test_where_the_order_does_not_show_nothing_is_extrapolated_and_the_error_is_large() -> None:
    value, error = extrapolate([solution(n, order=0.5) for n in MESHES], [2, 2])
    assert np.array_equal(value, solution(64, order=0.5))
    assert (3.0 * error >= np.abs(value - exact(64))).all()


def test_of_one_mesh_the_error_is_unknown() -> None:
    value, error = extrapolate([solution(16)], [])
    assert np.array_equal(value, solution(16))
    assert np.isnan(error).all()


def test_a_number_has_one_node_on_every_mesh() -> None:
    numbers = [np.array([[[1.0 + 0.1 * 4.0**-k]]]) for k in range(3)]
    value, error = extrapolate(numbers, [2, 2])
    assert value[0, 0, 0] == pytest.approx(1.0, abs=1e-12)
    assert 0.0 < error[0, 0, 0] < 1e-3


def test_the_error_of_the_steps_is_a_third_of_the_difference_only_where_it_falls_so() -> None:
    falling = [exact(16) * (1.0 + 0.01 * 4.0**-k) for k in range(3)]
    told = error_of_steps(falling, shorter=False, nodes=17)
    assert (told >= np.abs(falling[-1] - exact(16)) - 1e-12).all()
    assert told.max() < 0.5 * np.abs(falling[-1] - falling[-2]).max()
    stuck = [exact(16), exact(16) + 0.01, exact(16) + 0.02]
    assert error_of_steps(stuck, shorter=False, nodes=17) == pytest.approx(0.01)


def test_steps_that_hardly_differ_say_less_of_their_error_than_their_difference_is() -> None:
    assert alike(1e5, 2e5) == 1.0
    assert alike(1e5, 1.1e5) == pytest.approx(1.5 / (1.1**4 - 1.0))
    assert alike(1e5, 1e5) == alike(1e5, 0.9e5) == 30.0
