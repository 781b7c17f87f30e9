"""A part of a dataset as bytes: JSON, CSV, NetCDF or Arrow."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from io import BytesIO
from threading import Lock
from typing import Any

import netCDF4
import numpy as np
from numpy.typing import NDArray

from service.results.part import Column, Part

ONE_AT_A_TIME = Lock()
"""The NetCDF library is not thread-safe."""
TEXT, BINARY = 1_000_000, 10_000_000
"""The most values that are given out at once."""


def as_data(part: Part) -> dict[str, Any]:
    """JSON data: `coordinates` and `variables` by name, with nested `values`; null where there is no number."""
    coordinates = {
        column.name: ({} if column.dimensions == (column.name,) else {"dimensions": list(column.dimensions)})
        | {**column.attributes} | {"values": _plain(column.values)} for column in part.coordinates
    }  # fmt: skip
    for coordinate in coordinates.values():
        coordinate.pop("long_name", None)
    variables = {
        column.name: {"dimensions": list(column.dimensions), **column.attributes, "values": _plain(column.values)}
        for column in part.variables
    }  # fmt: skip
    return {"coordinates": coordinates, "variables": variables}


def as_json(part: Part) -> bytes:
    """The same as text."""
    return json.dumps(as_data(part), allow_nan=False, separators=(",", ":")).encode()


def as_csv(part: Part) -> bytes:
    """A table with a head line; nothing stands where there is no number. Numbers have all their digits."""
    columns = list(part.table())
    cells = [[_cell(value) for value in column.values.tolist()] for column in columns]
    lines = [",".join(_quoted(column.name) for column in columns), *map(",".join, zip(*cells, strict=True))]
    return ("\n".join(lines) + "\n").encode()


def as_arrow(part: Part) -> bytes:
    """A table as an Arrow IPC stream; each field has its units and long name as metadata."""
    import nanoarrow as na  # these two take a tenth of a second
    from nanoarrow import ipc

    columns = list(part.table())
    types = {column.name: na.Schema(_type(column.values), metadata=dict(column.attributes)) for column in columns}
    arrays = [na.c_array(_arrow(column.values), types[column.name]) for column in columns]
    rows = len(columns[0].values)
    schema = na.Schema(na.Type.STRUCT, fields=types, metadata=dict(part.attributes))
    table = na.c_array_from_buffers(schema, rows, [None], children=arrays)
    stream = BytesIO()
    with ipc.StreamWriter.from_writable(stream) as writer:
        writer.write_array(table)
    return stream.getvalue()


def as_netcdf(part: Part) -> bytes:
    """A NetCDF-4 file."""
    with ONE_AT_A_TIME:
        file = netCDF4.Dataset("part.nc", "w", format="NETCDF4", memory=1)
        try:
            _fill(file, part)
        except BaseException:
            file.close()  # left open, it would be closed by the garbage collector, in whichever thread that runs
            raise
        return bytes(file.close())


@dataclass(frozen=True)
class Format:
    """A way to give out a part: its media type, the most values, how it is written, and whether that is a table."""

    media_type: str
    limit: int
    write: Callable[[Part], bytes]
    table: bool = False


FORMATS = {
    "json": Format("application/json", TEXT, as_json),
    "csv": Format("text/csv", TEXT, as_csv, table=True),
    "netcdf": Format("application/x-netcdf", BINARY, as_netcdf),
    "arrow": Format("application/vnd.apache.arrow.stream", BINARY, as_arrow, table=True),
}


def _plain(values: NDArray[Any]) -> Any:
    if values.dtype.kind != "f" or np.isfinite(values).all():
        return values.tolist()
    plain = values.astype(object)
    plain[~np.isfinite(values)] = None
    return plain.tolist()


def _cell(value: Any) -> str:
    if isinstance(value, str):
        return _quoted(value)
    return "" if value is None or value != value else repr(value)


def _quoted(text: str) -> str:
    quotes = any(character in text for character in ',"\r\n')
    return '"' + text.replace('"', '""') + '"' if quotes else text


def _type(values: NDArray[Any]) -> Any:
    import nanoarrow as na

    return {"f": na.float64, "i": na.int64 if values.itemsize > 4 else na.int32, "b": na.bool_}.get(
        values.dtype.kind, na.string
    )()


def _arrow(values: NDArray[Any]) -> Any:
    return np.ascontiguousarray(values) if values.dtype.kind in "fi" else values.tolist()


def _fill(file: netCDF4.Dataset, part: Part) -> None:
    file.setncatts({"Conventions": "CF-1.11", **part.attributes})
    auxiliary = [coordinate for coordinate in part.coordinates if coordinate.dimensions != (coordinate.name,)]
    for column in (*part.coordinates, *part.variables):
        _write(file, column)
    for column in part.variables:
        names = [other.name for other in auxiliary if set(other.dimensions) <= set(column.dimensions)]
        if names:
            file[column.name].setncattr("coordinates", " ".join(names))


def _write(file: netCDF4.Dataset, column: Column) -> None:
    for name, size in zip(column.dimensions, column.values.shape, strict=True):
        if name not in file.dimensions:
            file.createDimension(name, size)
    text = column.values.dtype.kind not in "fi"
    variable = file.createVariable(column.name, str if text else column.values.dtype, column.dimensions)
    variable.setncatts(dict(column.attributes))
    variable[:] = column.values.astype(object) if text else column.values
