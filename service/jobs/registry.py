"""What owners do with jobs. Each method is one transaction."""

from __future__ import annotations

from dataclasses import dataclass

from sqlalchemy import insert, select
from sqlalchemy.dialects import postgresql, sqlite

from service.jobs.database import Database, Transaction
from service.jobs.job import Job, NewJob
from service.jobs.lifecycle import Status
from service.jobs.tables import JOB_COLUMNS, job_of, jobs, owners


class UnknownJob(Exception):
    """No job has this id."""


@dataclass(frozen=True)
class Page:
    """Some jobs, newest first, and the cursor after which the next page starts (None at the end)."""

    jobs: list[Job]
    next: str | None


class Registry:
    """The jobs in a database."""

    def __init__(self, database: Database) -> None:
        self.database = database

    def submit(self, new: NewJob) -> Job:
        """Write an accepted job; when this returns, it is on disk."""
        with self.database.writing() as transaction:
            insert_job(transaction, new)
        return self.get(new.id)

    def get(self, job_id: str) -> Job:
        """One job, by a point read. Raises UnknownJob."""
        with self.database.reading() as connection:
            row = connection.execute(select(*JOB_COLUMNS).where(jobs.c.id == job_id)).mappings().first()
        if row is None:
            raise UnknownJob(job_id)
        return job_of(row)

    def page(self, limit: int, after: str | None = None, status: Status | None = None) -> Page:
        """At most `limit` jobs, newest first, those older than the job `after` only."""
        query = select(*JOB_COLUMNS).order_by(jobs.c.id.desc()).limit(limit + 1)
        if after is not None:
            query = query.where(jobs.c.id < after)
        if status is not None:
            query = query.where(jobs.c.status == status)
        with self.database.reading() as connection:
            found = [job_of(row) for row in connection.execute(query).mappings()]
        return Page(found[:limit], found[limit - 1].id if len(found) > limit else None)

    def cancel(self, job_id: str) -> Job:
        """Dismiss a job that waits; tell the worker of one that runs. Raises UnknownJob."""
        with self.database.writing() as transaction:
            this = jobs.c.id == job_id
            open_ = jobs.c.status.in_([Status.ACCEPTED, Status.RUNNING])
            transaction.change(this, open_, ~jobs.c.cancel_requested, event="cancel_requested", cancel_requested=True)
            transaction.change(this, jobs.c.status == Status.ACCEPTED, event="ended", status=Status.DISMISSED,
                               outcome="cancelled", message="cancelled before it started")
        return self.get(job_id)


def insert_job(transaction: Transaction, new: NewJob) -> None:
    """Write an accepted job, its owner if he is new, and its first event."""
    dialect = postgresql if transaction.connection.dialect.name == "postgresql" else sqlite
    transaction.connection.execute(dialect.insert(owners).values(name=new.owner).on_conflict_do_nothing())
    transaction.connection.execute(insert(jobs), {
        "id": new.id, "owner": new.owner, "status": Status.ACCEPTED.value, "title": new.title, "label": new.label,
        "priority": new.priority, "case_json": new.case_json, "case_sha256": new.case_sha256,
        "created": transaction.now, "limit_wall": new.limits.wall, "limit_memory": new.limits.memory,
        "limit_disk": new.limits.disk,
    })
    transaction.note(new.id, 1, "accepted", {"status": Status.ACCEPTED.value})
