"""Parts of many datasets as one, along a dimension that counts them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import prod
from typing import Any

import numpy as np
from numpy.typing import NDArray

from service.results.part import Column, Part
from service.results.query import check_size
from service.results.schema import LABELS

ALONG = "member"


def combined(parts: Sequence[Part | None], own: Sequence[Column], limit: int, table: bool = False) -> Part:
    """The parts one beside the other; NaN where one has no such time or node, or is not there at all.

    `own`: coordinates along the new dimension. Raises SubsetTooLarge for more than `limit` values, or, for a `table`,
    for as many in it: what has no place along the rod is repeated along it.
    """
    present = [part for part in parts if part is not None]
    axes = _axes(present)
    columns = {column.name: column for part in present for column in part.variables}
    shapes = {name: _shape(column.dimensions, axes) for name, column in columns.items()}
    rows = [name for name in axes if name not in LABELS] if table else []
    check_size(len(parts) * sum(prod(_shape({*column.dimensions, *rows}, axes)) for column in columns.values()), limit)
    coordinates = [Column(name, (name,), values, _attributes(present, name)) for name, values in axes.items()]
    variables = [_stacked(name, parts, axes, shape) for name, shape in shapes.items()]
    return Part((*own, *coordinates), tuple(variables))


def _axes(parts: Sequence[Part]) -> dict[str, NDArray[Any]]:
    """The coordinates of all together."""
    axes: dict[str, NDArray[Any]] = {}
    for part in parts:
        for column in part.coordinates:
            before = axes.get(column.name)
            if before is None or column.name in LABELS:
                axes[column.name] = column.values
            elif not np.array_equal(before, column.values):
                axes[column.name] = np.union1d(before, column.values)
    return axes


def _attributes(parts: Sequence[Part], name: str) -> dict[str, str]:
    return next((dict(c.attributes) for part in parts for c in part.coordinates if c.name == name), {})


def _shape(dimensions: Iterable[str], axes: dict[str, NDArray[Any]]) -> tuple[int, ...]:
    return tuple(len(axes[name]) for name in dimensions)


def _stacked(name: str, parts: Sequence[Part | None], axes: dict[str, NDArray[Any]], shape: tuple[int, ...]) -> Column:
    values = np.full((len(parts), *shape), np.nan)
    sample: Column | None = None
    for number, part in enumerate(parts):
        column = None if part is None else next((v for v in part.variables if v.name == name), None)
        if part is None or column is None:
            continue
        sample = column
        own = {coordinate.name: coordinate.values for coordinate in part.coordinates}
        places = [np.arange(len(own[axis])) if axis in LABELS else np.searchsorted(axes[axis], own[axis])
                  for axis in column.dimensions]  # fmt: skip
        values[number][np.ix_(*places)] = column.values
    assert sample is not None  # noqa: S101  # a name comes from one of the parts
    if sample.values.dtype.kind == "i" and np.isfinite(values).all():
        values = values.astype(sample.values.dtype)
    return Column(name, (ALONG, *sample.dimensions), values, sample.attributes)
