"""One job from its claim to its end: claim, simulate, write, publish, commit."""

from __future__ import annotations

import errno
import logging
import os
import platform
import shutil
import time
from dataclasses import dataclass
from pathlib import Path

from sqlalchemy.exc import DBAPIError

from service.cases import CaseError, build_scene, parse_case
from service.jobs import Database, Dataset, Job, Reached, Status
from service.jobs.held import HeldJob, claim, next_in_turn
from service.results import DatasetWriter
from service.settings import Settings
from solver import Outcome, RunFailed, simulate
from worker.lease import Cancelled, Lease, LeaseLost, OutOfTime
from worker.lock import job_lock

FULL = (errno.ENOSPC, errno.EDQUOT)
LEAST_FREE = 1_000_000
TRY_AGAIN = 0.2
log = logging.getLogger(__name__)


@dataclass(frozen=True)
class Ending:
    """How a run ended: what its row will say."""

    status: Status
    outcome: str
    message: str
    dataset: Dataset | None = None


def run_next(database: Database, settings: Settings) -> None:
    """Run the job whose turn it is, if any waits; a message too many does nothing."""
    passed: list[str] = []
    while job_id := next_in_turn(database, passed):
        with job_lock(settings.locks / f"{job_id}.lock") as mine:
            asked = time.monotonic()
            held = claim(database, job_id, settings.lease, f"{platform.node()}:{os.getpid()}") if mine else None
            if held is not None:
                _run(held, Lease(held, settings.lease, asked), settings)
                return
        passed.append(job_id)
    log.info("no job waits")


def _run(held: HeldJob, lease: Lease, settings: Settings) -> None:
    clear(settings.datasets, held.job.id)
    with lease:
        try:
            ending = _end(held, lease, settings.datasets)
            kept = _finish(held, ending, lease)
            log.info("job %s: %s, %s", held.job.id, ending.status, ending.outcome)
        except LeaseLost:
            kept = False
        except SystemExit:
            held.release()
            log.info("job %s is handed back: this worker was told to stop", held.job.id)
            raise
        if not kept:
            log.warning("job %s was given to another worker; what was computed here is dropped", held.job.id)
            (settings.datasets / dataset_file(held.job)).unlink(missing_ok=True)


def _finish(held: HeldJob, ending: Ending, lease: Lease) -> bool:
    """Write how the job ended, however long the database is away: the lease bounds it."""
    while True:
        try:
            return held.finish(ending.status, ending.outcome, ending.message, ending.dataset, lease.reached)
        except DBAPIError as error:
            log.warning("job %s: its end could not be written, trying again: %s", held.job.id, error)
            time.sleep(TRY_AGAIN)


def clear(datasets: Path, job_id: str) -> None:
    """Remove what lost attempts at the job left behind."""
    for path in datasets.glob(f"*{job_id}*"):
        if path.is_dir():
            shutil.rmtree(path, ignore_errors=True)
        else:
            path.unlink(missing_ok=True)


def dataset_file(job: Job) -> str:
    """The name of what this attempt publishes: no attempt writes over another's file."""
    return f"{job.id}.{job.epoch}.nc"


def _end(held: HeldJob, lease: Lease, datasets: Path) -> Ending:
    """Run the case, and give a name to whatever happens."""
    try:
        return _simulate(held, lease, datasets)
    except LeaseLost:
        raise
    except Cancelled:
        return Ending(Status.DISMISSED, Outcome.CANCELLED.value, "cancelled while it ran; no dataset is kept")
    except OutOfTime:
        return Ending(Status.FAILED, "wall_time_exceeded", f"the job has run for more than its "
                      f"{held.job.limits.wall:g} s: give it more, or fewer steps to take")
    except CaseError as error:
        return Ending(Status.FAILED, "invalid_case", str(error))
    except MemoryError:
        return Ending(Status.FAILED, "out_of_memory",
                      "the worker has not enough memory: use fewer intervals or a longer output.interval")
    except OSError as error:
        log.exception("job %s could not be written", held.job.id)
        return _not_written(error, datasets)
    except Exception as error:
        log.exception("job %s failed", held.job.id)
        return Ending(Status.FAILED, "internal_error",
                      f"hockle itself failed ({type(error).__name__}); the worker's log says where. "
                      f"Please report it with the case and the job id {held.job.id}")


def _not_written(error: OSError, datasets: Path) -> Ending:
    """A full disk by its name; the NetCDF library tells of one without its cause."""
    if error.errno in FULL or shutil.disk_usage(datasets).free < LEAST_FREE:
        return Ending(Status.FAILED, "disk_full", "the disk that holds the datasets is full, and nothing of "
                      "the run is kept: make room and submit the case again")
    return Ending(Status.FAILED, "dataset_not_written",
                  f"the dataset could not be written ({error.strerror or error}): see the worker's log")


def _simulate(held: HeldJob, lease: Lease, datasets: Path) -> Ending:
    spec = parse_case(held.case)
    scene = build_scene(spec)
    simulation = simulate(scene)
    status, outcome, message = Status.SUCCESSFUL, Outcome.COMPLETED.value, ""
    file = dataset_file(held.job)
    with DatasetWriter(datasets / file, spec, simulation.s) as writer:
        try:
            for frame in simulation:
                writer.append(frame)
                progress = min(frame.t / scene.t_end, 1.0)
                lease.tell(Reached(progress, frame.t, simulation.statistics.steps))
        except RunFailed as failure:
            status, outcome, message = Status.FAILED, failure.outcome.value, str(failure)
        published = writer.publish(outcome, message, simulation.statistics)
    return Ending(status, outcome, message, Dataset(file, published.sha256, published.bytes))
