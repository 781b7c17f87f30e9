"""What passed through what: a strand through a strand, or a loop over an end."""

from __future__ import annotations

import numpy as np
import pytest

from solver.arrays import Array
from solver.measures.passages import Passages, Shape, passages

UP = np.array([0.0, 0.0, 1.0])


def hooked(height: float, reach: float) -> Shape:
    """A straight rod of length 1 along e3 that turns back in a wide bow: the bow's last part lies along e1,
    at `height` above the start and at e2 = `reach`; the rod itself is at e2 = 0."""
    straight = [np.array([0.0, 0.0, z]) for z in np.linspace(0.0, 1.0, 21)]
    bow = [np.array([-2.0, 0.0, 1.0]), np.array([-2.0, reach, height])]
    across = [np.array([x, reach, height]) for x in np.linspace(-1.9, 2.0, 40)]
    vertices: Array = np.array([*straight, *bow, *across])
    return Shape(vertices, np.array([UP, [1.0, 0.0, 0.0]]))


@pytest.mark.parametrize(
    ("height", "seen"), [(0.52, Passages(1, 0)), (-0.52, Passages(0, 1)), (3.0, Passages(0, 0))],
    ids=["through the rod", "over the start", "clear of both"],
)  # fmt: skip
def test_a_strand_that_sweeps_across_meets_the_rod_the_ray_or_nothing(height: float, seen: Passages) -> None:
    """The ray goes on below the start, from e3 = 0 down."""
    found = passages(hooked(height, 0.3), hooked(height, -0.3))
    assert Passages(abs(found.crossings), abs(found.hops)) == seen


def test_there_and_back_is_nothing() -> None:
    assert passages(hooked(0.52, 0.3), hooked(0.52, 0.3)) == Passages(0, 0)
