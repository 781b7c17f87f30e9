"""One attempt at a job: from its newest checkpoint, if it has one, to its dataset."""

from __future__ import annotations

import logging
import shutil
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TypeVar

from sqlalchemy.exc import DBAPIError

from outcomes import Outcome
from service.cases import CaseSpec, build_scene, estimate, parse_case
from service.jobs import Dataset, Drift, Reached, Status
from service.jobs.held import HeldJob
from service.results import Datasets, DatasetWriter, StoreUnreachable
from service.results.durable import size_of
from service.results.scalars import Value, last_of, series_of
from service.results.segments import Segment
from service.settings import Settings
from solver import Frame, Refined, Run, RunFailed, code_digest, simulate
from worker import beginnings, stopping
from worker.beginnings import Beginnings, begun_with
from worker.checkpoints import Checkpoint, Checkpoints
from worker.drift import drift_of
from worker.endings import LEAST_FREE, Ending, OutOfDisk, is_full
from worker.lease import Lease
from worker.lock import JobLock
from worker.shown import Shown
from worker.trials import Steps

log = logging.getLogger(__name__)
Result = TypeVar("Result")

SHARE = 0.05
"""The part of the running time that checkpoints may take."""
LEAST_BUDGET = 60.0
"""Seconds of computing that every run may take, however little was estimated."""
ROOM_WITHIN, LOOK_AGAIN = 600.0, 1.0
"""Seconds for which a run waits on a full disk before it is given up, and between two looks at it."""


def dataset_file(job_id: str, epoch: int) -> str:
    """The name of what an attempt publishes: no attempt writes over another's file."""
    return f"{job_id}.{epoch}.nc"


def work_directory(settings: Settings, job_id: str) -> Path:
    """Where the attempts at a job leave what they have reached."""
    return settings.work / job_id


def _check_budget(run: Run, budget: float) -> None:
    spent = run.statistics.cpu_time
    if spent > budget:
        detail = f"{spent:.0f} s of computing, {run.progress:.0%} done"
        raise RunFailed(Outcome.ESTIMATE_EXCEEDED, run.t, run.statistics.steps, detail)


class Attempt:
    """Runs a held job. The lease is told of every step, the lock's next holder too, should this one die."""

    def __init__(self, held: HeldJob, lease: Lease, lock: JobLock, settings: Settings) -> None:
        self._held, self._lease, self._lock = held, lease, lock
        self._interval, self._overrun = settings.checkpoint, settings.overrun
        self._directory = work_directory(settings, held.job.id)
        self._datasets = Datasets(settings.datasets, settings.copies, settings.objects)
        self._path = self._datasets.place(dataset_file(held.job.id, held.job.epoch), self._directory)
        key = f"{held.job.case_sha256} {code_digest()}"
        self._checkpoints = Checkpoints(self._directory, held.job.epoch, key)
        self._redone = 0
        self._due = 0.0
        self._shown = Shown(self._directory)
        self._beginnings: Beginnings | None = None
        self._steps: Steps | None = None

    def run(self) -> Ending:
        """Compute the frames and put the dataset together. Raises whatever else ends a run."""
        self._with_room(lambda: self._directory.mkdir(mode=0o700, parents=True, exist_ok=True))
        spec = parse_case(self._held.case)
        simulation, segments = self._start(spec)
        self._share(spec, simulation)
        self._with_room(lambda: self._shown.begin(segments, simulation))
        with DatasetWriter(self._path, spec, self._directory, segments) as writer:
            status, outcome, message = Status.SUCCESSFUL, Outcome.COMPLETED, ""
            try:
                self._compute(simulation, writer, max(self._overrun * estimate(spec).seconds, LEAST_BUDGET))
            except RunFailed as failure:
                status, outcome, message = Status.FAILED, failure.outcome, str(failure)
            self._check_size(writer)
            message = " ".join([message, *simulation.notes()]).strip()
            published = self._with_room(lambda: writer.publish(outcome.value, message, simulation))
        dataset = Dataset(self._path.name, published.sha256, published.bytes, self._datasets.stamp(self._path.name))
        drift, scalars = self._numbers(spec)
        return Ending(status, outcome, message, dataset, drift, simulation.attributes(), scalars)

    def _share(self, spec: CaseSpec, simulation: Run) -> None:
        """Have the run keep states from which others may begin; one to a tolerance begins with others as it goes."""
        if spec.numerics.tolerance is not None:
            self._steps = Steps(self._held, spec, self._datasets, simulation)
        elif spec.analysis == "dynamic":
            states = self._datasets.states(self._held.job.id)
            self._beginnings = Beginnings(states, code_digest(), spec.frames, self._held.followers())

    def _start(self, spec: CaseSpec) -> tuple[Run, tuple[Segment, ...]]:
        """The run, where it goes on or begins, and its frames until then."""
        checkpoint, begun = self._checkpoints.newest(), None
        if checkpoint is None and spec.numerics.tolerance is None:
            begun = begun_with(self._held, spec, self._datasets, self._directory, self._path.stem)
        self._tell_lost(checkpoint.steps if checkpoint else begun.run.statistics.steps if begun else 0)
        if begun is not None:
            return begun.run, begun.segments
        simulation = simulate(build_scene(spec))
        if checkpoint is not None:
            simulation.restore(checkpoint.state)
        return simulation, checkpoint.segments if checkpoint else ()

    def publish(self) -> None:
        """Have the dataset lie where all can read it. Raises whatever ends a run."""
        self._with_room(lambda: self._datasets.publish(self._path))

    def _compute(self, simulation: Run, writer: DatasetWriter, budget: float) -> None:
        """Raises RunFailed also where it takes more than `budget` (s of computing, with what attempts before took)."""
        self._due = time.monotonic() + self._interval
        self._tell(simulation)
        under_way = False
        while not simulation.finished:
            frame = self._advance(simulation)
            if not under_way:
                under_way = True
                log.info("under way", extra={"t": simulation.t, "steps": simulation.statistics.steps})
            if frame is not None:
                self._keep(simulation, writer, frame)
                if self._beginnings is not None:
                    self._beginnings.keep(writer.frames - 1, simulation, beginnings.WORTH)
            steps = simulation.statistics.steps
            self._lock.mark(steps)
            self._tell(simulation)
            if not simulation.finished:
                _check_budget(simulation, budget)
            try:
                self._check_stop(simulation)
            except stopping.Stopping:
                self._save(simulation, writer)
                raise
            if time.monotonic() >= self._due:
                self._save(simulation, writer)

    def _advance(self, simulation: Run) -> Frame | None:
        if self._steps is not None and isinstance(simulation, Refined):
            return self._steps.advance(simulation)
        return simulation.advance()

    def _check_stop(self, simulation: Run) -> None:
        """After a step, so that each attempt gets on. Raises Stopping."""
        stopping.check()
        if self._lease.gives_way and not simulation.finished:
            raise stopping.Stopping("it gives way to others")

    def _tell(self, run: Run) -> None:
        self._lease.tell(Reached(run.progress, run.t, run.statistics.steps, self._redone, phase=run.phase))

    def _keep(self, simulation: Run, writer: DatasetWriter, frame: Frame) -> None:
        try:
            writer.append(frame)
            if self._shown.due:
                self._shown.renew(writer, simulation)
        except OSError:  # the frame itself is in memory
            self._with_room(writer.flush)

    def _save(self, simulation: Run, writer: DatasetWriter) -> None:
        """Write a checkpoint, and put off the next one the longer the longer it took.

        A run whose checkpoint cannot be written goes on: it may still come to its end.
        """
        began = time.monotonic()
        try:
            segments = self._shown.renew(writer, simulation)
            self._checkpoints.save(Checkpoint(simulation.statistics.steps, simulation.checkpoint(), segments))
            self._held.checkpointed(self._lease.reached)
        except (OSError, DBAPIError) as error:
            log.warning("job %s: no checkpoint could be written: %s", self._held.job.id, error)
        self._check_size(writer)
        now = time.monotonic()
        self._due = now + max(self._interval, (now - began) / SHARE)

    def _with_room(self, write: Callable[[], Result]) -> Result:
        """What `write` makes, once there is room for it: hours of computing may be worth minutes of waiting.

        What fails is tried once more in any case: the disk may have been full, and have room again by now.
        Raises what `write` does, and whatever else ends a run.
        """
        deadline = time.monotonic() + ROOM_WITHIN
        failed = False
        while True:
            try:
                return write()
            except OSError as error:
                waits = isinstance(error, StoreUnreachable) or is_full(error, self._path.parent)
                if time.monotonic() >= deadline or (failed and not waits):
                    raise
                log.warning("job %s waits for room: %s", self._held.job.id, error)
            failed = True
            self._wait_for_room(deadline)

    def _wait_for_room(self, deadline: float) -> None:
        """Wait until all that the run has written so far would fit once more."""
        needed = LEAST_FREE + size_of(self._directory)
        while True:
            self._lease.tell(self._lease.reached)
            stopping.check()
            time.sleep(LOOK_AGAIN)
            if shutil.disk_usage(self._path.parent).free >= needed or time.monotonic() >= deadline:
                return

    def _check_size(self, writer: DatasetWriter) -> None:
        if size_of(self._directory) + writer.waiting > self._held.job.limits.disk:
            raise OutOfDisk

    def _numbers(self, spec: CaseSpec) -> tuple[Drift | None, dict[str, Value]]:
        """The drift and the last values of what is published. A run is not lost because they cannot be read now; who
        asks for the values then reads the dataset."""
        method = "static" if spec.analysis == "static" else spec.numerics.method
        try:
            series = series_of(self._path)
            return drift_of(series, method), last_of(series)
        except (OSError, MemoryError):
            log.exception("job %s: its drift and last values cannot be read from its dataset", self._held.job.id)
            return None, {}

    def _tell_lost(self, steps: int) -> None:
        """Tell of the steps that were taken already, but after those that this attempt begins with: they are lost with
        their worker."""
        before = self._held.job.reached
        self._redone = before.steps_redone + max(max(before.steps, self._lock.left) - steps, 0)
        if self._held.job.epoch > 1:
            self._lock.mark(steps)
            self._lease.tell(replace(before, steps=steps, steps_redone=self._redone))
            try:
                self._lease.renew()
            except DBAPIError as error:  # the lease goes on trying by itself
                log.warning("job %s: what was lost cannot be told yet: %s", self._held.job.id, error)
