"""The frames of a rod for ParaView: a PVD file that names a VTP file (a line with what is stored along it) for each
time, in a ZIP archive."""

from __future__ import annotations

import zipfile
from collections.abc import Iterator, Mapping, Sequence
from io import BytesIO
from math import prod
from typing import Any

import numpy as np
from numpy.typing import NDArray

from service.results.query import Source, UnknownVariable, check_size
from service.results.schema import LABELS, Variable

LIMIT = 20_000_000
"""The most values that are given out at once."""
BLOCK = 2_000_000
"""Values that are read at once: a dataset is unpacked in chunks of many frames."""
NAMES = {"f8": "Float64", "i8": "Int64"}
PVD = """<?xml version="1.0"?>
<VTKFile type="Collection" version="1.0" byte_order="LittleEndian">
<Collection>
{}</Collection>
</VTKFile>
"""
HEAD = """<?xml version="1.0"?>
<VTKFile type="PolyData" version="1.0" byte_order="LittleEndian" header_type="UInt64">
<PolyData>
<FieldData>
<DataArray type="Float64" Name="TimeValue" NumberOfTuples="1" format="ascii">{time!r}</DataArray>
</FieldData>
<Piece NumberOfPoints="{points}" NumberOfLines="1" NumberOfVerts="0" NumberOfStrips="0" NumberOfPolys="0">
"""
TAIL = '</Piece>\n</PolyData>\n<AppendedData encoding="raw">\n_'


def vtk_archive(source: Source, radius: NDArray[np.float64], time_stride: int = 1) -> bytes:
    """Every `time_stride`-th frame. `radius` (n,), m, is an array of the line, for ParaView's tubes.

    Raises UnknownVariable where no positions were stored, SubsetTooLarge.
    """
    if "r" not in source.variables:
        raise UnknownVariable("output.fields must have r for VTK, and has no r")
    times = source.time.tolist()
    frames = range(0, len(times), time_stride)
    along = [variable for variable in source.variables.values() if variable.along_rod]
    frame_size = len(source.s) * sum(_components(variable) for variable in along)
    check_size(len(frames) * frame_size, LIMIT)
    archive = BytesIO()
    with zipfile.ZipFile(archive, "w") as file:
        sets = [f'<DataSet timestep="{times[frame]!r}" part="0" file="{_name(frame)}"/>\n' for frame in frames]
        file.writestr("rod.pvd", PVD.format("".join(sets)))
        for frame, values in _read(source, along, frames, max(1, BLOCK // frame_size)):
            file.writestr(_name(frame), _vtp(times[frame], values, radius))
    return archive.getvalue()


def _read(source: Source, variables: Sequence[Variable], frames: range,
          at_once: int) -> Iterator[tuple[int, dict[str, NDArray[Any]]]]:  # fmt: skip
    """The values of each frame by name, with its number; so many frames are read at once."""
    for first in range(0, len(frames), at_once):
        part = frames[first : first + at_once]
        blocks = {v.name: source.read(v, {"time": slice(part.start, part.stop, part.step)}) for v in variables}
        for place, frame in enumerate(part):
            yield frame, {name: block[place] for name, block in blocks.items()}


def _components(variable: Variable) -> int:
    return prod(len(LABELS[name]) for name in variable.dimensions if name in LABELS)


def _name(frame: int) -> str:
    return f"frames/{frame:06d}.vtp"


def _vtp(time: float, values: Mapping[str, NDArray[Any]], radius: NDArray[np.float64]) -> bytes:
    points = values["r"]
    data = {**{name: value for name, value in values.items() if name != "r"}, "radius": radius}
    blocks: list[bytes] = []
    parts = [
        HEAD.format(time=time, points=len(points)),
        "<PointData>\n", *(_array(name, array, blocks) for name, array in data.items()), "</PointData>\n",
        "<Points>\n", _array("Points", points, blocks), "</Points>\n",
        "<Lines>\n", _array("connectivity", np.arange(len(points)), blocks),
        _array("offsets", np.array([len(points)]), blocks), "</Lines>\n", TAIL,
    ]  # fmt: skip
    return "".join(parts).encode() + b"".join(blocks) + b"\n</AppendedData>\n</VTKFile>\n"


def _array(name: str, values: NDArray[Any], blocks: list[bytes]) -> str:
    """The declaration of an array, whose values are added to the blocks."""
    offset = sum(len(block) for block in blocks)
    packed = values.astype(values.dtype.newbyteorder("<")).tobytes()
    blocks.append(len(packed).to_bytes(8, "little") + packed)
    components = f' NumberOfComponents="{values.shape[1]}"' if values.ndim > 1 else ""
    kind = NAMES[f"{values.dtype.kind}{values.dtype.itemsize}"]
    return f'<DataArray type="{kind}" Name="{name}"{components} format="appended" offset="{offset}"/>\n'
