"""States of runs at some of their frames, kept after their end: another job may begin from one.

docs/decisions/0022-shared-beginnings.md
"""

from __future__ import annotations

import logging
from collections.abc import Collection, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from sqlalchemy.exc import DBAPIError

from service.cases import CaseError, CaseSpec, build_scene, parse_case
from service.cases.beginning import common_frame
from service.jobs import Job, Registry
from service.jobs.held import HeldJob
from service.results import Datasets
from service.results.query import opened
from service.results.schema import stored_variables
from service.results.segments import Block, Segment, write_segment
from solver import Run, UnderWay, code_digest, simulate
from worker.checkpoints import Checkpoint, packed, unpacked
from worker.merging import AnotherBeginning, begun

PARTS = (0.25, 0.5, 0.75)
"""Of a run, at which its state is kept besides that before its end."""
WORTH = 1.0
"""Seconds of computing (CPU) from which on a state is kept though nobody waits for it: what took less is as soon
computed again, and its states would take half as much room as its dataset."""
NOTHING_TO_TAKE = (AnotherBeginning, CaseError, LookupError, OSError, ValueError, DBAPIError)
"""What is raised where a run cannot begin with another: it is run from its start, and gives the same."""
log = logging.getLogger(__name__)


@dataclass(frozen=True)
class Begun:
    """A run on its way, and the segments that hold its frames so far."""

    run: Run
    segments: tuple[Segment, ...]


class Beginnings:
    """The states of a run in a directory of theirs, by the numbers of their frames."""

    def __init__(self, directory: Path, key: str, frames: int, followed: Collection[int] = (), every: int = 1) -> None:
        """`key`: the code by which it runs; `followed`: frames from which others will begin; `every`: how many frames
        apart those are at which steps end."""
        self._directory, self._key = directory, key
        self._followed = {frame - frame % every for frame in followed}
        parts = {int(part * (frames - 1)) for part in PARTS} | {frames - 2}
        wanted = {frame - frame % every for frame in parts} | self._followed
        self._wanted = {frame for frame in wanted if 0 < frame < frames - 1}

    def keep(self, frame: int, run: Run | UnderWay, worth: float) -> None:
        """Keep the state at this frame, if it is one of those, and waited for or `worth` it (s of computing). A run
        goes on where that cannot be done."""
        if frame in self._wanted and (frame in self._followed or run.statistics.cpu_time >= worth):
            self.write(f"{frame:08d}", run.checkpoint(), run.statistics.steps)

    def write(self, name: str, state: Mapping[str, Any], steps: int = 0) -> None:
        """Write a file that has the run's key: one that is torn is passed over."""
        try:
            self._directory.mkdir(mode=0o700, parents=True, exist_ok=True)
            (self._directory / name).write_bytes(packed(Checkpoint(steps, state, ()), self._key))
        except OSError as error:
            log.warning("%s cannot be kept: %s", self._directory / name, error)

    def read(self, name: str) -> Mapping[str, Any] | None:
        """What was written by that name, if it is whole and of this code."""
        path = self._directory / name
        try:
            return unpacked(path.read_bytes(), self._key).state
        except (OSError, ValueError) as error:
            log.warning("%s is passed over: %s", path, error)
            return None

    @property
    def frames(self) -> list[int]:
        """Those of which there are states, the last one first."""
        return sorted((int(path.name) for path in self._directory.glob("[0-9]" * 8)), reverse=True)

    def until(self, most: int) -> Iterator[tuple[int, Mapping[str, Any]]]:
        """The states up to the frame `most`, with their frames; the last one first."""
        for frame in self.frames:
            if frame <= most and (state := self.read(f"{frame:08d}")) is not None:
                yield frame, state


def begun_with(held: HeldJob, spec: CaseSpec, datasets: Datasets, directory: Path, tag: str) -> Begun | None:
    """The run of a job, as far as that of the job with which it begins has computed it; None if it begins by itself.

    Its frames until then are copied from the other's dataset into `directory`, as a segment of this `tag`. Whatever
    stands in the way, the job is run from its start, which gives the same.
    """
    if held.job.begins_with is None:
        return None
    try:
        return _begun(Common.of(held, held.job.begins_with, spec), spec, datasets, directory, tag)
    except NOTHING_TO_TAKE as error:
        begins_by_itself(held, error)
        return None


def begins_by_itself(held: HeldJob, reason: object) -> None:
    """Tell that nothing of the job with which it was to begin is taken over."""
    log.warning("job %s does not begin with %s: %s", held.job.id, held.job.begins_with, reason)
    with suppress(DBAPIError):
        held.begins_by_itself(f"computed from its start: of job {held.job.begins_with} nothing can be taken over")


@dataclass(frozen=True)
class Common:
    """What a job has in common with the one with which it begins: `most` is the last frame."""

    other: Job
    first: CaseSpec
    most: int

    @classmethod
    def of(cls, held: HeldJob, other_id: str, spec: CaseSpec) -> Common:
        """Raises CaseError, LookupError, DBAPIError."""
        registry = Registry(held.database)
        other, first = registry.get(other_id), parse_case(registry.case(other_id))
        return cls(other, first, min(held.job.begins_at, common_frame(first, spec)))


def _begun(common: Common, spec: CaseSpec, datasets: Datasets, directory: Path, tag: str) -> Begun:
    other, first = common.other, common.first
    beginning = next(Beginnings(datasets.states(other.id), code_digest(), first.frames).until(common.most), None)
    if beginning is None or other.dataset is None:
        raise LookupError("no state or no dataset of it is kept")
    frame, reached = beginning
    run = simulate(build_scene(spec))
    run.restore(begun(run.checkpoint(), simulate(build_scene(first)).checkpoint(), reached))
    run.statistics.taken_over = run.statistics.steps
    path = datasets.file(other.dataset.file, other.dataset.bytes, other.dataset.sha256)
    with opened(path) as source:
        block: Block = {v.name: source.read(v, {"time": slice(frame + 1)}) for v in stored_variables(spec)}
        block["time"] = source.time[: frame + 1]
    return Begun(run, (write_segment(directory, 0, tag, block),))
