"""Results as xarray and pandas know them. Needs hockle-client[data]."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

from hockle_client.schema import CaseSpec

if TYPE_CHECKING:
    import xarray as xr


def opened(content: bytes, name: str) -> xr.Dataset:
    """The dataset whose file is `content`; its values are unpacked when they are looked at."""
    import netCDF4
    import xarray as xr

    file = netCDF4.Dataset(name, mode="r", memory=content)
    store = xr.backends.NetCDF4DataStore(file)  # type: ignore[no-untyped-call]
    return xr.open_dataset(store, decode_times=False)


def assembled(part: Mapping[str, Any]) -> xr.Dataset:
    """The dataset that a part of one tells as JSON."""
    import numpy as np
    import xarray as xr

    def array(told: Mapping[str, Any], dimensions: list[str]) -> tuple[list[str], Any, dict[str, str]]:
        values = np.array(told["values"])
        if values.dtype == object:  # null stands where there is no number
            values = values.astype(float)
        return dimensions, values, {name: told[name] for name in ("units", "long_name") if name in told}

    coordinates = {name: array(told, [name]) for name, told in part["coordinates"].items()}
    variables = {name: array(told, told["dimensions"]) for name, told in part["variables"].items()}
    return xr.Dataset(variables, coordinates)


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
