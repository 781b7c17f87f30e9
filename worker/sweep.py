"""Removes what is left of jobs that have ended, whoever ended them."""

from __future__ import annotations

import logging
import shutil
from collections.abc import Iterable

from service.jobs import ENDED, Database, DeletedJob, Registry, UnknownJob
from service.results import Datasets, StoreUnreachable
from service.settings import Settings
from worker.attempt import dataset_file, work_directory

log = logging.getLogger(__name__)


def sweep(database: Database, settings: Settings) -> None:
    """Remove the work, the lock files and the unnamed datasets of jobs that have ended."""
    for job_id in {path.stem for path in (*settings.work.iterdir(), *settings.locks.glob("*.lock"))}:
        try:
            job = Registry(database).get(job_id)
        except DeletedJob as deleted:
            job = deleted.job
        except UnknownJob:
            continue  # not the work of a job of this registry
        if job.status in ENDED:
            remove_work(settings, job_id, job.epoch, job.dataset.file if job.dataset else "")
            (settings.locks / f"{job_id}.lock").unlink(missing_ok=True)


def remove_work(settings: Settings, job_id: str, epoch: int, published: str) -> None:
    """Remove what a job that has ended has left, but for what it `published`; the rest comes with a later sweep."""
    if remove_datasets(settings, job_id, range(1, epoch + 1), published):
        shutil.rmtree(work_directory(settings, job_id), ignore_errors=True)


def remove_datasets(settings: Settings, job_id: str, epochs: Iterable[int], besides: str = "") -> bool:
    """Remove the datasets of attempts that were lost; none counts but `besides`. False if they cannot be reached."""
    datasets = Datasets(settings.datasets, settings.copies, settings.objects)
    try:
        for name in {dataset_file(job_id, epoch) for epoch in epochs} - {besides}:
            (work_directory(settings, job_id) / name).unlink(missing_ok=True)
            datasets.discard(name)
    except StoreUnreachable as error:
        log.warning("job %s: a lost attempt's dataset is removed later: %s", job_id, error)
        return False
    return True
