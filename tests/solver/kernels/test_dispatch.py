"""A kernel that asks for a function gets the one that belongs to its record, or none is compiled."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np
import pytest
from numba.core.errors import TypingError

from solver.arrays import Array
from solver.kernels.dispatch import dispatched, enter, variant
from solver.kernels.kernel import kernel


class Square(NamedTuple):
    side: float


class Polygon(NamedTuple):
    sides: Array


class Circle(NamedTuple):
    radius: float


@dispatched
def perimeter(shape: Any, scale: float) -> float:
    """Of a shape."""
    raise NotImplementedError


@variant(perimeter, Square)
@kernel
def of_square(shape: Square, scale: float) -> float:
    return 4.0 * scale * shape.side


@kernel
def of_polygon(shape: Polygon, scale: float) -> float:
    return float(scale * shape.sides.sum())


@kernel
def twice(shape: Any) -> float:
    return perimeter(shape, 2.0)


enter(SimpleNamespace(perimeter=perimeter), (Polygon,), SimpleNamespace(perimeter=of_polygon))  # type: ignore[arg-type]


def test_the_record_says_which_kernel_is_meant() -> None:
    assert twice(Square(3.0)) == 24.0
    assert twice(Polygon(np.array([1.0, 2.0, 4.0]))) == 14.0


def test_a_record_that_nothing_answers_for_is_refused() -> None:
    with pytest.raises(TypingError, match="perimeter"):
        twice(Circle(1.0))
