"""The last values of variables that have no place along the rod."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from service.results.part import Column
from service.results.query import opened, unknown
from service.results.schema import ERRORS, LABELS, VARIABLES, Variable

Value = float | int | list[float | None] | None
"""A number, the components of a vector, or nothing."""
BY_NAME = {variable.name: variable for variable in (*VARIABLES, *ERRORS.values()) if not variable.along_rod}
SCALARS = tuple(BY_NAME)


def scalar_variables(names: Sequence[str]) -> list[str]:
    """The names, if they all are of such variables. Raises UnknownVariable."""
    for name in names:
        if name not in SCALARS:
            raise unknown(name, SCALARS)
    return list(names)


def series_of(path: Path) -> dict[str, NDArray[Any]]:
    """The values in time of those that a dataset holds."""
    with opened(path) as source:
        return {name: source.read(source.variables[name], {}) for name in SCALARS if name in source.variables}


def last_of(series: Mapping[str, NDArray[Any]]) -> dict[str, Value]:
    """The last values; None where there are none."""
    return {name: _plain(series[name][-1]) if len(series.get(name, ())) else None for name in SCALARS}


def last_values(path: Path, names: Sequence[str]) -> dict[str, Value]:
    """The values of the last frame; None for what the dataset does not hold, and where there is no number."""
    with h5py.File(path) as file:
        frames = len(file["time"])
        values = {name: file[name][-1] for name in names if frames and name in file}
    return {name: _plain(values[name]) if name in values else None for name in names}


def scalar_columns(names: Sequence[str], values: Sequence[Mapping[str, Value]],
                   along: str = "job") -> tuple[Column, ...]:
    """The last values of many jobs as arrays along one dimension; NaN where there is none."""
    return tuple(_column(BY_NAME[name], [row[name] for row in values], along) for name in names)


def _column(variable: Variable, values: Sequence[Value], along: str) -> Column:
    components = variable.dimensions[1:]
    nothing = np.full([len(LABELS[name]) for name in components], np.nan)
    rows = [nothing if value is None else np.array(value, float) for value in values]
    array = np.stack(rows) if rows else np.zeros((0, *nothing.shape))
    attributes = {"units": variable.units, "long_name": variable.long_name}
    return Column(variable.name, (along, *components), array, attributes)


def _plain(value: NDArray[np.float64]) -> Value:
    plain = np.asarray(value).astype(object)
    plain[~np.isfinite(value)] = None
    number: Value = plain.tolist()
    return number
