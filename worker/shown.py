"""What readers see of a run that goes on."""

from __future__ import annotations

import time
from collections.abc import Sequence
from pathlib import Path

from service.results import DatasetWriter, live
from service.results.segments import Segment
from solver import Run

FRESH = 1.0
"""Seconds after which new frames are shown, if that takes no more than its share."""
SHARE = 0.05
"""The part of the running time that it may take."""


class Shown:
    """The frames of an attempt, in the directory of its job, as far as readers are told of them."""

    def __init__(self, directory: Path) -> None:
        self._directory = directory
        self._due = 0.0

    @property
    def due(self) -> bool:
        """Whether those since the last renewal are to be shown."""
        return time.monotonic() >= self._due

    def begin(self, segments: Sequence[Segment], run: Run) -> None:
        """Show the frames that this attempt goes on from, and none of another one. Raises OSError."""
        live.hide(self._directory)
        live.show(self._directory, segments, run.s)
        self._due = time.monotonic() + FRESH

    def renew(self, writer: DatasetWriter, run: Run) -> tuple[Segment, ...]:
        """Show all frames so far; gives the segments that hold them. Raises OSError."""
        began = time.monotonic()
        segments = tuple(writer.flush())
        live.show(self._directory, segments, run.s)
        now = time.monotonic()
        self._due = now + max(FRESH, (now - began) / SHARE)
        return segments
