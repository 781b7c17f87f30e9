"""The frames of a running simulation, in closed files, so that memory is bounded and a run can go on from them."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from service.results.durable import sha256_of, write_whole
from service.results.schema import Variable
from solver import Frame

SEGMENT_BYTES = 16_000_000
"""Frames are kept in memory until they are this much."""

Block = dict[str, NDArray[Any]]
"""Arrays by variable name, and "time", each with the frames of one segment along its first axis."""


@dataclass(frozen=True)
class Segment:
    """A closed file of frames, by its name in the directory of the run."""

    name: str
    frames: int
    sha256: str

    def is_whole(self, directory: Path) -> bool:
        """Whether the file is there as it was written."""
        path = directory / self.name
        return path.is_file() and sha256_of(path) == self.sha256


def write_segment(directory: Path, first: int, tag: str, block: Block) -> Segment:
    """Write frames, of which the first has that number. Raises OSError."""
    content = BytesIO()
    np.savez(content, **block)  # type: ignore[arg-type]  # no variable is named allow_pickle
    name = f"segment-{first:08d}.{tag}.npz"
    write_whole(directory / name, content.getbuffer())
    return Segment(name, len(block["time"]), hashlib.sha256(content.getbuffer()).hexdigest())


class Segments:
    """The frames so far, in `directory`. A run that goes on has `written` segments already.

    `tag` tells this writer's files from those of other attempts at the same run.
    """

    def __init__(self, directory: Path, variables: tuple[Variable, ...], tag: str,
                 written: Sequence[Segment] = ()) -> None:
        self._directory, self._variables, self._tag = directory, variables, tag
        self.written = list(written)
        self.frames = sum(segment.frames for segment in written)
        self._waiting: list[Frame] = []
        self._joined: Block = {}
        self._frame_bytes = 0

    def append(self, frame: Frame) -> None:
        """Add one frame; raises OSError where it cannot be written."""
        self._frame_bytes = self._frame_bytes or sum(np.asarray(v.of(frame)).nbytes for v in self._variables)
        self._waiting.append(frame)
        self._joined = {}
        self.frames += 1
        if self.waiting >= SEGMENT_BYTES:
            self.flush()

    @property
    def waiting(self) -> int:
        """Bytes of the frames that are in no segment yet."""
        return len(self._waiting) * self._frame_bytes

    def flush(self) -> None:
        """Write the waiting frames into a segment of their own."""
        if not self._waiting:
            return
        first = self.frames - len(self._waiting)
        self.written.append(write_segment(self._directory, first, self._tag, self._block()))
        self._waiting.clear()
        self._joined = {}

    def blocks(self) -> Iterator[Block]:
        """The arrays of all frames in order of time: those of the segments, then those that wait."""
        for segment in self.written:
            with np.load(self._directory / segment.name) as arrays:
                yield {name: arrays[name] for name in arrays.files}
        if self._waiting:
            yield self._block()

    def _block(self) -> Block:
        """Those that wait, joined once: a dataset is written from them, and then compared with them."""
        if not self._joined:
            block: Block = {v.name: np.array([v.of(f) for f in self._waiting], v.type) for v in self._variables}
            self._joined = block | {"time": np.array([frame.t for frame in self._waiting])}
        return self._joined
