"""The frames so far of a run that goes on, read from the segments that its worker has closed.

They hold the bits that the dataset will hold: it is put together from them.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from service.results.durable import write_whole
from service.results.schema import ERRORS, VARIABLES, Variable
from service.results.segments import Segment

INDEX = "frames.json"


def show(directory: Path, segments: Sequence[Segment], s: NDArray[np.float64]) -> None:
    """Tell readers which segments in the directory of a run hold its frames, whose nodes are at `s`. Raises OSError."""
    if not segments:
        return
    index = {"segments": [asdict(segment) for segment in segments], "s": s.tolist()}
    write_whole(directory / INDEX, json.dumps(index).encode())


def hide(directory: Path) -> None:
    """Tell them that there is no frame yet."""
    (directory / INDEX).unlink(missing_ok=True)


@dataclass(frozen=True)
class LiveSource:
    """The frames that `show` has told of."""

    directory: Path
    segments: tuple[Segment, ...]
    s: NDArray[np.float64]

    @classmethod
    def of(cls, directory: Path) -> LiveSource:
        """The frames in a directory now. Raises FileNotFoundError where there is none yet, or no more."""
        index = json.loads((directory / INDEX).read_bytes())
        return cls(directory, tuple(Segment(**segment) for segment in index["segments"]), np.array(index["s"]))

    @cached_property
    def time(self) -> NDArray[np.float64]:
        """Times of the frames (frames,), s."""
        return self._joined("time", slice(None), ())

    @cached_property
    def variables(self) -> Mapping[str, Variable]:
        """Those that the run stores, by name."""
        names = self._names()
        return {v.name: v for v in (*VARIABLES, *ERRORS.values()) if v.name in names}

    def read(self, variable: Variable, ranges: Mapping[str, slice]) -> NDArray[Any]:
        """The values of one variable at some indices of time and s."""
        rest = tuple(ranges.get(name, slice(None)) for name in variable.dimensions[1:])
        return self._joined(variable.name, ranges["time"], rest)

    def _names(self) -> set[str]:
        with np.load(self.directory / self.segments[0].name) as arrays:
            return set(arrays.files)

    def _joined(self, name: str, frames: slice, rest: tuple[slice, ...]) -> NDArray[Any]:
        """The values of some frames, of which no segment is opened that holds none."""
        total = sum(segment.frames for segment in self.segments)
        indices, first = np.arange(total)[frames], 0
        parts: list[NDArray[Any]] = []
        for segment in self.segments:
            here = indices[(indices >= first) & (indices < first + segment.frames)] - first
            if len(here) or (segment is self.segments[-1] and not parts):  # none at all: the shape is that of none
                with np.load(self.directory / segment.name) as arrays:
                    parts.append(arrays[name][(here, *rest)] if rest else arrays[name][here])
            first += segment.frames
        return np.concatenate(parts)
