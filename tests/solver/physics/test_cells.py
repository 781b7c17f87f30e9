"""What a property that varies along the rod counts for in its parts."""

from __future__ import annotations

import numpy as np
import pytest

from solver import Curve
from solver.physics.cells import around_nodes, between_nodes

S = np.linspace(0.0, 2.0, 17)
RNG = np.random.default_rng(7)


def patch(start: float, end: float, ramp: float = 1e-6) -> Curve:
    """1 from start to end, and 0 elsewhere."""
    return Curve.table([start - ramp, start, end, end + ramp], [0.0, 1.0, 1.0, 0.0])


def lengths(cells: str) -> np.ndarray:
    return np.diff(S) if cells == "between" else np.gradient(S) * np.where((S == S[0]) | (S == S[-1]), 0.5, 1.0)


CELLS = {"between": between_nodes, "around": around_nodes}


@pytest.mark.parametrize("cells", CELLS)
@pytest.mark.parametrize("width", [1e-3, 0.02, 0.125, 0.3, 1.1])
def test_a_patch_counts_as_a_whole_wherever_it_lies(cells: str, width: float) -> None:
    for start in RNG.uniform(0.01, 2.0 - width - 0.01, 20):
        profile = patch(start, start + width)
        mean = CELLS[cells](S, profile.corners).mean_of(profile)
        assert mean @ lengths(cells) == pytest.approx(width + 1e-6, rel=1e-9)


def test_a_patch_acts_where_it_lies() -> None:
    for start, width in zip(RNG.uniform(0.01, 1.6, 20), RNG.uniform(1e-3, 0.3, 20), strict=True):
        profile = patch(start, start + width)
        cells = between_nodes(S, profile.corners)
        moment = (cells.mean_of(profile) * 0.5 * (S[1:] + S[:-1]) + cells.arms_of(profile)) @ np.diff(S)
        assert moment == pytest.approx((width + 1e-6) * (start + 0.5 * width), rel=1e-9)


@pytest.mark.parametrize("cells", CELLS)
def test_what_is_smooth_counts_by_its_value_in_the_middle(cells: str) -> None:
    x = np.linspace(0.0, 2.0, 301)
    for profile in (Curve.constant(3.0), Curve.table([0.0, 2.0], [1.0, 4.0]), Curve.table(x, np.cosh(x), "cubic")):
        at = S if cells == "around" else 0.5 * (S[1:] + S[:-1])
        assert CELLS[cells](S, profile.corners).mean_of(profile).tolist() == profile(at).tolist()


def test_a_step_on_a_node_is_no_step_between_nodes() -> None:
    profile = Curve.table([0.0, 1.0, 1.0 + 1e-12, 2.0], [1.0, 1.0, 5.0, 5.0])
    assert between_nodes(S, profile.corners).mean_of(profile).tolist() == [1.0] * 8 + [5.0] * 8


def test_components_of_one_thing_count_together() -> None:
    step = patch(0.52, 0.55)
    cells = around_nodes(S, step.corners)
    both = cells.mean(np.stack([step(cells.points), np.ones(len(cells.points))], axis=1))
    assert (both[:, 0] == cells.mean_of(step)).all()
    assert both[:, 1] == pytest.approx(1.0, rel=1e-15)
