"""Runs of a scene at several resolutions, frame by frame, and what their frames say together."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import fields
from typing import Any

from solver.arrays import Array
from solver.measures.frame import Frame, Statistics
from solver.run.run import Run
from solver.scene.scene import Scene

NAMES = tuple(field.name for field in fields(Frame))

Kind = Callable[[Scene, Statistics], Run]
"""What makes the run of a scene, given the account that its cost goes to."""


class SideBySide(Run):
    """Runs with the same output times: none begins a frame before the others have ended the last one."""

    def __init__(self, scenes: Sequence[Scene], kind: Kind, statistics: Statistics | None = None) -> None:
        """`scenes`: the one whose nodes the frames have comes first."""
        super().__init__(scenes[0], statistics)
        self._runs = [kind(scene, self.statistics) for scene in scenes]
        self.remarks = self._runs[0].remarks
        self._waiting: list[list[Any]] = []  # the values of frames, because a checkpoint holds no frames

    @abstractmethod
    def _together(self, *frames: Frame) -> Frame:
        """What the frames of one time say, one of each run."""

    @property
    def s(self) -> Array:
        """Arclengths of the nodes (n,), m."""
        return self._runs[0].s

    def warm(self) -> None:
        """Have every kernel compiled."""
        self._runs[0].warm()

    def _first_frame(self) -> Frame | None:
        return self._advance()

    def _next_frame(self, output: float) -> Frame | None:
        return self._advance()

    def _advance(self) -> Frame | None:
        """Take one step of the run whose turn it is."""
        frame = self._runs[len(self._waiting)].advance()
        self.t = min(run.t for run in self._runs)
        if frame is not None:
            self._waiting.append([getattr(frame, name) for name in NAMES])
        if len(self._waiting) < len(self._runs):
            return None
        frames = [Frame(**dict(zip(NAMES, values, strict=True))) for values in self._waiting]
        self._waiting.clear()
        return self._together(*frames)
