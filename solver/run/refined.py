"""A run to a tolerance: the scene on meshes that are twice as fine each, until their differences are small.

None of these runs is a rehearsal: the frames are what the last two or three meshes say together (`richardson`), with
their error as these tell it. What comes next is decided by `plan`. Where the tolerance cannot be had for the work that
may be done, the frames come all the same, with their errors. See docs/decisions/0009-accuracy-on-demand.md.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import astuple, replace
from typing import Any

import numpy as np

from solver.arrays import Array
from solver.measures.frame import Frame
from solver.outcome import Outcome, RunFailed
from solver.run import budget
from solver.run.accuracy import QUANTITIES, Accuracy, judge
from solver.run.budget import LETTING_GO, allowance
from solver.run.first_mesh import first_intervals, first_mesh
from solver.run.plan import Excess, next_trial, to_come
from solver.run.recording import row_of
from solver.run.remarks import Remarks
from solver.run.run import Run
from solver.run.series import Attempt, chosen
from solver.run.stability import Stability
from solver.run.together import Piece, Together
from solver.run.trial import AT_REST, FIRST_INTERVALS, Trial, grade_of
from solver.run.under_way import UnderWay
from solver.scene.scene import MOST_AT_REST, Scene

OUTCOMES = tuple(Outcome)
MOST_ROWS = 1_000_000
"""Nodes times frames that are kept of a run."""
ALMOST = 0.999
"""The most that is done before the first frame comes: what the last attempt has shown is still to be put together."""


class Refined(Run):
    """A run at the resolutions that its tolerance needs; all of them come before its first frame."""

    def __init__(self, scene: Scene) -> None:
        super().__init__(scene)
        self._history: list[tuple[float, ...]] = []
        self._recorded: list[Array] = []
        """The rows of each attempt (frames, ...); none of one that failed once another is complete."""
        self._noticed: list[tuple[float, ...]] = []
        """The remarks of each attempt."""
        self._rows: list[Array] = []
        """Those of the attempt under way."""
        self._excesses: list[tuple[float, ...]] = [tuple(Excess())] * len(QUANTITIES)
        """Of each quantity what it is beyond the tolerance."""
        self._first_if_pressed = first_mesh(scene, pressed=True)
        self._progress, self._decided = 0.0, False
        self._detail = ""
        self.errors_of_frames = np.zeros((0, len(QUANTITIES)))
        """Of `QUANTITIES`, relative, once the frames come; see `accuracy`."""
        self._piece = Piece()
        self._stability = Stability(scene)
        self._before = replace(self.statistics)
        """What the attempts before that under way have cost."""
        steps = AT_REST if scene.at_rest else 0
        self._under_way = UnderWay(scene, Trial(first_mesh(scene, pressed=False), steps))

    @property
    def s(self) -> Array:
        """Arclengths of the nodes (n,), m; before the first frame they may be those of a coarser mesh."""
        return self._together.s if self._decided else self._under_way.run.s

    @property
    def phase(self) -> str:
        """Which mesh it is at, and whether the rod has an artificial viscosity there."""
        damped = "" if grade_of(self._under_way.trial.steps) is None else ", with viscosity"
        return f"run {len(self._history) + 1}: {len(self._under_way.run.s) - 1} intervals{damped}"

    @property
    def progress(self) -> float:
        """The part of the work that is done, as far as it can be known; it never falls."""
        if self._decided:
            return 1.0
        current, part = self._under_way.work, min(self._under_way.run.t / self._scene.t_end, 1.0)
        attempts = self._attempts
        spent = sum(attempt.work for attempt in attempts)
        rest = to_come(attempts, self._errors, self._under_way.trial)
        whole = spent + current / max(part, 0.01) + rest
        self._progress = max(self._progress, min((spent + current) / max(whole, 1.0), ALMOST))
        return self._progress

    @property
    def accuracy(self) -> Accuracy | None:
        """The errors of its frames, once these come; None where there are none."""
        if not len(self.errors_of_frames):
            return None
        return judge(self._scene.numerics.tolerance or 0.0, self.errors_of_frames)

    def warm(self) -> None:
        """Have every kernel compiled."""
        self._under_way.run.warm()

    @property
    def under_way(self) -> UnderWay | None:
        """The attempt under way, another object for each; None once the last one has ended."""
        return None if self._decided else self._under_way

    @property
    def rows(self) -> Sequence[Array]:
        """Of the attempt under way the frames so far, see `recording`; another list for each."""
        return self._rows

    def begin_from(self, state: Mapping[str, Any], rows: Sequence[Array]) -> bool:
        """Have the attempt under way, which has taken no step yet, go on where that of another run was.

        `state`: what an `UnderWay` of this scene and trial would remember there; `rows`: of its frames until then. All
        is decided as if the steps until then were taken now; False, and nothing is changed, where they would not be
        taken, because this run gives the attempt up before. Raises ValueError where it is no such state.
        """
        begun = UnderWay(self._scene, self._under_way.trial)
        begun.restore(state)
        if self._reason_to_give_up(begun) is not None:
            return False
        self._under_way, self._rows = begun, list(rows)
        self._count()
        self.statistics.cpu_time += begun.statistics.cpu_time
        self.statistics.taken_over += begun.statistics.steps
        return True

    def restore(self, checkpoint: Mapping[str, Any]) -> None:
        """Go on where a run of the same scene was; see `Run.restore`."""
        mesh, steps = (checkpoint[f"._under_way.trial.{name}"] for name in Trial._fields)
        self._under_way = UnderWay(self._scene, Trial(mesh, steps))
        super().restore(checkpoint)

    @property
    def _attempts(self) -> list[Attempt]:
        return [Attempt(*row) for row in self._history]  # type: ignore[arg-type]

    @property
    def _errors(self) -> list[Excess]:
        return [Excess(*row) for row in self._excesses]

    @property
    def _most(self) -> int:
        most = min(self._scene.numerics.most_intervals, MOST_ROWS // (len(self._outputs) + 1))
        if self._scene.at_rest and self._scene.contact is not None:
            most = min(most, MOST_AT_REST)
        return most * FIRST_INTERVALS // first_intervals(self._scene)

    @property
    def _together(self) -> Together:
        return Together(self._scene, self._attempts, self._recorded)

    def _first_frame(self) -> Frame | None:
        if not self._decided:
            self._advance_attempt()
        return self._next_frame(0.0) if self._decided else None

    def _next_frame(self, output: float) -> Frame | None:
        if self._frames >= len(self.errors_of_frames):
            last = self._attempts[-1]
            raise RunFailed(OUTCOMES[int(last.outcome)], last.t, self.statistics.steps, self._detail)
        if not self._piece.holds(self._frames):
            self._piece = self._together.piece(self._frames)
        frame = self._piece.frames[self._frames - self._piece.first]
        self.remarks.disturbance_growth = self._stability.growth_until(self.s, frame)
        self.t = frame.t
        return frame

    def _advance_attempt(self) -> None:
        """Take a step of the attempt under way; where it ends, decide what follows."""
        try:
            frame = self._under_way.advance()
        except RunFailed as failure:
            self._detail = failure.detail
            self._ended(failure.t, failure.outcome)
            return
        self._count()
        if frame is not None:
            self._rows.append(row_of(frame))
        if self._under_way.run.finished:
            self._ended(self._under_way.run.t, Outcome.COMPLETED)
        elif reason := self._reason_to_give_up(self._under_way):
            self._ended(self._under_way.run.t, reason, slow=reason is Outcome.TOLERANCE_NOT_REACHED)

    def _reason_to_give_up(self, attempt: UnderWay) -> Outcome | None:
        """Why an attempt that has come so far does not go on. As it goes on what is no reason yet may become one, but
        none is lost: what is none at a frame was none before."""
        if not self._history and attempt.pressed and self._first_if_pressed > attempt.trial.mesh:
            return Outcome.MESH_TOO_COARSE
        if self._scene.at_rest and not self._rows and attempt.work > LETTING_GO * budget.MOST_WORK:
            return Outcome.EQUILIBRIUM_LOST
        if attempt.work > allowance(self._attempts, attempt.trial, attempt.patience):
            return Outcome.TOLERANCE_NOT_REACHED
        return None

    def _count(self) -> None:
        """Enter what the attempts have cost so far."""
        for name in ("steps", "newton_iterations", "failed_steps"):
            setattr(self.statistics, name, getattr(self._before, name) + getattr(self._under_way.statistics, name))

    def _ended(self, t: float, outcome: Outcome, slow: bool = False) -> None:
        self._count()
        attempt, complete = self._under_way, outcome is Outcome.COMPLETED
        self._history.append(tuple(Attempt(*attempt.trial, attempt.work, t, complete, slow, OUTCOMES.index(outcome))))
        self._recorded.append(np.array(self._rows))
        self._noticed.append(astuple(attempt.run.remarks))
        self._rows, self._before = [], replace(self.statistics)
        if complete:
            completed = [attempt.complete for attempt in self._attempts]
            self._recorded = [rows if kept else rows[:0] for rows, kept in zip(self._recorded, completed, strict=True)]
            self._excesses = [tuple(excess) for excess in self._together.excesses(self._errors)]
            apart = max(excess.mesh for excess in self._errors) * (self._scene.numerics.tolerance or 1.0)
            self._history[-1] = tuple(self._attempts[-1]._replace(apart=apart))
        then = next_trial(self._attempts, self._errors, self._most, self._scene.t_end)
        if then is None:
            self._decided, self.errors_of_frames = True, self._together.errors()
            self.remarks = Remarks(*self._noticed[chosen(self._attempts).finest])  # type: ignore[arg-type]
        else:
            self._under_way = UnderWay(self._scene, then)
