"""One job from its claim to its end: claim, simulate, write, publish, commit."""

from __future__ import annotations

import errno
import logging
import os
import platform
import shutil
from dataclasses import dataclass
from pathlib import Path

from service.cases import CaseError, build_scene, parse_case
from service.jobs import Dataset, Job, Status
from service.jobs.registry import Claim, Registry
from service.results import DatasetWriter
from service.settings import Settings
from solver import Outcome, RunFailed, simulate
from worker.lease import Cancelled, Lease, LeaseLost
from worker.lock import job_lock

FULL = (errno.ENOSPC, errno.EDQUOT)
LEAST_FREE = 1_000_000
log = logging.getLogger(__name__)


@dataclass(frozen=True)
class Ending:
    """How a run ended: what its row will say."""

    status: Status
    outcome: str
    message: str
    dataset: Dataset | None = None


def run_job(job_id: str, registry: Registry, settings: Settings) -> None:
    """Run the job if it is to be had; a message that comes twice, or too late, does nothing."""
    with job_lock(settings.locks / f"{job_id}.lock") as mine:
        claim = _claim(job_id, registry, settings) if mine else None
        if claim is None:
            log.info("job %s is not to be had", job_id)
            return
        clear(settings.datasets, job_id)
        try:
            with Lease(registry, claim.job, settings.lease) as lease:
                ending = _end(claim, lease, settings.datasets)
        except LeaseLost:
            kept = False
        except SystemExit:
            registry.release(claim.job)
            log.info("job %s is handed back: this worker was told to stop", job_id)
            raise
        else:
            kept = registry.finish(claim.job, ending.status, ending.outcome, ending.message, ending.dataset,
                                   *lease.told)
            log.info("job %s: %s, %s", job_id, ending.status, ending.outcome)
        if not kept:
            log.warning("job %s was given to another worker; what was computed here is dropped", job_id)
            (settings.datasets / dataset_file(claim.job)).unlink(missing_ok=True)


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


def _claim(job_id: str, registry: Registry, settings: Settings) -> Claim | None:
    return registry.claim(job_id, settings.lease, settings.attempts, f"{platform.node()}:{os.getpid()}")


def _end(claim: Claim, lease: Lease, datasets: Path) -> Ending:
    """Run the case, and give a name to whatever happens."""
    try:
        return _simulate(claim, lease, datasets)
    except LeaseLost:
        raise
    except Cancelled:
        return Ending(Status.DISMISSED, Outcome.CANCELLED.value, "cancelled while it ran; no dataset is kept")
    except CaseError as error:
        return Ending(Status.FAILED, "invalid_case", str(error))
    except MemoryError:
        return Ending(Status.FAILED, "out_of_memory",
                      "the worker has not enough memory: use fewer intervals or a longer output.interval")
    except OSError as error:
        log.exception("job %s could not be written", claim.job.id)
        return _not_written(error, datasets)
    except Exception as error:
        log.exception("job %s failed", claim.job.id)
        return Ending(Status.FAILED, "internal_error",
                      f"hockle itself failed ({type(error).__name__}); the worker's log says where. "
                      f"Please report it with the case and the job id {claim.job.id}")


def _not_written(error: OSError, datasets: Path) -> Ending:
    """A full disk by its name; the NetCDF library tells of one without its cause."""
    if error.errno in FULL or shutil.disk_usage(datasets).free < LEAST_FREE:
        return Ending(Status.FAILED, "disk_full", "the disk that holds the datasets is full, and nothing of "
                      "the run is kept: make room and submit the case again")
    return Ending(Status.FAILED, "dataset_not_written",
                  f"the dataset could not be written ({error.strerror or error}): see the worker's log")


def _simulate(claim: Claim, lease: Lease, datasets: Path) -> Ending:
    spec = parse_case(claim.case)
    scene = build_scene(spec)
    simulation = simulate(scene)
    status, outcome, message = Status.SUCCESSFUL, Outcome.COMPLETED.value, ""
    file = dataset_file(claim.job)
    with DatasetWriter(datasets / file, spec, simulation.s) as writer:
        try:
            for frame in simulation:
                writer.append(frame)
                lease.tell(min(frame.t / scene.t_end, 1.0), frame.t)
        except RunFailed as failure:
            status, outcome, message = Status.FAILED, failure.outcome.value, str(failure)
        published = writer.publish(outcome, message, simulation.statistics)
    return Ending(status, outcome, message, Dataset(file, published.sha256, published.bytes))
