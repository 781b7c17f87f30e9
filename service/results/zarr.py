"""A dataset as a Zarr store (version 3), made of its file as it is read: metadata, and chunks of whole frames."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from math import ceil, prod
from typing import Any

import numpy as np
from numpy.typing import NDArray

from service.results.query import DatasetSource
from service.results.schema import COORDINATES, LABEL_NAMES, LABELS, Variable

CHUNK_BYTES = 1_000_000
CHUNK = re.compile(r"(\w+)/c((?:/\d+)+)")
TYPES = {"f8": "float64", "i4": "int32"}


class NoSuchKey(LookupError):
    """A store has no such key."""


@dataclass(frozen=True)
class Array:
    """An array of the store: its shape, and its chunks of so many entries of its first dimension."""

    dimensions: tuple[str, ...]
    shape: tuple[int, ...]
    rows: int
    type: Any
    fill: Any
    attributes: dict[str, Any]
    read: Callable[[slice], NDArray[Any]]

    @property
    def metadata(self) -> dict[str, Any]:
        """Its `zarr.json`."""
        return {
            "zarr_format": 3, "node_type": "array", "shape": self.shape, "data_type": self.type,
            "chunk_grid": {"name": "regular", "configuration": {"chunk_shape": [self.rows, *self.shape[1:]]}},
            "chunk_key_encoding": {"name": "default", "configuration": {"separator": "/"}},
            "codecs": [{"name": "bytes", "configuration": {"endian": "little"}}], "fill_value": self.fill,
            "dimension_names": self.dimensions, "attributes": self.attributes, "storage_transformers": [],
        }  # fmt: skip

    def chunk(self, place: list[int]) -> bytes:
        """The chunk at a place in the grid, filled up at the end. Raises NoSuchKey."""
        if len(place) != len(self.shape) or any(place[1:]) or place[0] >= ceil(self.shape[0] / self.rows):
            raise NoSuchKey
        values = self.read(slice(place[0] * self.rows, (place[0] + 1) * self.rows))
        missing = self.rows - len(values)
        if missing:
            values = np.concatenate([values, np.zeros((missing, *values.shape[1:]), values.dtype)])
        return values.astype(values.dtype.newbyteorder("<")).tobytes()


class ZarrStore:
    """The keys of a store over a dataset that is open."""

    def __init__(self, source: DatasetSource) -> None:
        self._source = source

    def get(self, key: str) -> bytes:
        """What lies at a key. Raises NoSuchKey."""
        if key == "zarr.json":
            return json.dumps(self._group).encode()
        name, _, rest = key.partition("/")
        if name not in self._arrays:
            raise NoSuchKey(key)
        if rest == "zarr.json":
            return json.dumps(self._arrays[name].metadata).encode()
        chunk = CHUNK.fullmatch(key)
        if chunk is None:
            raise NoSuchKey(key)
        return self._arrays[name].chunk([int(part) for part in chunk[2].split("/")[1:]])

    @property
    def _group(self) -> dict[str, Any]:
        arrays = {name: array.metadata for name, array in self._arrays.items()}
        return {"zarr_format": 3, "node_type": "group", "attributes": self._source.attributes,
                "consolidated_metadata": {"kind": "inline", "must_understand": False, "metadata": arrays}}

    @cached_property
    def _arrays(self) -> dict[str, Array]:
        arrays = {name: _numbers((name,), values, COORDINATES[name])
                  for name, values in (("time", self._source.time), ("s", self._source.s))}
        used = {name for variable in self._source.variables.values() for name in variable.dimensions}
        arrays |= {name: _texts(name) for name in LABELS if name in used}
        return arrays | {name: self._array(variable) for name, variable in self._source.variables.items()}

    def _array(self, variable: Variable) -> Array:
        sizes = {"time": len(self._source.time), "s": len(self._source.s)}
        sizes |= {name: len(labels) for name, labels in LABELS.items()}
        shape = tuple(sizes[name] for name in variable.dimensions)
        rows = max(1, min(shape[0], CHUNK_BYTES // (8 * prod(shape[1:]))))
        attributes = {"units": variable.units, "long_name": variable.long_name}
        fill = "NaN" if variable.type == "f8" else 0
        return Array(variable.dimensions, shape, rows, TYPES[variable.type], fill, attributes,
                     lambda frames: self._source.read(variable, {"time": frames}))


def _numbers(dimensions: tuple[str, ...], values: NDArray[np.float64], attributes: dict[str, str]) -> Array:
    rows = max(1, len(values))
    return Array(dimensions, values.shape, rows, "float64", "NaN", dict(attributes), lambda part: values[part])


def _texts(name: str) -> Array:
    values = np.array(LABELS[name])
    kind = {"name": "fixed_length_utf32", "configuration": {"length_bytes": values.itemsize}}
    return Array((name,), values.shape, len(values), kind, "", {"long_name": LABEL_NAMES[name]},
                 lambda part: values[part])
