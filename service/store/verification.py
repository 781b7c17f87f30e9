"""Whether a dataset is still what its row says. A file is read whole only where it does not look as it did the last
time that it was."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from dataclasses import replace

from sqlalchemy.exc import SQLAlchemyError

from service.jobs import Database, Dataset, Job, Registry, Selection
from service.jobs.tables import jobs
from service.results import Datasets

MISSING = "missing"
AT_ONCE = 200
log = logging.getLogger(__name__)


def look(database: Database, datasets: Datasets, job: Job, thorough: bool = False) -> Dataset | None:
    """The dataset of a job with its `fault` as it is now, which its row remembers; None if it has published none.

    `thorough`: read it whole in any case. Raises StoreUnreachable.
    """
    if job.dataset is None:
        return None
    current = _checked(datasets, job.dataset, thorough)
    if current != job.dataset:
        if current.fault != job.dataset.fault:
            log.warning("job %s: its dataset is %s", job.id, current.fault or "good again")
        _remember(database, job.id, current)
    return current


def all_jobs(database: Database) -> Iterator[Job]:
    """Every job that is kept, the newest first, a page at a time."""
    registry, selection = Registry(database), Selection()
    while True:
        page = registry.page(AT_ONCE, selection)
        yield from page.jobs
        if page.next is None:
            return
        selection = Selection(after=page.next)


def lost(database: Database, job: Job) -> None:
    """Remember of a dataset that it was not there."""
    if job.dataset is not None:
        _remember(database, job.id, replace(job.dataset, stamp="", fault=MISSING))


def _checked(datasets: Datasets, dataset: Dataset, thorough: bool) -> Dataset:
    try:
        stamp = datasets.stamp(dataset.file)
        if stamp == dataset.stamp and not thorough:
            return dataset
        sha256 = datasets.sha256(dataset.file, dataset.bytes)
    except FileNotFoundError:
        return replace(dataset, stamp="", fault=MISSING)
    fault = "" if sha256 == dataset.sha256 else f"damaged: its sha256 is {sha256}, not {dataset.sha256}"
    return replace(dataset, stamp=stamp, fault=fault)


def _remember(database: Database, job_id: str, dataset: Dataset) -> None:
    """Write it into the row; where that cannot be done, whoever looks next looks again."""
    same = (jobs.c.id == job_id, jobs.c.dataset_file == dataset.file)
    try:
        with database.writing() as transaction:
            transaction.change(*same, dataset_stamp=dataset.stamp, dataset_fault=dataset.fault)
    except SQLAlchemyError as error:
        log.warning("job %s: the state of its dataset could not be written: %s", job_id, error)
