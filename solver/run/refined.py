"""A run to a tolerance: the scene on meshes that are twice as fine each, until their differences are small.

None of these runs is a rehearsal: the frames are what the last two or three meshes say together (`richardson`), with
their error as these tell it. What comes next is decided by `plan`. Where the tolerance cannot be had for the work that
may be done, the frames come all the same, with their errors. See docs/decisions/0009-accuracy-on-demand.md.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import astuple, replace
from typing import Any

import numpy as np

from solver.arrays import Array
from solver.measures.frame import Frame, Statistics
from solver.outcome import Outcome, RunFailed
from solver.run.accuracy import QUANTITIES, Accuracy, judge
from solver.run.first_mesh import first_mesh
from solver.run.plan import (
    IN_CONTACT,
    OVERHEAD,
    Excess,
    Trial,
    allowance,
    following,
    intervals_of,
    longest_step,
    step_tolerance,
    to_come,
)
from solver.run.recording import row_of
from solver.run.remarks import Remarks
from solver.run.run import Run
from solver.run.series import Attempt, chosen
from solver.run.simulation import Simulation
from solver.run.together import Piece, Together
from solver.scene.scene import Scene

SMALL_MOTION = 1e-3
"""See `Numerics`: of the waves that a start excites those below it are not followed step by step."""
OUTCOMES = tuple(Outcome)
MOST_ROWS = 1_000_000
"""Nodes times frames that are kept of a run."""


class Refined(Run):
    """A run at the resolutions that its tolerance needs; all of them come before its first frame."""

    def __init__(self, scene: Scene, statistics: Statistics | None = None) -> None:
        super().__init__(scene, statistics)
        self._history: list[tuple[float, ...]] = []
        self._recorded: list[Array] = []
        """The rows of each attempt (frames, ...); none of one that failed once another is complete."""
        self._noticed: list[tuple[float, ...]] = []
        """The remarks of each attempt."""
        self._rows: list[Array] = []
        self._excesses: list[tuple[float, ...]] = [tuple(Excess())] * len(QUANTITIES)
        """Of each quantity what it is beyond the tolerance."""
        self._mesh, self._steps = first_mesh(scene, pressed=False), 0
        self._first_if_pressed = first_mesh(scene, pressed=True)
        self._work, self._progress, self._decided = 0.0, 0.0, False
        self._detail = ""
        self._errors_of_frames = np.zeros((0, len(QUANTITIES)))
        self._piece = Piece()
        self._run = self._begin()

    @property
    def s(self) -> Array:
        """Arclengths of the nodes (n,), m; before the first frame they may be those of a coarser mesh."""
        return self._together.s if self._decided else self._run.s

    @property
    def phase(self) -> str:
        """Which mesh it is at."""
        return f"run {len(self._history) + 1}: {intervals_of(self._mesh)} intervals"

    @property
    def progress(self) -> float:
        """The part of the work that is done, as far as it can be known; it never falls."""
        if self._decided:
            return 1.0
        current, part = self._work, min(self._run.t / self._scene.t_end, 1.0)
        attempts = self._attempts
        spent = sum(attempt.work for attempt in attempts)
        rest = to_come(attempts, self._errors, Trial(self._mesh, self._steps))
        whole = spent + current / max(part, 0.01) + rest
        self._progress = max(self._progress, (spent + current) / max(whole, 1.0))
        return self._progress

    @property
    def chosen(self) -> Scene:
        """A scene whose verified run has the two finest meshes of this one, and steps like these."""
        together = self._together
        steps, mesh = together.finest.steps, together.finest.mesh
        tolerated = step_tolerance(steps, self._scene.numerics.tolerance or 1.0)
        numerics = replace(
            self._scene.numerics, tolerance=None, verify=True, intervals=intervals_of(mesh) // 2,
            dt_max=longest_step(steps, self._scene.output_interval), increment_tolerance=tolerated,
        )  # fmt: skip
        return replace(self._scene, numerics=numerics)

    @property
    def accuracy(self) -> Accuracy | None:
        """The errors of its frames, once these come; None where there are none."""
        if not len(self._errors_of_frames):
            return None
        return judge(self._scene.numerics.tolerance or 0.0, self._errors_of_frames)

    def warm(self) -> None:
        """Have every kernel compiled."""
        self._run.warm()

    def restore(self, checkpoint: Mapping[str, Any]) -> None:
        """Go on where a run of the same scene was; see `Run.restore`."""
        self._mesh, self._steps = checkpoint["._mesh"], checkpoint["._steps"]
        self._run = self._begin()
        super().restore(checkpoint)

    def _begin(self) -> Simulation:
        numerics = replace(
            self._scene.numerics, tolerance=None, verify=False, intervals=intervals_of(self._mesh),
            dt_max=longest_step(self._steps, self._scene.output_interval), small_motion=SMALL_MOTION,
            increment_tolerance=step_tolerance(self._steps, self._scene.numerics.tolerance or 1.0),
        )  # fmt: skip
        return Simulation(replace(self._scene, numerics=numerics), self.statistics, goes_on=True)

    @property
    def _attempts(self) -> list[Attempt]:
        return [Attempt(*row) for row in self._history]  # type: ignore[arg-type]

    @property
    def _errors(self) -> list[Excess]:
        return [Excess(*row) for row in self._excesses]

    @property
    def _most(self) -> int:
        return min(self._scene.numerics.most_intervals, MOST_ROWS // (len(self._outputs) + 1))

    @property
    def _together(self) -> Together:
        return Together(self._scene, self._attempts, self._recorded)

    def _first_frame(self) -> Frame | None:
        if not self._decided:
            self._go_on()
        return self._next_frame(0.0) if self._decided else None

    def _next_frame(self, output: float) -> Frame | None:
        if self._frames >= len(self._errors_of_frames):
            last = self._attempts[-1]
            raise RunFailed(OUTCOMES[int(last.outcome)], last.t, self.statistics.steps, self._detail)
        if not self._piece.holds(self._frames):
            self._piece = self._together.piece(self._frames)
        frame = self._piece.frames[self._frames - self._piece.first]
        self.t = frame.t
        return frame

    def _go_on(self) -> None:
        """Take a step of the attempt under way; where it ends, decide what follows."""
        before = self.statistics.newton_iterations
        try:
            frame = self._run.advance()
        except RunFailed as failure:
            self._detail = failure.detail
            self._ended(failure.t, OUTCOMES.index(failure.outcome), slow=False)
            return
        per_iteration = (intervals_of(self._mesh) + OVERHEAD) * (IN_CONTACT if self._run.presses else 1.0)
        self._work += (self.statistics.newton_iterations - before) * per_iteration
        if frame is not None:
            self._rows.append(row_of(frame))
        if self._run.finished:
            self._ended(self._run.t, OUTCOMES.index(Outcome.COMPLETED), slow=False)
        elif not self._history and self._run.presses and self._first_if_pressed > self._mesh:
            self._ended(self._run.t, OUTCOMES.index(Outcome.MESH_TOO_COARSE), slow=False)
        elif self._work > allowance(self._attempts, Trial(self._mesh, self._steps)):
            self._ended(self._run.t, OUTCOMES.index(Outcome.TOLERANCE_NOT_REACHED), slow=True)

    def _ended(self, t: float, outcome: int, slow: bool) -> None:
        complete = OUTCOMES[outcome] is Outcome.COMPLETED
        self._history.append(tuple(Attempt(self._mesh, self._steps, self._work, t, complete, slow, outcome)))
        self._recorded.append(np.array(self._rows))
        self._noticed.append(astuple(self._run.remarks))
        self._rows, self._work = [], 0.0
        if complete:
            completed = [attempt.complete for attempt in self._attempts]
            self._recorded = [rows if kept else rows[:0] for rows, kept in zip(self._recorded, completed, strict=True)]
            self._excesses = [tuple(excess) for excess in self._together.excesses(self._errors)]
        then = following(self._attempts, self._errors, self._attempts[0].mesh, self._most)
        if then is None:
            self._decided, self._errors_of_frames = True, self._together.errors()
            self.remarks = Remarks(*self._noticed[chosen(self._attempts).finest])  # type: ignore[arg-type]
        else:
            self._mesh, self._steps = then
            self._run = self._begin()
