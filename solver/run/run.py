"""What every run of a scene is to those who watch it: frames, step by step, interrupted and resumed at will."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping
from time import process_time
from typing import Any

from solver.arrays import Array
from solver.measures.frame import Frame, Statistics
from solver.run.accuracy import Accuracy
from solver.run.checkpoint import Saved, restore, saved
from solver.run.remarks import Remarks
from solver.scene.scene import Scene


class Run(ABC):
    """A run: an iterable of `Frame`, once. Raises `RunFailed` where it cannot go on.

    `t` (s): how far it has come; `statistics`: what it has cost, which runs that are parts of one have in common;
    `remarks`: what it noticed.
    """

    def __init__(self, scene: Scene, statistics: Statistics | None = None) -> None:
        self._scene, self._outputs = scene, scene.outputs
        self.statistics = statistics or Statistics()
        self.remarks = Remarks()
        self.t = 0.0
        self._frames = 0

    @property
    @abstractmethod
    def s(self) -> Array:
        """Arclengths of the nodes (n,), m."""

    @abstractmethod
    def warm(self) -> None:
        """Have every kernel compiled."""

    @abstractmethod
    def _first_frame(self) -> Frame | None:
        """Take a step towards the start, at t = 0; give its frame when it is reached."""

    @abstractmethod
    def _next_frame(self, output: float) -> Frame | None:
        """Take a step towards the time `output`; give its frame when it is reached."""

    def __iter__(self) -> Iterator[Frame]:
        while not self.finished:
            frame = self.advance()
            if frame is not None:
                yield frame

    @property
    def phase(self) -> str:
        """What it is doing, in a few words."""
        return "running"

    @property
    def progress(self) -> float:
        """The part of its work that is done, from 0 to 1, as far as it can be known."""
        return min(self.t / self._scene.t_end, 1.0)

    @property
    def accuracy(self) -> Accuracy | None:
        """The errors of its frames, where it was to keep a tolerance and these have come."""
        return None

    def notes(self) -> list[str]:
        """What a user is to read of it, sentence by sentence."""
        return [*([self.accuracy.sentence()] if self.accuracy else []), *self.remarks.sentences()]

    def attributes(self) -> dict[str, float | int | str]:
        """What a dataset of it says of it as a whole, by name."""
        taken_over = {"steps_taken_over": self.statistics.taken_over} if self.statistics.taken_over else {}
        return {**(self.accuracy.attributes() if self.accuracy else {}), **self.remarks.attributes(), **taken_over}

    @property
    def finished(self) -> bool:
        """Whether the last frame has been given."""
        return self._frames > len(self._outputs)

    def advance(self) -> Frame | None:
        """Take one step; give the frame where it ends, if one is due there. The first one starts, at t = 0."""
        if self._frames == 0:
            self.warm()
        started = process_time() - self.statistics.cpu_time
        frame = self._next_frame(self._outputs[self._frames - 1]) if self._frames else self._first_frame()
        if frame is not None:
            self._frames += 1
        self.statistics.cpu_time = process_time() - started
        return frame

    def checkpoint(self) -> Saved:
        """All that this run remembers, as arrays and numbers by name."""
        return saved(self)

    def restore(self, checkpoint: Mapping[str, Any]) -> None:
        """Go on where a run of the same scene, by the same code, was: bit by bit as it would have.

        That scene and code are the same is for the caller to know; ValueError is raised where it shows.
        """
        restore(self, checkpoint)
