"""Reading datasets: whole in xarray, or a part as plain data."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from threading import Lock
from typing import TYPE_CHECKING, Any

import netCDF4
import numpy as np
from numpy.typing import NDArray

from service.results.schema import COORDINATES, ERRORS, LABELS, VARIABLES, Variable

if TYPE_CHECKING:
    import xarray as xr

ONE_AT_A_TIME = Lock()
"""The HDF5 library is not thread-safe."""


class UnknownVariable(ValueError):
    """A variable that the dataset does not hold."""


class SubsetTooLarge(ValueError):
    """A subset of more values than are given out at once."""


def open_dataset(path: Path) -> xr.Dataset:
    """The dataset in xarray, its time in seconds since the start; also of one written before time had plain seconds."""
    import xarray as xr  # half a second, which what reads a part alone need not wait for

    return xr.open_dataset(path, engine="netcdf4", decode_times=False)


def subset(
    path: Path,
    variables: Sequence[str],
    t_min: float | None = None,
    t_max: float | None = None,
    s_min: float | None = None,
    s_max: float | None = None,
    time_stride: int = 1,
    s_stride: int = 1,
    limit: int = 1_000_000,
) -> dict[str, Any]:
    """Some variables at the times and arclengths within closed ranges, every stride-th of them.

    Returns JSON data: `coordinates` (time, s and component names as far as they are used) and
    `variables`, each with dimensions, units, long name and nested `values`; null where there is no
    value. Raises UnknownVariable, SubsetTooLarge (more than `limit` values), or ValueError for a
    stride below 1.
    """
    for name, stride in (("time_stride", time_stride), ("s_stride", s_stride)):
        if stride < 1:
            raise ValueError(f"{name} must be >= 1, got {stride}")
    with ONE_AT_A_TIME, netCDF4.Dataset(path) as dataset:
        dataset.set_auto_mask(False)
        chosen = [_variable(dataset, name) for name in variables]
        parts = {
            "time": _part(dataset["time"][:], t_min, t_max, time_stride),
            "s": _part(dataset["s"][:], s_min, s_max, s_stride),
        }
        _check_size(dataset, chosen, parts, limit)
        used = {name for variable in chosen for name in variable.dimensions}
        return {
            "coordinates": {name: _coordinate(dataset, name, parts) for name in sorted(used)},
            "variables": {variable.name: _values(dataset, variable, parts) for variable in chosen},
        }


def _variable(dataset: netCDF4.Dataset, name: str) -> Variable:
    held = {v.name: v for v in (*VARIABLES, *ERRORS.values()) if v.name in dataset.variables}
    if name not in held:
        raise UnknownVariable(f"variable must be one of {', '.join(held)}, got {name!r}")
    return held[name]


def _part(values: NDArray[np.float64], lowest: float | None, highest: float | None, stride: int) -> slice:
    """The indices of an increasing coordinate's values within a closed range."""
    first = 0 if lowest is None else int(np.searchsorted(values, lowest, "left"))
    last = len(values) if highest is None else int(np.searchsorted(values, highest, "right"))
    return slice(first, max(first, last), min(stride, max(1, len(values))))  # netCDF4 takes no stride past 64 bits


def _check_size(
    dataset: netCDF4.Dataset, chosen: Sequence[Variable], parts: dict[str, slice], limit: int
) -> None:
    def length(dimension: str) -> int:
        whole = len(dataset.dimensions[dimension])
        return len(range(*parts.get(dimension, slice(None)).indices(whole)))

    size = sum(int(np.prod([length(name) for name in v.dimensions])) for v in chosen)
    if size > limit:
        raise SubsetTooLarge(
            f"the subset must have at most {limit:,} values, got {size:,}: narrow it or stride"
        )


def _coordinate(dataset: netCDF4.Dataset, name: str, parts: dict[str, slice]) -> dict[str, Any]:
    if name in LABELS:
        return {"values": list(LABELS[name])}
    return {"units": COORDINATES[name]["units"], "values": dataset[name][parts[name]].tolist()}


def _values(dataset: netCDF4.Dataset, variable: Variable, parts: dict[str, slice]) -> dict[str, Any]:
    values = dataset[variable.name][tuple(parts.get(name, slice(None)) for name in variable.dimensions)]
    plain = values.astype(object)
    plain[~np.isfinite(values)] = None
    return {
        "dimensions": list(variable.dimensions),
        "units": variable.units,
        "long_name": variable.long_name,
        "values": plain.tolist(),
    }
