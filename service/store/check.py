"""Rows against files: what can be set right is, the rest is named."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

from sqlalchemy import text

from service.jobs import ENDED, Database, DeletedJob, Job, Registry, UnknownJob
from service.jobs.reconciler import recount
from service.results import Datasets
from service.settings import Settings
from service.store.removal import remove_files
from service.store.verification import all_jobs, look

FILE = re.compile(r"([0-9a-z]{26})\.\d+\.nc")
"""How a dataset's file is called, after its job and its epoch."""


@dataclass(frozen=True)
class Finding:
    """What is not as it should be, and whether it was set right."""

    sentence: str
    repaired: bool


def check(database: Database, settings: Settings) -> Iterator[Finding]:
    """Read the registry and every dataset whole. The service may run meanwhile."""
    datasets = Datasets(settings.datasets, settings.copies, settings.objects)
    yield from _tables(database)
    recount(database)
    remove_files(database, datasets)
    for job in all_jobs(database):
        dataset = look(database, datasets, job, thorough=True)
        if dataset is not None and dataset.fault:
            yield Finding(f"job {job.id}: its dataset {dataset.file} is {dataset.fault}", repaired=False)
    yield from _left_over(database, settings)


def _tables(database: Database) -> Iterator[Finding]:
    if database.engine.dialect.name != "sqlite":
        return  # PostgreSQL looks after its own pages
    with database.reading() as connection:
        for fault in connection.scalars(text("PRAGMA integrity_check")):
            if fault != "ok":
                yield Finding(f"the registry: {fault}", repaired=False)


def _left_over(database: Database, settings: Settings) -> Iterator[Finding]:
    """Files that no row names: those of lost attempts and deleted jobs are removed."""
    registry = Registry(database)
    for path in sorted(settings.datasets.iterdir()):
        named = FILE.fullmatch(path.name)
        if named is None:
            continue  # hidden directories of datasets that are being written, or nothing of ours
        job = _job(registry, named[1])  # read after the file was seen: what is published now is named
        if job is None:
            yield Finding(f"{path.name} is the dataset of no job that the registry knows", repaired=False)
        elif job.status in ENDED and (job.dataset is None or job.dataset.file != path.name):
            path.unlink(missing_ok=True)
            yield Finding(f"{path.name} was left over, and is removed", repaired=True)


def _job(registry: Registry, job_id: str) -> Job | None:
    try:
        return registry.get(job_id)
    except DeletedJob as deleted:
        return deleted.job
    except UnknownJob:
        return None
