"""Removes what is left of jobs that ended without a worker: given up or dismissed by the reconciler."""

from __future__ import annotations

import shutil

from service.jobs import ENDED, Database, Registry, UnknownJob
from service.settings import Settings
from worker.attempt import work_directory


def sweep(database: Database, settings: Settings) -> None:
    """Remove the work, the lock files and the unnamed datasets of jobs that have ended."""
    for job_id in {path.stem for path in (*settings.work.iterdir(), *settings.locks.glob("*.lock"))}:
        try:
            job = Registry(database).get(job_id)
        except UnknownJob:
            continue  # not the work of a job of this registry
        if job.status in ENDED:
            remove_datasets(settings, job_id, job.epoch, job.dataset.file if job.dataset else "")
            shutil.rmtree(work_directory(settings, job_id), ignore_errors=True)
            (settings.locks / f"{job_id}.lock").unlink(missing_ok=True)


def remove_datasets(settings: Settings, job_id: str, epoch: int, besides: str = "") -> None:
    """Remove the datasets that attempts up to `epoch` published before they were lost; none counts but `besides`."""
    for name in {f"{job_id}.{past}.nc" for past in range(1, epoch + 1)} - {besides}:
        (settings.datasets / name).unlink(missing_ok=True)
