"""Named arrays that are given out together: a part of a dataset, or the numbers of many jobs."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from service.results.schema import LABELS

Attributes = Mapping[str, str]


@dataclass(frozen=True)
class Column:
    """Values over some dimensions; `attributes` are `units`, `long_name` and the like, where there are any."""

    name: str
    dimensions: tuple[str, ...]
    values: NDArray[Any]
    attributes: Attributes = field(default_factory=dict)


@dataclass(frozen=True)
class Part:
    """Variables with the coordinates of their dimensions, and what is said of it as a whole."""

    coordinates: tuple[Column, ...]
    variables: tuple[Column, ...]
    attributes: Attributes = field(default_factory=dict)

    @property
    def rows(self) -> dict[str, int]:
        """The dimensions, with their lengths, that a table of it has a row for each place in: all but components."""
        lengths: dict[str, int] = {}
        for column in (*self.variables, *self.coordinates):
            lengths |= {name: size for name, size in zip(column.dimensions, column.values.shape, strict=True)
                        if name not in LABELS}
        return lengths

    def table(self) -> Iterator[Column]:
        """The same as columns of one length: coordinates first, a column for each component (`r_e1`), and what
        does not depend on a dimension repeated along it."""
        rows = self.rows
        for column in (*self.coordinates, *self.variables):
            if column.name not in LABELS:
                yield from _flat(column, rows)


def _flat(column: Column, rows: dict[str, int]) -> Iterator[Column]:
    own = [name for name in column.dimensions if name not in LABELS]
    labels = [name for name in column.dimensions if name in LABELS]
    for number, label in enumerate(LABELS[labels[0]] if labels else ("",)):
        values = column.values[..., number] if labels else column.values
        places = tuple(size if name in own else 1 for name, size in rows.items())
        whole = np.broadcast_to(values.reshape(places), tuple(rows.values())).ravel()
        yield Column(f"{column.name}_{label}" if label else column.name, ("row",), whole, column.attributes)
