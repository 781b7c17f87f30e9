"""One job from its claim to its end."""

from __future__ import annotations

import logging
import os
import platform
import time

from sqlalchemy.exc import DBAPIError

from service.jobs import Database
from service.jobs.held import HeldJob, claim
from service.jobs.sharing import next_in_turn
from service.logs import about
from service.settings import Settings
from worker import stopping
from worker.attempt import Attempt
from worker.endings import DISMISSED, Ending, ending_of
from worker.lease import Lease, LeaseLost
from worker.lock import JobLock, job_lock
from worker.memory import memory_limit
from worker.sweep import remove_datasets, remove_work, sweep

TRY_AGAIN = 0.2
log = logging.getLogger(__name__)


def run_next(database: Database, settings: Settings) -> bool:
    """Run the job whose turn it is, if any waits; a message too many does nothing. Returns whether one was run."""
    sweep(database, settings)
    passed: list[str] = []
    host, most = platform.node(), settings.most_running
    while job_id := next_in_turn(database, passed, host, most):
        with stopping.at_work(), job_lock(settings.locks / f"{job_id}.lock") as lock:
            since = time.monotonic()
            held = claim(database, job_id, settings.lease, f"{host}:{os.getpid()}", most) if lock else None
            if lock is not None and held is not None:
                with about(job=job_id, epoch=held.job.epoch):
                    _run(held, Lease(held, settings.lease, since), lock, settings)
                return True
        passed.append(job_id)
    log.info("no job waits")
    return False


def _run(held: HeldJob, lease: Lease, lock: JobLock, settings: Settings) -> None:
    job = held.job
    with lease:
        remove_datasets(settings, job.id, range(1, job.epoch))
        try:
            attempt = Attempt(held, lease, lock, settings)
            with memory_limit(job.limits.memory):
                ending = attempt.run()
            attempt.publish()  # what a library takes for that is not the job's
        except stopping.Stopping as stopped:
            held.release()
            log.info("job %s is handed back: %s", job.id, stopped)
            return
        except LeaseLost:
            written = None
        except Exception as error:
            written = _finish(held, ending_of(error, job, settings.datasets), lease)
        else:
            written = _finish(held, ending, lease)
    if written:
        log.info("job %s: %s, %s", job.id, written.status, written.outcome)
        remove_work(settings, job.id, job.epoch, written.dataset.file if written.dataset else "")
    else:
        log.warning("job %s was given to another worker; what was computed here is dropped", job.id)
        remove_datasets(settings, job.id, [job.epoch])


def _finish(held: HeldJob, ending: Ending, lease: Lease) -> Ending | None:
    """Write how the job ended, however long the database is away: the lease bounds it. Returns what was written."""
    while True:
        try:
            status = held.finish(ending.status, ending.outcome.value, ending.message, ending.dataset, lease.reached,
                                 ending.drift, ending.attributes, ending.scalars)
        except DBAPIError as error:
            log.warning("job %s: its end could not be written, trying again: %s", held.job.id, error)
            time.sleep(TRY_AGAIN)
        else:
            if status is None:
                return None
            return ending if status is ending.status else DISMISSED
