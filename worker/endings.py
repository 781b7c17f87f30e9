"""How a run ended: what its row will say, with a name for whatever happens."""

from __future__ import annotations

import errno
import logging
import shutil
from dataclasses import dataclass, field
from pathlib import Path

from outcomes import Outcome
from service.cases import CaseError
from service.jobs import Dataset, Drift, Job, Status
from service.jobs.held import CANCELLED
from service.results import StoreUnreachable
from service.results.scalars import Value
from worker.lease import Cancelled, OutOfTime

FULL = (errno.ENOSPC, errno.EDQUOT)
LEAST_FREE = 1_000_000
log = logging.getLogger(__name__)


class OutOfDisk(Exception):
    """The job has written more than it may."""


@dataclass(frozen=True)
class Ending:
    """The status, the outcome, a sentence for the owner, and the dataset if there is one, with its drift, with what
    it says of the run as a whole, and with the last values of its numbers."""

    status: Status
    outcome: Outcome
    message: str
    dataset: Dataset | None = None
    drift: Drift | None = None
    attributes: dict[str, float | int | str] = field(default_factory=dict)
    scalars: dict[str, Value] = field(default_factory=dict)


DISMISSED = Ending(Status.DISMISSED, Outcome.CANCELLED, CANCELLED)


def ending_of(error: Exception, job: Job, store: Path) -> Ending:
    """What to say of a run that an exception ended. A fault of hockle itself is logged."""
    match error:
        case Cancelled():
            return DISMISSED
        case OutOfTime():
            return _failed(Outcome.WALL_TIME_EXCEEDED, f"the job has run for more than its {job.limits.wall:g} s")
        case OutOfDisk():
            return _failed(Outcome.DISK_LIMIT_EXCEEDED, f"the job has written more than its {job.limits.disk:,} bytes")
        case CaseError():
            return _failed(Outcome.INVALID_CASE, str(error))
        case _ if _began_with(error, MemoryError):
            memory = f"the job needs more than its {job.limits.memory:,} bytes of memory, or than there are"
            return _failed(Outcome.OUT_OF_MEMORY, memory)
        case StoreUnreachable():
            log.error("job %s could not be uploaded: %s", job.id, error)
            return _failed(Outcome.DATASET_NOT_WRITTEN, "the object store could not be reached for ten minutes, and "
                           "nothing of the run is kept")
        case OSError():
            log.exception("job %s could not be written", job.id, exc_info=error)
            return _not_written(error, store)
    log.error("job %s failed", job.id, exc_info=error)
    return _failed(Outcome.INTERNAL_ERROR, f"hockle itself failed ({type(error).__name__}) in job {job.id}")


def _began_with(error: BaseException | None, kind: type[Exception]) -> bool:
    """Whether it is of that kind, or came up while one of that kind was handled: cleaning up fails as well then."""
    return error is not None and (isinstance(error, kind) or _began_with(error.__context__, kind))


def is_full(error: OSError, store: Path) -> bool:
    """Whether it is for want of room in `store`; the NetCDF library tells of that without its cause."""
    return error.errno in FULL or shutil.disk_usage(store).free < LEAST_FREE


def _not_written(error: OSError, store: Path) -> Ending:
    """A full disk by its name."""
    if is_full(error, store):
        return _failed(Outcome.DISK_FULL, "the disk that holds the datasets is full, and nothing of the run is kept")
    return _failed(Outcome.DATASET_NOT_WRITTEN, f"the dataset could not be written ({error.strerror or error})")


def _failed(outcome: Outcome, cause: str) -> Ending:
    return Ending(Status.FAILED, outcome, f"{cause}: {outcome.remedy}")
