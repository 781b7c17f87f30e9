"""What the registry says of a job."""

from __future__ import annotations

import hashlib
import itertools
import json
import os
import secrets
import time
from dataclasses import InitVar, dataclass, field
from functools import cached_property
from typing import Any

from service.jobs.lifecycle import Status

CROCKFORD = "0123456789abcdefghjkmnpqrstvwxyz"
_SECRET, _DRAWN = secrets.token_bytes(32), itertools.count()
LOCAL = "local"
"""The owner of what is submitted without a key."""


@dataclass(frozen=True)
class Dataset:
    """A published file, by its name in the directory of datasets.

    `stamp`: what the file looked like when it was known to be good (service.results.durable.stamp_of), empty if nobody
    has looked, or it is an object. `fault`: why it cannot be read any more, empty if it can.
    """

    file: str
    sha256: str
    bytes: int
    stamp: str = ""
    fault: str = ""


@dataclass(frozen=True)
class Drift:
    """How far a run by `method` has drifted from what the physics keeps: |Tw + Wr - Lk| (turn), and its energy
    balance over the energy that changed its form; None where a run does not tell."""

    method: str
    topology: float | None = None
    energy: float | None = None


@dataclass(frozen=True)
class Webhook:
    """Whom to tell of a job's end: how often that was tried, what the last try was answered, and when the next one is
    (Unix seconds; None: never)."""

    url: str
    tries: int = 0
    answer: str = ""
    due: float | None = 0.0


LEAST_PROGRESS = 0.01
"""The part of a run that must be done before its remaining time is told."""
LEAST_MEMORY = 64_000_000
"""Bytes; below, the libraries that compile and solve end the process themselves, without a name for it."""


@dataclass(frozen=True)
class Limits:
    """What a job may use before it is ended by name: seconds of running, bytes of memory and of disk."""

    wall: float = 7 * 86400.0
    memory: int = 4 * 10**9
    disk: int = 20 * 10**9

    def __post_init__(self) -> None:
        for name, least in (("wall", 0.0), ("memory", LEAST_MEMORY), ("disk", 0)):
            if not getattr(self, name) >= least:
                raise ValueError(f"{name} must be >= {least}, got {getattr(self, name)}")


@dataclass(frozen=True)
class NewJob:
    """A case that somebody wants run. `title` is what lists show, `label` what its owner sorts by.

    Among the jobs of one owner the higher `priority` goes first; it takes nothing from other owners. `begins_with`: a
    job whose run is also that of this one, up to its frame `begins_at`; `waits`: for its end.
    `message` is shown until it ends.
    """

    case: InitVar[dict[str, Any]]
    title: str = ""
    owner: str = LOCAL
    label: str = ""
    priority: int = 0
    limits: Limits = Limits()
    id: str = field(default_factory=lambda: new_id())
    begins_with: str | None = None
    begins_at: int = 0
    waits: bool = False
    message: str = ""
    case_json: str = field(init=False)
    """The case as canonical JSON: equal cases give equal text. A thousand texts are held with less ado than as data."""

    def __post_init__(self, case: dict[str, Any]) -> None:
        text = json.dumps(case, sort_keys=True, separators=(",", ":"), allow_nan=False)
        object.__setattr__(self, "case_json", text)

    @cached_property
    def case_sha256(self) -> str:
        """The hash that equal cases share."""
        return hashlib.sha256(self.case_json.encode()).hexdigest()


@dataclass(frozen=True)
class Reached:
    """How far a run has come: the part done (0 to 1), simulated seconds, steps of the solver that count
    and that were lost with their worker and computed again, seconds of running, and what it is doing, in words."""

    progress: float = 0.0
    t: float = 0.0
    steps: int = 0
    steps_redone: int = 0
    wall: float = 0.0
    phase: str = ""


@dataclass(frozen=True)
class Job:
    """One row of the registry, without its case. Times are Unix seconds.

    `version` grows with every change that a reader can see. `epoch` grows with every claim and when a
    lost job is taken back: a writer that holds an older one has lost the job. `attempts` counts the
    claims, but for those handed back; `fruitless` those since the last new checkpoint. `attributes`: what its run
    says of itself as a whole, by the names that its dataset has for it. A `pinned` job is deleted by nobody.
    `begins_with`: the job whose run is also that of this one, up to its frame `begins_at`.
    """

    id: str
    owner: str
    status: Status
    title: str
    label: str
    priority: int
    case_sha256: str
    reached: Reached
    outcome: str
    message: str
    cancel_requested: bool
    created: float
    started: float | None
    finished: float | None
    attempts: int
    fruitless: int
    epoch: int
    lease_until: float | None
    version: int
    worker: str
    limits: Limits
    pinned: bool
    deleted: float | None
    deleted_by: str
    dataset: Dataset | None
    attributes: dict[str, float | int | str]
    webhook: Webhook | None = None
    begins_with: str | None = None
    begins_at: int = 0

    @property
    def progress(self) -> float:
        """The part of the run that is done, 0 to 1."""
        return self.reached.progress

    @property
    def t(self) -> float:
        """How far the run has come, in simulated seconds."""
        return self.reached.t

    @property
    def phase(self) -> str:
        """What its run is doing, in a few words; nothing where it does not run."""
        return self.reached.phase if self.status is Status.RUNNING else ""

    @property
    def remaining(self) -> float | None:
        """Seconds that the rest of the run takes if it goes on as so far; None where that cannot be known."""
        progress = self.reached.progress
        if self.status is not Status.RUNNING or progress < LEAST_PROGRESS:
            return None
        return self.reached.wall * (1.0 - progress) / progress


def new_id() -> str:
    """An identifier that sorts by time and cannot be guessed: 48 bits of milliseconds, 10 of microseconds in them, so
    that jobs are run as they were handed in, and 70 random ones.

    They are drawn without asking the system each time: a thread that does waits for its turn behind all others.
    """
    drawn = hashlib.blake2b(b"%d %d" % (os.getpid(), next(_DRAWN)), key=_SECRET, digest_size=10).digest()
    milliseconds, microseconds = divmod(time.time_ns() // 1000, 1000)
    number = milliseconds << 80 | microseconds << 70 | int.from_bytes(drawn) >> 10
    return "".join(CROCKFORD[number >> shift & 31] for shift in range(125, -5, -5))
