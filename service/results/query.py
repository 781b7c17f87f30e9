"""Reading datasets: whole in xarray, or some variables over ranges of time and arclength."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from math import prod
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

import h5py
import numpy as np
from numpy.typing import NDArray

from service.cases.suggestions import did_you_mean
from service.results.part import Column, Part
from service.results.schema import COORDINATES, ERRORS, LABELS, VARIABLES, Variable

if TYPE_CHECKING:
    import xarray as xr

class UnknownVariable(ValueError):
    """A variable that the dataset does not hold."""


class NoFrames(ValueError):
    """A run that failed before its first frame."""


class SubsetTooLarge(ValueError):
    """A subset of more values than are given out at once."""


@dataclass(frozen=True)
class Ranges:
    """Closed ranges of time (s) and arclength (m), and every how many-th value in them. Raises ValueError."""

    t_min: float | None = None
    t_max: float | None = None
    s_min: float | None = None
    s_max: float | None = None
    time_stride: int = 1
    s_stride: int = 1

    def __post_init__(self) -> None:
        for name in ("time_stride", "s_stride"):
            if getattr(self, name) < 1:
                raise ValueError(f"{name} must be >= 1, got {getattr(self, name)}")

    def of(self, time: NDArray[np.float64], s: NDArray[np.float64]) -> dict[str, slice]:
        """The indices along both coordinates."""
        return {"time": _slice(time, self.t_min, self.t_max, self.time_stride),
                "s": _slice(s, self.s_min, self.s_max, self.s_stride)}


class Source(Protocol):
    """Frames that can be read: those of a dataset, or those so far of a run."""

    @property
    def time(self) -> NDArray[np.float64]:
        """Times of the frames (frames,), s."""

    @property
    def s(self) -> NDArray[np.float64]:
        """Arclengths of the nodes (n,), m."""

    @property
    def variables(self) -> Mapping[str, Variable]:
        """Those that it holds, by name."""

    def read(self, variable: Variable, ranges: Mapping[str, slice]) -> NDArray[Any]:
        """The values of one variable at some indices of time and s."""


def open_dataset(path: Path) -> xr.Dataset:
    """The dataset in xarray, its time in seconds since the start; also of one written before time had plain seconds."""
    import xarray as xr  # half a second, which what reads a part alone need not wait for

    return xr.open_dataset(path, engine="netcdf4", decode_times=False)


class DatasetSource:
    """The frames of a dataset that is open."""

    def __init__(self, file: h5py.File) -> None:
        self._file = file
        self.time: NDArray[np.float64] = file["time"][:]
        self.s: NDArray[np.float64] = file["s"][:]
        self.variables = {v.name: v for v in (*VARIABLES, *ERRORS.values()) if v.name in file}

    @property
    def attributes(self) -> dict[str, Any]:
        """Those of the dataset as a whole, as plain data."""
        stored = {name: value for name, value in self._file.attrs.items() if not name.startswith("_")}
        return {name: value.decode() if isinstance(value, bytes) else value.item() for name, value in stored.items()}

    def read(self, variable: Variable, ranges: Mapping[str, slice]) -> NDArray[Any]:
        """The values of one variable at some indices of time and s."""
        indices = tuple(ranges.get(name, slice(None)) for name in variable.dimensions)
        values: NDArray[Any] = self._file[variable.name][indices]
        return values


@contextmanager
def opened(path: Path) -> Iterator[DatasetSource]:
    """The frames of the dataset in a file, by HDF5 alone: the NetCDF library looks at every variable to open one."""
    with h5py.File(path) as file:
        yield DatasetSource(file)


def subset(source: Source, names: Sequence[str], ranges: Ranges = Ranges(), limit: int = 1_000_000,
           table: bool = False) -> Part:
    """Some variables over ranges of time and arclength, with the coordinates that they need.

    Raises UnknownVariable, or SubsetTooLarge for more than `limit` values, before anything is read. `table`: as many
    as its table has, in which what has no place along the rod is repeated along it.
    """
    variables = [variable_named(source.variables, name) for name in dict.fromkeys(names)]
    indices = ranges.of(source.time, source.s)
    lengths = _lengths(source, indices)
    used = list(dict.fromkeys(name for variable in variables for name in variable.dimensions))
    rows = [name for name in used if name not in LABELS] if table else []
    check_size(sum(prod(lengths[name] for name in {*variable.dimensions, *rows}) for variable in variables), limit)
    return Part(tuple(coordinate(source, name, indices) for name in used),
                tuple(column(variable, source.read(variable, indices)) for variable in variables))


def variable_named(variables: Mapping[str, Variable], name: str) -> Variable:
    """The variable of this name. Raises UnknownVariable."""
    if name not in variables:
        raise unknown(name, list(variables))
    return variables[name]


def unknown(name: str, names: Sequence[str]) -> UnknownVariable:
    """What is told of a variable that is none of these."""
    return UnknownVariable(f"variable must be one of {', '.join(names)}, got {name!r}{did_you_mean(name, names)}")


def check_size(size: int, limit: int) -> None:
    """Raises SubsetTooLarge."""
    if size > limit:
        raise SubsetTooLarge(f"the subset must have at most {limit:,} values, got {size:,}: narrow it or stride")


def column(variable: Variable, values: NDArray[Any]) -> Column:
    """Values of a variable."""
    return Column(variable.name, variable.dimensions, values,
                  {"units": variable.units, "long_name": variable.long_name})


def coordinate(source: Source, name: str, indices: Mapping[str, slice]) -> Column:
    """The values of one dimension at some indices."""
    if name in LABELS:
        return Column(name, (name,), np.array(LABELS[name]))
    values = source.time if name == "time" else source.s
    return Column(name, (name,), values[indices[name]], COORDINATES[name])


def _lengths(source: Source, indices: Mapping[str, slice]) -> dict[str, int]:
    whole = {"time": len(source.time), "s": len(source.s)}
    return {name: len(range(*indices[name].indices(size))) for name, size in whole.items()} | {
        name: len(labels) for name, labels in LABELS.items()
    }


def _slice(values: NDArray[np.float64], lowest: float | None, highest: float | None, stride: int) -> slice:
    """The indices of an increasing coordinate's values within a closed range."""
    first = 0 if lowest is None else int(np.searchsorted(values, lowest, "left"))
    last = len(values) if highest is None else int(np.searchsorted(values, highest, "right"))
    return slice(first, max(first, last), min(stride, max(1, len(values))))  # HDF5 takes no stride past 64 bits
