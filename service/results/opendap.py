"""A dataset by OPeNDAP (DAP 2.0): what there is (.dds), its attributes (.das), and parts of it (.dods)."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from math import prod
from typing import Any
from urllib.parse import unquote

import numpy as np
from numpy.typing import NDArray

from service.results.query import DatasetSource, check_size, unknown
from service.results.schema import COORDINATES, LABELS

LIMIT = 10_000_000
"""The most values that are given out at once; the clients ask for parts."""
TYPES = {"f": ("Float64", ">f8"), "i": ("Int32", ">i4")}
PROJECTION = re.compile(r"(\w+)((?:\[\d+(?::\d+){0,2}\])*)")


class BadConstraint(ValueError):
    """A constraint expression that asks for nothing that is there."""


@dataclass(frozen=True)
class Projection:
    """An array and the part of it that is asked for."""

    name: str
    dimensions: tuple[str, ...]
    kind: str
    slices: tuple[slice, ...]

    @property
    def lengths(self) -> list[int]:
        """Along each dimension."""
        return [len(range(part.start, part.stop, part.step)) for part in self.slices]

    @property
    def declaration(self) -> str:
        """As the structure of the dataset has it."""
        sizes = "".join(f"[{name} = {size}]" for name, size in zip(self.dimensions, self.lengths, strict=True))
        return f"    {TYPES[self.kind][0]} {self.name}{sizes};\n"


class DapDataset:
    """The answers about a dataset that is open, under a name."""

    def __init__(self, name: str, source: DatasetSource) -> None:
        self._name, self._source = name, source

    def dds(self, constraint: str) -> bytes:
        """The arrays that a constraint asks for, all if it is empty. Raises BadConstraint, UnknownVariable."""
        declared = "".join(projection.declaration for projection in self._projections(constraint))
        return f"Dataset {{\n{declared}}} {self._name};\n".encode()

    def das(self) -> bytes:
        """The attributes of all."""
        attributes = {"time": COORDINATES["time"], "s": COORDINATES["s"]} | {
            name: {"units": variable.units, "long_name": variable.long_name}
            for name, variable in self._source.variables.items()}
        parts = {**attributes, "NC_GLOBAL": self._source.attributes}
        lines = [f"    {name} {{\n{_attributes(container)}    }}\n" for name, container in parts.items()]
        return f"Attributes {{\n{''.join(lines)}}}\n".encode()

    def dods(self, constraint: str) -> bytes:
        """The values (XDR). Raises BadConstraint, UnknownVariable, SubsetTooLarge."""
        projections = self._projections(constraint)
        check_size(sum(prod(projection.lengths) for projection in projections), LIMIT)
        return self.dds(constraint) + b"\nData:\n" + b"".join(self._values(projection) for projection in projections)

    def _projections(self, constraint: str) -> list[Projection]:
        decoded = unquote(constraint)
        if not decoded:
            return [self._whole(name) for name in ("time", "s", *self._source.variables)]
        return [self._part(projection) for projection in decoded.split(",")]

    def _whole(self, name: str) -> Projection:
        dimensions: tuple[str, ...] = (name,)
        kind = "f"
        if name in self._source.variables:
            variable = self._source.variables[name]
            dimensions, kind = variable.dimensions, variable.type[0]
        elif name not in ("time", "s"):
            raise unknown(name, ["time", "s", *self._source.variables])
        sizes = {"time": len(self._source.time), "s": len(self._source.s)}
        sizes |= {label: len(labels) for label, labels in LABELS.items()}
        return Projection(name, dimensions, kind, tuple(slice(0, sizes[dimension], 1) for dimension in dimensions))

    def _part(self, projection: str) -> Projection:
        match = PROJECTION.fullmatch(projection)
        if match is None:
            raise BadConstraint(f"a projection is NAME[start:stride:stop]..., got {projection[:80]!r}")
        whole = self._whole(match[1])
        ranges = re.findall(r"\[([\d:]+)\]", match[2])
        if not ranges:
            return whole
        if len(ranges) != len(whole.slices):
            raise BadConstraint(f"{match[1]} has {len(whole.slices)} dimensions, got {projection[:80]!r}")
        slices = tuple(_slice(text, part.stop) for text, part in zip(ranges, whole.slices, strict=True))
        return Projection(whole.name, whole.dimensions, whole.kind, slices)

    def _values(self, projection: Projection) -> bytes:
        count = np.array([prod(projection.lengths)] * 2, ">u4").tobytes()
        return count + self._read(projection).astype(TYPES[projection.kind][1]).tobytes()

    def _read(self, projection: Projection) -> NDArray[Any]:
        if projection.name in ("time", "s"):
            return (self._source.time if projection.name == "time" else self._source.s)[projection.slices[0]]
        slices = dict(zip(projection.dimensions, projection.slices, strict=True))
        return self._source.read(self._source.variables[projection.name], slices)


def _slice(text: str, size: int) -> slice:
    """start:stride:stop, start:stop or one index; the stop is within."""
    numbers = [int(part) for part in text.split(":")]
    start, stride, stop = {1: (numbers[0], 1, numbers[0]), 2: (numbers[0], 1, numbers[-1])}.get(
        len(numbers), tuple(numbers))  # fmt: skip
    if stride < 1 or not start <= stop < size:
        raise BadConstraint(f"[{text}] must lie within the {size} entries of its dimension")
    return slice(start, stop + 1, stride)


def _attributes(attributes: Any) -> str:
    return "".join(_attribute(name, value) for name, value in attributes.items())


def _attribute(name: str, value: Any) -> str:
    if isinstance(value, str):
        return f'        String {name} "{"".join(_escaped(value))}";\n'
    kind = "Int32" if isinstance(value, int) and abs(value) < 2**31 else "Float64"
    return f"        {kind} {name} {value};\n"


def _escaped(text: str) -> Iterator[str]:
    for character in text:
        yield f"\\{character}" if character in '"\\' else character
