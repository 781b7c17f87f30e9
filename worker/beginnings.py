"""States of runs at some of their frames, kept after their end: another job may begin from one.

docs/decisions/0022-shared-beginnings.md
"""

from __future__ import annotations

import logging
import re
from collections.abc import Collection, Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from sqlalchemy.exc import DBAPIError

from service.cases import CaseError, CaseSpec, build_scene, parse_case
from service.cases.beginning import common_frame
from service.jobs import Registry
from service.jobs.held import HeldJob
from service.results import Datasets
from service.results.query import opened
from service.results.schema import stored_variables
from service.results.segments import Block, Segment, write_segment
from solver import Run, code_digest, simulate
from worker.checkpoints import Checkpoint, packed, unpacked

PARTS = (0.25, 0.5, 0.75)
"""Of a run, at which its state is kept besides that before its end."""
WORTH = 1.0
"""Seconds of computing (CPU) from which on a state is kept though nobody waits for it: what took less is as soon
computed again, and its states would take half as much room as its dataset."""
OF_THE_FUTURE = re.compile(r"\._outputs\b|\._control\._events\b|\._switches\b|\._jolts\b|"
                           r"\.(start|end)\._components\b|\.applied\b|\.address$")
"""Where a run holds what comes: the only places where the runs of two cases with one beginning may differ."""
log = logging.getLogger(__name__)


@dataclass(frozen=True)
class Begun:
    """A run on its way, the segments that hold its frames so far, and the steps that others have taken for it."""

    run: Run
    segments: tuple[Segment, ...]
    steps: int


class AnotherBeginning(Exception):
    """A run cannot begin from the state of another: they differ in more than what comes later."""


class Beginnings:
    """The states of one job's run in a directory of theirs, by the numbers of their frames."""

    def __init__(self, directory: Path, key: str, frames: int, followed: Collection[int] = ()) -> None:
        """`key`: the code by which it runs; `followed`: frames from which others will begin."""
        self._directory, self._key = directory, key
        parts = {int(part * (frames - 1)) for part in PARTS} | {frames - 2} | set(followed)
        self._frames = {frame for frame in parts if 0 < frame < frames - 1}
        self._followed = set(followed)

    def keep(self, frame: int, run: Run) -> None:
        """Keep the state at this frame, if it is one of those. A run goes on where that cannot be done."""
        wanted = frame in self._followed or run.statistics.cpu_time >= WORTH
        if frame not in self._frames or not wanted:
            return
        try:
            self._directory.mkdir(mode=0o700, parents=True, exist_ok=True)
            state = Checkpoint(run.statistics.steps, run.checkpoint(), ())
            (self._directory / f"{frame:08d}").write_bytes(packed(state, self._key))  # one that is torn is passed over
        except OSError as error:
            log.warning("the state at frame %d cannot be kept: %s", frame, error)

    def last(self, most: int) -> tuple[int, Mapping[str, Any]] | None:
        """The last state up to the frame `most`, with its frame."""
        for path in sorted(self._directory.glob("[0-9]" * 8), reverse=True):
            if int(path.name) <= most:
                try:
                    return int(path.name), unpacked(path.read_bytes(), self._key).state
                except (OSError, ValueError) as error:
                    log.warning("%s is passed over: %s", path, error)
        return None


def begun(fresh: Mapping[str, Any], other: Mapping[str, Any], reached: Mapping[str, Any]) -> dict[str, Any]:
    """The state of a run that has begun as another one has: what that has changed since its start is as it has
    `reached` it, all the rest as in a `fresh` run. `other` is a fresh run of the other's case.

    Raises AnotherBeginning where the fresh ones differ in more than what comes later.
    """
    state = {}
    for path in sorted(fresh.keys() | reached.keys()):
        changed = path not in other or (path in reached and not _same(reached[path], other[path]))
        apart = path in fresh and path in other and not _same(fresh[path], other[path])
        if apart and not OF_THE_FUTURE.search(path):
            raise AnotherBeginning(f"{path} is another one")
        if path in reached and changed and not apart:
            state[path] = reached[path]
        elif path in fresh:
            state[path] = fresh[path]
    return _switched(state, fresh, other, reached)


def _switched(state: dict[str, Any], fresh: Mapping[str, Any], other: Mapping[str, Any],
              reached: Mapping[str, Any]) -> dict[str, Any]:  # fmt: skip
    """With the switches that are still to come: those of the fresh run less the ones that the other has made."""
    for path in [path for path in fresh if path.endswith("._switches[]")]:
        passed = other[path] - reached[path]
        name = path.removesuffix("[]")
        for item in [item for item in state if item.startswith(f"{name}[") and item != path]:
            del state[item]
        state[path] = fresh[path] - passed
        state |= {f"{name}[{i}]": fresh[f"{name}[{i + passed}]"] for i in range(state[path])}
    return state


def _same(value: Any, other: Any) -> bool:
    if isinstance(value, np.ndarray) or isinstance(other, np.ndarray):
        return np.shape(value) == np.shape(other) and np.array_equal(value, other, equal_nan=True)
    return bool(value == other) or (value != value and other != other)


def begun_with(held: HeldJob, spec: CaseSpec, datasets: Datasets, directory: Path, tag: str) -> Begun | None:
    """The run of a job, as far as that of the job with which it begins has computed it; None if it begins by itself.

    Its frames until then are copied from the other's dataset into `directory`, as a segment of this `tag`. Whatever
    stands in the way, the job is run from its start, which gives the same.
    """
    if held.job.begins_with is None:
        return None
    try:
        return _begun(held, held.job.begins_with, spec, datasets, directory, tag)
    except (AnotherBeginning, CaseError, LookupError, OSError, ValueError, DBAPIError) as error:
        log.warning("job %s does not begin with %s: %s", held.job.id, held.job.begins_with, error)
        with suppress(DBAPIError):
            held.begins_by_itself(f"computed from its start: of job {held.job.begins_with} nothing can be taken over")
        return None


def _begun(held: HeldJob, other_id: str, spec: CaseSpec, datasets: Datasets, directory: Path,
           tag: str) -> Begun:  # fmt: skip
    registry = Registry(held.database)
    other, first = registry.get(other_id), parse_case(registry.case(other_id))
    most = min(held.job.begins_at, common_frame(first, spec))
    beginning = Beginnings(datasets.states(other_id), code_digest(), first.frames).last(most)
    if beginning is None or other.dataset is None:
        raise LookupError("no state or no dataset of it is kept")
    frame, reached = beginning
    run = simulate(build_scene(spec))
    run.restore(begun(run.checkpoint(), simulate(build_scene(first)).checkpoint(), reached))
    path = datasets.file(other.dataset.file, other.dataset.bytes, other.dataset.sha256)
    with opened(path) as source:
        block: Block = {v.name: source.read(v, {"time": slice(frame + 1)}) for v in stored_variables(spec)}
        block["time"] = source.time[: frame + 1]
    return Begun(run, (write_segment(directory, 0, tag, block),), run.statistics.steps)
