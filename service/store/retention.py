"""Which jobs are kept no longer: by their age, by the bytes of their owner, by the room on the disk. The oldest go
first; those that are pinned or have not ended stay, and so does what ended within the last minutes."""

from __future__ import annotations

import shutil
from typing import Any

from sqlalchemy import ColumnElement, Select, select

from service.jobs import ENDED, Database
from service.jobs.audit import Actor
from service.jobs.deletion import delete_jobs
from service.jobs.tables import jobs, owners
from service.results.published import OBJECT
from service.settings import Settings

RETENTION = Actor("retention")
YOUNGEST = 600.0
"""Seconds after its end for which a job is kept in any case: its owner may be about to fetch it."""
AT_ONCE = 100
DAY = 86400.0


def retain(database: Database, settings: Settings, now: float) -> list[str]:
    """Delete the jobs that are kept no longer at the time `now`, and give their ids; files are noted as removals."""
    due = overdue(database, settings, now)
    deleted: list[str] = []
    for start in range(0, len(due), AT_ONCE):
        with database.writing() as transaction:
            deleted += delete_jobs(transaction, RETENTION, due[start : start + AT_ONCE])
    return deleted


def overdue(database: Database, settings: Settings, now: float) -> list[str]:
    """The ids of these jobs."""
    ended = jobs.c.finished < now - YOUNGEST
    due: list[str] = []
    if settings.keep_days is not None:
        old = jobs.c.finished < now - settings.keep_days * DAY
        due += [job.id for job in _all(database, _deletable(ended, old))]
    if settings.keep_bytes is not None:
        rich = select(owners.c.name, owners.c.bytes).where(owners.c.bytes > settings.keep_bytes)
        for owner in _all(database, rich):
            of_owner = _deletable(ended, jobs.c.owner == owner.name)
            due += _oldest(database, of_owner, owner.bytes - settings.keep_bytes)
    if settings.keep_free is not None:
        here = _deletable(ended, jobs.c.dataset_stamp != OBJECT)
        due += _oldest(database, here, settings.keep_free - shutil.disk_usage(settings.datasets).free)
    return list(dict.fromkeys(due))


def _deletable(*where: ColumnElement[bool]) -> Select[Any]:
    """Ended jobs that may be deleted, the oldest first."""
    free = (jobs.c.deleted.is_(None), ~jobs.c.pinned, jobs.c.status.in_(ENDED))
    return select(jobs.c.id, jobs.c.dataset_bytes).where(*free, *where).order_by(jobs.c.finished)


def _oldest(database: Database, query: Select[Any], needed: int) -> list[str]:
    """As many of the oldest jobs as hold so many bytes."""
    ids: list[str] = []
    with database.reading() as connection:
        holding = connection.execute(query.where(jobs.c.dataset_bytes.is_not(None)))
        for job in holding:
            if needed <= 0:
                break
            ids.append(job.id)
            needed -= job.dataset_bytes
    return ids


def _all(database: Database, query: Select[Any]) -> list[Any]:
    with database.reading() as connection:
        return list(connection.execute(query).all())
