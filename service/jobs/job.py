"""What the registry says of a job."""

from __future__ import annotations

import hashlib
import json
import secrets
import time
from dataclasses import dataclass, field
from typing import Any

from service.jobs.lifecycle import Status

CROCKFORD = "0123456789abcdefghjkmnpqrstvwxyz"


@dataclass(frozen=True)
class Dataset:
    """A published file, by its name in the directory of datasets."""

    file: str
    sha256: str
    bytes: int


@dataclass(frozen=True)
class NewJob:
    """A case that somebody wants run. `title` is what lists show."""

    case: dict[str, Any]
    title: str = ""
    id: str = field(default_factory=lambda: new_id())

    @property
    def case_json(self) -> str:
        """The case as canonical JSON: equal cases give equal text."""
        return json.dumps(self.case, sort_keys=True, separators=(",", ":"), allow_nan=False)

    @property
    def case_sha256(self) -> str:
        """The hash that equal cases share."""
        return hashlib.sha256(self.case_json.encode()).hexdigest()


@dataclass(frozen=True)
class Job:
    """One row of the registry, without its case. Times are Unix seconds; `t` is simulated seconds.

    `version` grows with every change that a reader can see. `epoch` grows with every claim: a
    writer that holds an older one has lost the job.
    """

    id: str
    status: Status
    title: str
    case_sha256: str
    progress: float
    t: float
    outcome: str
    message: str
    cancel_requested: bool
    created: float
    started: float | None
    finished: float | None
    attempts: int
    epoch: int
    lease_until: float | None
    version: int
    worker: str
    dataset: Dataset | None


def new_id() -> str:
    """An identifier that sorts by time and cannot be guessed: 48 bits of milliseconds, 80 random ones."""
    number = (time.time_ns() // 1_000_000) << 80 | secrets.randbits(80)
    return "".join(CROCKFORD[number >> shift & 31] for shift in range(125, -5, -5))
