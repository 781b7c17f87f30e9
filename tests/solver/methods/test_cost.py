"""How long steps take, as runs to a tolerance count it."""

from __future__ import annotations

import pytest

from solver.methods.cost import ABOUT_AXIS, IN_SPACE, STRETCHED


def test_it_grows_with_intervals_steps_iterations_points_and_pairs() -> None:
    one = IN_SPACE.of(20, 1, 3, 0, 0)
    assert IN_SPACE.of(20, 10, 30, 0, 0) == pytest.approx(10.0 * one)
    assert one < IN_SPACE.of(40, 1, 3, 0, 0) < 2.0 * one
    assert one < IN_SPACE.of(20, 1, 4, 0, 0) < 4.0 / 3.0 * one
    assert IN_SPACE.of(20, 1, 2, 0, 0, rough=True) == IN_SPACE.of(20, 1, 2, 0, 0)
    assert one < IN_SPACE.of(20, 1, 3, 0, 0, rough=True)
    assert one < IN_SPACE.of(20, 1, 3, 100, 0) < IN_SPACE.of(20, 1, 3, 100, 5) < IN_SPACE.of(20, 1, 3, 100, 500)


@pytest.mark.parametrize("intervals", [16, 1024])
def test_a_rod_about_one_axis_is_cheaper_than_one_in_space_and_one_that_stretches_dearer(intervals: int) -> None:
    about_axis, in_space, stretched = (cost.of(intervals, 1, 4, 0, 0) for cost in (ABOUT_AXIS, IN_SPACE, STRETCHED))
    assert about_axis < in_space < stretched
