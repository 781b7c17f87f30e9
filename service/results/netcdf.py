"""One NetCDF-4 file from the segments of a run: written, and read back to be sure."""

from __future__ import annotations

import errno
import platform
import zlib
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from itertools import chain
from math import ceil, prod
from pathlib import Path
from typing import Any, Final

import h5py
import netCDF4
import numpy as np
from numpy.typing import NDArray

from service.results.schema import COORDINATES, LABEL_NAMES, LABELS, Variable
from service.results.segments import Block

CHUNK_BYTES = 250_000
"""Of a chunk: reading one frame unpacks one chunk, and smaller ones would pack little worse but be many."""
LEVEL: Final = 1
PACKED = 0.7
"""A variable is packed where no more than this part of it is left: the digits of a motion in space are hardly less
when they are packed, and that takes as long as a third of its steps."""
CHUNK_CACHE = 4 * CHUNK_BYTES
"""Of a variable, in memory: frames come in order, so what has been written is not needed again."""
Blocks = Callable[[], Iterator[Block]]


@cache
def versions() -> dict[str, str]:
    """The versions of what computed the dataset, as its attributes."""
    versions = {"python_version": platform.python_version()}
    for package in ("hockle", "numpy", "numba", "netCDF4"):
        try:
            versions[f"{package.lower()}_version"] = version(package)
        except PackageNotFoundError:
            versions[f"{package.lower()}_version"] = "not installed"
    return versions


def write(
    path: Path,
    variables: tuple[Variable, ...],
    s: NDArray[np.float64],
    frames: int,
    blocks: Blocks,
    attributes: Mapping[str, Any],
) -> None:
    """Write a dataset of `frames` frames at arclengths `s` (n,) with its global attributes.

    Variables are packed where that pays, as far as the first block tells. Raises OSError where the file cannot be
    written.
    """
    with _library_errors(path), netCDF4.Dataset(path, "w", format="NETCDF4") as dataset:
        dataset.setncatts(attributes)
        _define_coordinates(dataset, s, frames)
        rest = blocks()
        first = next(rest, {})
        for variable in variables:
            _define(dataset, variable, frames, variable.name in first and packs_well(first[variable.name]))
        at = 0
        for block in chain([first] if first else [], rest):
            upto = at + len(block["time"])
            for name, values in block.items():
                dataset[name][at:upto] = values
            at = upto


def verify(path: Path, blocks: Blocks) -> None:
    """Read the file back and compare it with the blocks, bit by bit. Raises OSError where they differ."""
    with _library_errors(path), h5py.File(path) as dataset:
        at = 0
        for block in blocks():
            upto = at + len(block["time"])
            for name, values in block.items():
                if not _same_bits(dataset[name][at:upto], values):
                    raise OSError(errno.EIO, f"{name} was not read back as it was written", str(path))
            at = upto
        if len(dataset["time"]) != at:
            raise OSError(errno.EIO, "the number of frames was not read back as it was written", str(path))


def packs_well(values: NDArray[Any]) -> bool:
    """Whether frames of a variable become much smaller by packing, as far as the middle one tells."""
    if len(values) == 0 or values.ndim == 1:
        return False
    frame = np.ascontiguousarray(values[len(values) // 2])
    shuffled = frame.view(np.uint8).reshape(-1, frame.itemsize).T.tobytes()
    return len(zlib.compress(shuffled, LEVEL)) <= PACKED * len(shuffled)


def _same_bits(array: NDArray[Any], other: NDArray[Any]) -> bool:
    return array.dtype == other.dtype and np.array_equal(_bits(array), _bits(other))


def _bits(array: NDArray[Any]) -> NDArray[Any]:
    """The same as whole numbers: they are equal where their bits are, also where they stand for NaN or zero."""
    return np.ascontiguousarray(array).view(f"u{array.itemsize}")


@contextmanager
def _library_errors(path: Path) -> Iterator[None]:
    """The libraries tell of a full disk by RuntimeError, without its cause, and of what is not there by KeyError."""
    try:
        yield
    except (RuntimeError, KeyError) as error:
        raise OSError(
            errno.EIO, f"no dataset could be written, is the disk full? ({error})", str(path)
        ) from error


def _define_coordinates(dataset: netCDF4.Dataset, s: NDArray[np.float64], frames: int) -> None:
    dataset.createDimension("time", frames)
    dataset.createDimension("s", len(s))
    dataset.createDimension("label", max(len(name) for names in LABELS.values() for name in names))
    for name, attributes in COORDINATES.items():
        dataset.createVariable(name, "f8", (name,), fletcher32=True).setncatts(attributes)
    dataset["s"][:] = s
    for name, labels in LABELS.items():
        dataset.createDimension(name, len(labels))
        variable = dataset.createVariable(name, "S1", (name, "label"))
        variable.setncatts({"long_name": LABEL_NAMES[name], "_Encoding": "ascii"})
        variable[:] = np.array(labels, f"S{len(dataset.dimensions['label'])}")


def _define(dataset: netCDF4.Dataset, variable: Variable, frames: int, packed: bool) -> None:
    rest = [len(dataset.dimensions[name]) for name in variable.dimensions[1:]]
    chunks = ceil(frames * 8 * prod(rest) / CHUNK_BYTES)
    created = dataset.createVariable(
        variable.name,
        variable.type,
        variable.dimensions,
        zlib=packed,
        complevel=LEVEL,
        shuffle=packed,
        fletcher32=True,
        chunk_cache=CHUNK_CACHE,
        chunksizes=(ceil(frames / chunks) if chunks else 1, *rest),
        fill_value=np.nan if variable.type == "f8" else False,
    )
    created.setncatts(
        {"units": variable.units, "long_name": variable.long_name, "coverage_content_type": "modelResult"}
    )
    if variable.frame:
        created.setncattr("frame", variable.frame)
    if variable.ancillary:
        created.setncattr("ancillary_variables", variable.ancillary)
