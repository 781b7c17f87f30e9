"""Results as xarray and pandas know them. Needs hockle-client[data]."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from threading import Lock
from typing import TYPE_CHECKING, Any, cast

from hockle_client.schema import CaseSpec

if TYPE_CHECKING:
    import xarray as xr


ONE_AT_A_TIME = Lock()
"""The NetCDF library is not thread-safe, and programs fetch many jobs' values side by side."""


def read(content: bytes, name: str) -> xr.Dataset:
    """What a file's `content` holds, all of it in memory: no file is left open for some thread to close."""
    import netCDF4

    with ONE_AT_A_TIME, netCDF4.Dataset(name, mode="r", memory=content) as file:
        return _opened(file).load()


def opened_file(path: Path) -> xr.Dataset:
    """The dataset in a file, which may be removed as soon as it is open; to be read and closed in one thread."""
    import netCDF4

    with ONE_AT_A_TIME:
        return _opened(netCDF4.Dataset(path))


def _opened(file: Any) -> xr.Dataset:
    import xarray as xr

    store = xr.backends.NetCDF4DataStore(file)  # type: ignore[no-untyped-call]
    return xr.open_dataset(store, decode_times=False)


def part_query(variables: Sequence[str], t_min: float | None = None, t_max: float | None = None,
               s_min: float | None = None, s_max: float | None = None, time_stride: int = 1,
               s_stride: int = 1) -> dict[str, Any]:
    """The query that asks for a part of a dataset."""
    query = {"variables": ",".join(variables), "t_min": t_min, "t_max": t_max, "s_min": s_min, "s_max": s_max,
             "time_stride": time_stride, "s_stride": s_stride}
    return {name: value for name, value in query.items() if value is not None}


def case_of(dataset: xr.Dataset | str | Path) -> CaseSpec:
    """The case that made a dataset, which is open in xarray or lies in a file; `Client.submit` takes it as it is.

    Raises ValueError for a dataset that is not hockle's.
    """
    if isinstance(dataset, (str, Path)):
        import xarray as xr

        with xr.open_dataset(dataset, decode_times=False) as opened:
            return case_of(opened)
    if "case" not in dataset.attrs:
        raise ValueError("the dataset must have the attribute case, which hockle writes")
    return cast(CaseSpec, json.loads(dataset.attrs["case"]))
