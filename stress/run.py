"""One run of a stress test, in the process that calls it: stepped, watched and judged."""

from __future__ import annotations

import traceback
from math import isfinite
from time import process_time

import numpy as np

from outcomes import Outcome
from service.cases import build_scene, parse_case
from solver import Frame, Run, RunFailed, Scene, Simulation, simulate, warm
from solver.physics.contact.recipe import spaced
from stress.books import Books
from stress.crossing import Crossings
from stress.ending import FAILURES, Ending, Result, Task

SEVERE = (Ending.NOT_FINITE, Ending.CROSSED)
"""Faults that no name excuses."""
WORD = 100
"""Steps within which, and before its next frame, a run that passed through itself ends by that name: the curve between
the nodes, on which the solver looks for it, may do so somewhat later than the straight lines of `crossing`."""
PLACES = 11
"""Of the centreline, equally spaced, that a result keeps."""


def run(task: Task) -> Result:
    """Run a task's case to its end, within its budget, and judge it."""
    warm(task.case.get("numerics", {}).get("method", "box"))
    started = process_time()
    watch: Watch | None = None
    ending, outcome, detail = Ending.CORRECT, "", ""
    try:
        watch = Watch(build_scene(parse_case(task.case)))
        if not watch.follow(task.steps, started + task.cpu):
            ending = Ending.OUT_OF_BUDGET
    except RunFailed as failure:
        ending, outcome, detail = _named(failure)
    except Exception:
        ending, detail = Ending.EXCEPTION, traceback.format_exc(limit=-3)
    if watch is not None and ending is not Ending.EXCEPTION:
        watch.close(outcome)
        fault = watch.books.fault
        if fault is not None and not _excused(ending, fault[0]):
            ending, detail = fault[0], f"{detail} {fault[1]}".strip()
    if watch is None:
        return Result(task.group, task.at, ending, outcome, detail, cpu=process_time() - started, case=task.case)
    statistics, books = watch.simulation.statistics, watch.books
    return Result(
        task.group, task.at, ending, outcome, detail, watch.simulation.t, statistics.steps, statistics.failed_steps,
        process_time() - started, books.balance, books.stretch, books.turns, r=watch.centreline(),
        case=task.case if ending in FAILURES else None,
    )  # fmt: skip


def _excused(ending: Ending, fault: Ending) -> bool:
    """Whether a fault is none, as the run does not claim otherwise.

    One that fails by name claims that its frames are frames, not that they are right. One that was cut off has not come
    to where the solver judges how much energy was lost.
    """
    if ending is Ending.OUT_OF_BUDGET:
        return fault is Ending.LOST_ENERGY
    return ending is Ending.NAMED and fault not in SEVERE


def _named(failure: RunFailed) -> tuple[Ending, str, str]:
    """A failure that says what it is and what to do is a good ending."""
    complete = isfinite(failure.t) and failure.outcome is not Outcome.COMPLETED and failure.outcome.remedy != ""
    return Ending.NAMED if complete else Ending.EXCEPTION, failure.outcome.value, failure.detail


class Watch:
    """A run, and what its frames and steps showed."""

    def __init__(self, scene: Scene) -> None:
        self.simulation: Run = simulate(scene)
        self.books = Books(scene)
        contact = scene.contact
        skip = None if contact is None else spaced(contact, scene.rod).skip
        self._crossings = None if skip is None else Crossings(float(scene.rod.length), skip)
        self._crossed: tuple[float, int] | None = None
        """When (s) it passed through itself, and the steps by then."""
        self._last: Frame | None = None

    def follow(self, steps: int, until: float) -> bool:
        """Step to the end, unless `steps` are taken or the process has used `until` CPU seconds; whether it ended."""
        while not self.simulation.finished:
            if self._crossed is None and (self._tried >= steps or process_time() > until):
                return False
            frame = self.simulation.advance()
            if self._crossed is None:
                self._look_for_crossings()
            elif frame is not None or self.simulation.statistics.steps >= self._crossed[1] + WORD:
                self.close("")
            if frame is not None:
                self._last = frame
                self.books.enter(frame, self.simulation.remarks.end_hops)
            if self.books.fault is not None and self.books.fault[0] in SEVERE:
                return True
        return True

    def close(self, outcome: str) -> None:
        """Judge the whole of a run that ended with this outcome, or with none."""
        self.books.close()
        if self._crossed is not None and outcome != Outcome.ROD_CROSSED_ITSELF.value:
            self.books.fault = Ending.CROSSED, f"between two steps before t = {self._crossed[0]:g} s"

    @property
    def _tried(self) -> int:
        return self.simulation.statistics.steps + self.simulation.statistics.failed_steps

    def centreline(self) -> list[list[float]]:
        """The last frame's centreline at equally spaced places."""
        if self._last is None or not np.isfinite(self._last.r).all():
            return []
        r = self._last.r
        at = np.linspace(0.0, len(r) - 1.0, PLACES)
        return [[float(np.interp(x, np.arange(len(r)), r[:, i])) for i in range(3)] for x in at]

    def _look_for_crossings(self) -> None:
        if self._crossings is None or not isinstance(self.simulation, Simulation):
            return
        if self._crossings.passed(self.simulation._method.fields().r):
            self._crossed = self.simulation.t, self.simulation.statistics.steps
