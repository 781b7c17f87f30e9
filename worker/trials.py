"""A run to a tolerance, step by step: states of its attempts are kept, and they begin from those of another's.

Its frames come from all attempts together, so none can be copied from another's dataset; but an attempt at the same
resolution passes through the same states, as long as the cases are the same.
docs/decisions/0022-shared-beginnings.md
"""

from __future__ import annotations

import logging
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from service.cases import CaseSpec, build_scene
from service.jobs.held import HeldJob
from service.results import Datasets
from solver import Frame, Refined, Run, Scene, Trial, UnderWay, code_digest, strides_of
from worker.beginnings import NOTHING_TO_TAKE, Beginnings, Common, begins_by_itself
from worker.merging import AnotherBeginning, begun

WORTH = 0.1
"""Seconds of computing (CPU) from which on the state of an attempt is kept though nobody waits for it. A run to a
tolerance has several attempts of some tenths of a second; one of 0.4 s in all has hardly any that takes so long."""
ROWS = "rows"
log = logging.getLogger(__name__)
Rows = Sequence[NDArray[np.float64]]


class Trials:
    """The states of the attempts of one job's run, those of each in a directory of theirs with the rows of its frames,
    which are written once: of all states, when it ends."""

    def __init__(self, directory: Path, spec: CaseSpec, followed: Collection[int] = ()) -> None:
        """`followed`: frames from which others will begin."""
        self._directory, self._frames, self._followed = directory, spec.frames, followed
        self._strides = strides_of(spec.numerics.tolerance or 1.0)
        self._attempts: dict[Trial, Beginnings] = {}

    def keep(self, attempt: UnderWay, frame: int) -> None:
        """Keep the state of an attempt at this frame, if it is worth it."""
        self._of(attempt.trial).keep(frame, attempt, WORTH)

    def keep_rows(self, trial: Trial, rows: Rows) -> None:
        """Keep the rows of an attempt that has ended, as far as there are states."""
        states = self._of(trial)
        if states.frames:
            states.write(ROWS, {ROWS: np.array(rows[: states.frames[0] + 1])})

    def until(self, trial: Trial, most: int) -> Iterator[tuple[int, Mapping[str, Any], Rows]]:
        """The states of an attempt up to the frame `most`, the last one first: the frame, the state, the rows until
        then."""
        states = self._of(trial)
        kept = states.read(ROWS) if states.frames else None
        rows = [] if kept is None else list(kept[ROWS])
        for frame, state in states.until(min(most, len(rows) - 1)):
            yield frame, state, rows[: frame + 1]

    @property
    def any(self) -> bool:
        """Whether there are any that can be begun from."""
        return any(self._directory.glob(f"*/{ROWS}"))

    def _of(self, trial: Trial) -> Beginnings:
        if trial not in self._attempts:
            directory = self._directory / f"{trial.mesh}.{trial.steps}"
            self._attempts[trial] = Beginnings(directory, code_digest(), self._frames, self._followed, self._strides)
        return self._attempts[trial]


@dataclass(frozen=True)
class Another:
    """The run of another job with which one begins: the states of its attempts up to the frame `most`."""

    trials: Trials
    scene: Scene
    most: int

    @classmethod
    def of(cls, held: HeldJob, other_id: str, spec: CaseSpec, datasets: Datasets) -> Another:
        """Raises what `NOTHING_TO_TAKE` lists."""
        common = Common.of(held, other_id, spec)
        trials = Trials(datasets.states(other_id), common.first)
        if not trials.any:
            raise LookupError("no state of it is kept")
        return cls(trials, build_scene(common.first), common.most)

    def begin(self, run: Refined, attempt: UnderWay) -> None:
        """Have the attempt that the run is about to begin go on from the last state of one like it that it passes
        through. Raises AnotherBeginning, LookupError, ValueError."""
        for frame, reached, rows in self.trials.until(attempt.trial, self.most):
            state = begun(attempt.checkpoint(), UnderWay(self.scene, attempt.trial).checkpoint(), reached)
            if run.begin_from(state, rows):
                log.info("%s begins at frame %d, after %d steps", run.phase, frame, run.statistics.taken_over)
                return


class Steps:
    """Takes the steps of a run to a tolerance."""

    def __init__(self, held: HeldJob, spec: CaseSpec, datasets: Datasets, run: Run) -> None:
        self._held = held
        self._trials = Trials(datasets.states(held.job.id), spec, held.followers())
        self._another: Another | None = None
        if held.job.begins_with is not None:
            try:
                self._another = Another.of(held, held.job.begins_with, spec, datasets)
            except NOTHING_TO_TAKE as error:
                self._in_vain(run, error)

    def advance(self, run: Refined) -> Frame | None:
        """Take one step. Each attempt may begin where another's was; its states are kept, and its rows at its end."""
        before = run.under_way
        if before is None:
            return run.advance()
        if not run.rows:
            self._begin(run, before)
        attempt, rows, passed = run.under_way, run.rows, len(run.rows)
        frame = run.advance()
        now = run.under_way
        if now is None or now is not attempt:
            self._trials.keep_rows(before.trial, rows)
        elif len(rows) > passed:
            self._trials.keep(now, passed)
        if now is None and self._another is not None:
            self._in_vain(run, "no state of the attempts that were made is kept")
        return frame

    def _begin(self, run: Refined, attempt: UnderWay) -> None:
        if self._another is None:
            return
        try:
            self._another.begin(run, attempt)
        except (AnotherBeginning, LookupError, ValueError) as error:
            log.warning("%s begins at its start: %s", run.phase, error)
            self._another = None
            self._in_vain(run, error)

    def _in_vain(self, run: Run, reason: object) -> None:
        """Tell that nothing can be taken over, if nothing has been."""
        if not run.statistics.taken_over:
            begins_by_itself(self._held, reason)
