"""How a run ended: what its row will say, with a name for whatever happens."""

from __future__ import annotations

import errno
import logging
import shutil
from dataclasses import dataclass
from pathlib import Path

from service.cases import CaseError
from service.jobs import Dataset, Drift, Job, Status
from service.jobs.held import CANCELLED
from service.results import StoreUnreachable
from solver import Outcome
from worker.lease import Cancelled, OutOfTime

FULL = (errno.ENOSPC, errno.EDQUOT)
LEAST_FREE = 1_000_000
log = logging.getLogger(__name__)


class OutOfDisk(Exception):
    """The job has written more than it may."""


@dataclass(frozen=True)
class Ending:
    """The status, the outcome's name, a sentence for the owner, and the dataset if there is one, with its drift."""

    status: Status
    outcome: str
    message: str
    dataset: Dataset | None = None
    drift: Drift | None = None


DISMISSED = Ending(Status.DISMISSED, Outcome.CANCELLED.value, CANCELLED)


def ending_of(error: Exception, job: Job, store: Path) -> Ending:
    """What to say of a run that an exception ended. A fault of hockle itself is logged."""
    match error:
        case Cancelled():
            return DISMISSED
        case OutOfTime():
            return _failed("wall_time_exceeded", f"the job has run for more than its {job.limits.wall:g} s: "
                           "give it more, or fewer intervals or a larger dt_max")
        case OutOfDisk():
            return _failed("disk_limit_exceeded", f"the job has written more than its {job.limits.disk:,} bytes: "
                           "give it more, or store less with output.fields or a longer output.interval")
        case CaseError():
            return _failed("invalid_case", str(error))
        case _ if _began_with(error, MemoryError):
            return _failed("out_of_memory", f"the job needs more than its {job.limits.memory:,} bytes of memory, or "
                           "than there are: use fewer intervals or a longer output.interval")
        case StoreUnreachable():
            log.error("job %s could not be uploaded: %s", job.id, error)
            return _failed("dataset_not_written", "the object store could not be reached for ten minutes, and nothing "
                           "of the run is kept: see the worker's log, and submit the case again")
        case OSError():
            log.exception("job %s could not be written", job.id, exc_info=error)
            return _not_written(error, store)
    log.error("job %s failed", job.id, exc_info=error)
    return _failed("internal_error", f"hockle itself failed ({type(error).__name__}); the worker's log says where. "
                   f"Please report it with the case and the job id {job.id}")


def _began_with(error: BaseException | None, kind: type[Exception]) -> bool:
    """Whether it is of that kind, or came up while one of that kind was handled: cleaning up fails as well then."""
    return error is not None and (isinstance(error, kind) or _began_with(error.__context__, kind))


def is_full(error: OSError, store: Path) -> bool:
    """Whether it is for want of room in `store`; the NetCDF library tells of that without its cause."""
    return error.errno in FULL or shutil.disk_usage(store).free < LEAST_FREE


def _not_written(error: OSError, store: Path) -> Ending:
    """A full disk by its name."""
    if is_full(error, store):
        return _failed("disk_full", "the disk that holds the datasets is full, and nothing of the run is kept: "
                       "make room and submit the case again")
    return _failed("dataset_not_written",
                   f"the dataset could not be written ({error.strerror or error}): see the worker's log")


def _failed(outcome: str, message: str) -> Ending:
    return Ending(Status.FAILED, outcome, message)
