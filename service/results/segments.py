"""The frames of a running simulation, in closed files, so that memory is bounded."""

from __future__ import annotations

import fcntl
import os
import shutil
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from service.results.schema import Variable
from solver import Frame

SEGMENT_BYTES = 16_000_000
"""Frames are kept in memory until they are this much."""

Block = dict[str, NDArray[Any]]
"""Arrays by variable name, and "time", each with the frames of one segment along its first axis."""


def sync(path: Path) -> None:
    """Bring a file's or a directory's content to the disk."""
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


class Segments:
    """A hidden directory beside `target` with the frames so far.

    The directory is locked while its process lives; what killed processes have left for the same
    target is removed when the next one starts.
    """

    def __init__(self, target: Path, variables: tuple[Variable, ...]) -> None:
        self._variables = variables
        self._waiting: list[Frame] = []
        self._files: list[Path] = []
        self.frames = 0
        prefix = f".{target.name}.work-"
        _remove_abandoned(target.parent, prefix)
        self.directory = Path(tempfile.mkdtemp(prefix=prefix, dir=target.parent))
        self._lock = os.open(self.directory, os.O_RDONLY)
        fcntl.flock(self._lock, fcntl.LOCK_EX)

    def append(self, frame: Frame) -> None:
        """Add one frame; raises OSError where it cannot be written."""
        self._waiting.append(frame)
        self.frames += 1
        if len(self._waiting) * self._frame_bytes() >= SEGMENT_BYTES:
            self.flush()

    def flush(self) -> None:
        """Write the waiting frames into a segment of their own: beside, to the disk, then under its name."""
        if not self._waiting:
            return
        path = self.directory / f"segment-{len(self._files):06d}.npz"
        beside = path.with_suffix(".part")
        with beside.open("wb") as file:
            np.savez(file, **self._block())  # type: ignore[arg-type]  # no variable is named allow_pickle
            file.flush()
            os.fsync(file.fileno())
        beside.replace(path)
        self._files.append(path)
        self._waiting.clear()

    def blocks(self) -> Iterator[Block]:
        """The segments' arrays in order of time; frames that still wait are not among them."""
        for path in self._files:
            with np.load(path) as segment:
                yield {name: segment[name] for name in segment.files}

    def remove(self) -> None:
        """Remove the directory and all that is in it; nothing happens the second time."""
        shutil.rmtree(self.directory, ignore_errors=True)
        if self._lock >= 0:
            os.close(self._lock)
            self._lock = -1

    def _block(self) -> Block:
        block: Block = {v.name: np.array([v.of(f) for f in self._waiting], v.type) for v in self._variables}
        block["time"] = np.array([frame.t for frame in self._waiting])
        return block

    def _frame_bytes(self) -> int:
        return sum(np.asarray(v.of(self._waiting[0])).nbytes for v in self._variables)


def _remove_abandoned(directory: Path, prefix: str) -> None:
    for left in directory.glob(f"{prefix}*"):
        try:
            descriptor = os.open(left, os.O_RDONLY)
        except FileNotFoundError:
            continue  # its process has just ended
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
            shutil.rmtree(left, ignore_errors=True)
        except BlockingIOError:
            pass  # its process lives
        finally:
            os.close(descriptor)
