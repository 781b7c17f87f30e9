"""What the server says, as it says it. What a newer server says beside is left out."""

from __future__ import annotations

from datetime import datetime
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict

Status = Literal["accepted", "running", "successful", "failed", "dismissed"]
ENDED = ("successful", "failed", "dismissed")


class Document(BaseModel):
    """A part of an answer."""

    model_config = ConfigDict(frozen=True, extra="ignore")


class DatasetInfo(Document):
    """A dataset that can be fetched, but where a `fault` was found: it is missing or damaged."""

    href: str
    sha256: str
    bytes: int
    fault: str = ""


class Limits(Document):
    """What a job may use: seconds of running, bytes of memory and of disk."""

    wall: float
    memory: int
    disk: int


class WebhookInfo(Document):
    """Where the end of a job is reported: how often that was tried, the result of the last try, when the next is."""

    url: str
    deliveries: int
    last: str
    next_attempt: datetime | None


class JobState(Document):
    """A job. `phase` is what its run is doing, `progress` goes from 0 to 1, `remaining` is the seconds that are left,
    `t` is simulated seconds; `message` says what to do next, `attributes` what the run as a whole says of its errors.
    """

    id: str
    owner: str
    status: Status
    title: str
    label: str
    priority: int
    phase: str = ""  # an older server does not say it, nor what follows
    progress: float
    remaining: float | None = None
    t: float
    outcome: str
    message: str
    cancel_requested: bool
    pinned: bool = False
    attempts: int
    created: datetime
    started: datetime | None
    finished: datetime | None
    case_sha256: str
    begins_with: str | None = None
    attributes: dict[str, float | int | str] = {}
    limits: Limits
    dataset: DatasetInfo | None
    webhook: WebhookInfo | None = None
    links: dict[str, str]

    @property
    def ended(self) -> bool:
        """Whether nothing will change any more."""
        return self.status in ENDED


class Cost(Document):
    """An estimate made before the run: `seconds` of one core, `bytes` before compression."""

    nodes: int
    frames: int
    steps: int
    seconds: float
    bytes: int


class CaseWarning(Document):
    """What is likely a slip: where (JSON pointer into the case), what stands there, and what speaks against it."""

    pointer: str
    value: Any
    rule: str


class Verdict(Document):
    """A case that could be run: as it was understood, what it would cost, and what should be looked at again."""

    case: dict[str, Any]
    cost: Cost
    warnings: list[CaseWarning]


class EnsembleState(Document):
    """An ensemble. `counts` says how many members have each status, `outcomes` how they ended; equal members are one
    of its `jobs`; `progress` goes from 0 to 1; `design` says how the values were chosen."""

    id: str
    owner: str
    status: Status
    title: str
    label: str
    members: int
    jobs: int
    counts: dict[Status, int]
    outcomes: dict[str, int]
    progress: float
    design: dict[str, Any]
    created: datetime
    finished: datetime | None
    links: dict[str, str]

    @property
    def ended_members(self) -> int:
        """How many members have ended."""
        return sum(many for status, many in self.counts.items() if status in ENDED)

    @property
    def ended(self) -> bool:
        """Whether all have."""
        return self.ended_members == self.members


class MemberState(Document):
    """A member of an ensemble: its values by parameter, and how its job is doing."""

    number: int
    values: dict[str, Any]
    job: str
    status: Status
    phase: str
    progress: float
    t: float
    outcome: str
    message: str
    links: dict[str, str]


class SobolIndex(Document):
    """A parameter's part of the variance of a variable: `first` by itself, `total` with all that it does together with
    others; each with the half width of its 95 % confidence interval."""

    first: float
    first_confidence: float
    total: float
    total_confidence: float


class Event(Document):
    """What happened to a job: `kind` as the server names it, `data` by kind."""

    id: int
    kind: str
    data: dict[str, Any]


class Link(Document):
    """An address by which anybody reads one dataset, until it expires or is revoked.

    `url`, that of the file, `zarr`, that of a Zarr store, and `opendap` are known only when the link is made; else they
    are empty.
    """

    id: str
    url: str
    zarr: str
    opendap: str
    created: datetime
    expires: datetime
    revoked: datetime | None


class PauseInfo(Document):
    """Since when no job is taken, and who paused; `drains`: what ran was handed back too."""

    drains: bool
    since: datetime
    owner: str


class HostInfo(Document):
    """A host: how many jobs it can run at once, and its pause."""

    name: str
    workers: int
    paused: PauseInfo | None


class Workforce(Document):
    """The jobs that wait and run, the pause of the whole queue, and the hosts that have workers or are paused."""

    waiting: int
    running: int
    paused: PauseInfo | None
    hosts: list[HostInfo]
