"""The database is locked or restarted; jobs are cancelled at any time."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager

from sqlalchemy import select, text

from chaos.disk import fill
from chaos.faults.target import PUT_TOGETHER, RENAMED, Target
from service.jobs import Registry, Status
from service.jobs.tables import jobs

FULL = 1.0
"""Seconds for which there is no room."""


@contextmanager
def locked(target: Target) -> Iterator[None]:
    """Nobody else may write the jobs while the block runs."""
    with target.database.writing() as transaction:
        if target.postgres is not None:
            transaction.connection.execute(text("LOCK TABLE jobs IN EXCLUSIVE MODE"))
        yield


def lock_database(target: Target) -> bool:
    """Nobody else may write for a while; leases may run out."""
    with locked(target):
        time.sleep(target.random.uniform(0.2, 1.5) * target.lease)
    return True


def restart_database(target: Target) -> bool:
    """PostgreSQL ends as in a power cut, and comes again."""
    if target.postgres is None:
        return False
    target.postgres.kill()
    time.sleep(target.random.uniform(0.0, 0.3 * target.lease))
    target.postgres.start()
    return True


def fill_disk_of_database(target: Target) -> bool:
    """PostgreSQL has no room for a while; it may give up, and is then started again."""
    if target.postgres is None or not target.small_disk:
        return False
    ballast = target.postgres.directory / "ballast"
    fill(ballast)
    time.sleep(FULL)
    ballast.unlink()
    if target.postgres.ended:
        target.postgres.start()
    return True


def cancel_job(target: Target) -> bool:
    """A job is cancelled, whatever its state."""
    query = select(jobs.c.id).where(jobs.c.status.in_([Status.ACCEPTED, Status.RUNNING]))
    with target.database.reading() as connection:
        open_jobs = list(connection.scalars(query))
    if not open_jobs:
        return False
    Registry(target.database).cancel(target.random.choice(open_jobs))
    return True


def cancel_at_end(target: Target) -> bool:
    """A job is cancelled while its dataset is put together, or before the commit of its end."""
    ending = target.ending(target.random.choice([PUT_TOGETHER, RENAMED]))
    if ending is None:
        return False
    Registry(target.database).cancel(ending[0])
    return True
