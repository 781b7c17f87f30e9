"""Every query on jobs. Each method is one transaction; a write that came too late changes nothing."""

from __future__ import annotations

import json
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from sqlalchemy import ColumnElement, and_, case, insert, or_, select, update

from service.jobs.database import JOB_COLUMNS, job_of, jobs, open_database
from service.jobs.job import Dataset, Job, NewJob
from service.jobs.lifecycle import Status, allowed_before


class UnknownJob(Exception):
    """No job has this id."""


@dataclass(frozen=True)
class Page:
    """Some jobs, newest first, and the cursor after which the next page starts (None at the end)."""

    jobs: list[Job]
    next: str | None


@dataclass(frozen=True)
class Claim:
    """A job that this process may run, until its lease runs out."""

    job: Job
    case: dict[str, Any]


class Registry:
    """The jobs in one database."""

    def __init__(self, url: str, clock: Callable[[], float] = time.time) -> None:
        """Open the database at `url` (SQLAlchemy's spelling), making it if it is new."""
        self._engine = open_database(url)
        self._clock = clock

    def close(self) -> None:
        """Close every connection."""
        self._engine.dispose()

    # --- what owners do

    def submit(self, new: NewJob) -> Job:
        """Write an accepted job; when this returns, it is on disk."""
        now = self._clock()
        row = {"id": new.id, "title": new.title, "case_json": new.case_json, "case_sha256": new.case_sha256,
               "status": Status.ACCEPTED.value, "created": now, "rung": now}
        with self._engine.begin() as connection:
            connection.execute(insert(jobs), row)
        return self.get(new.id)

    def get(self, job_id: str) -> Job:
        """One job, by a point read. Raises UnknownJob."""
        with self._engine.connect() as connection:
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
        with self._engine.connect() as connection:
            found = [job_of(row) for row in connection.execute(query).mappings()]
        return Page(found[:limit], found[limit - 1].id if len(found) > limit else None)

    def cancel(self, job_id: str) -> Job:
        """Dismiss a job that waits; tell the worker of one that runs. Raises UnknownJob."""
        if not self._end(jobs.c.id == job_id, jobs.c.status == Status.ACCEPTED, status=Status.DISMISSED,
                         outcome="cancelled", message="cancelled before it started"):
            running = (jobs.c.id == job_id, jobs.c.status == Status.RUNNING, ~jobs.c.cancel_requested)
            self._change(*running, cancel_requested=True, version=jobs.c.version + 1)
        return self.get(job_id)

    # --- what the worker that holds a job does

    def claim(self, job_id: str, lease: float, attempts: int, worker: str) -> Claim | None:
        """Take a job that waits, or whose worker has fallen silent; None if it is not to be had."""
        now = self._clock()
        with self._engine.begin() as connection:
            taken = connection.execute(
                update(jobs)
                .where(jobs.c.id == job_id, ~jobs.c.cancel_requested, jobs.c.attempts < attempts,
                       or_(jobs.c.status == Status.ACCEPTED, _expired(now)))
                .values(status=Status.RUNNING.value, epoch=jobs.c.epoch + 1, attempts=jobs.c.attempts + 1,
                        lease_until=now + lease, started=now, progress=0.0, t=0.0, worker=worker,
                        version=jobs.c.version + 1)
            )
            if taken.rowcount == 0:
                return None
            row = connection.execute(
                select(*JOB_COLUMNS, jobs.c.case_json).where(jobs.c.id == job_id)
            ).mappings().one()
        fields = dict(row)
        told = json.loads(fields.pop("case_json"))
        return Claim(job_of(fields), told)

    def renew(self, held: Job, lease: float, progress: float, t: float) -> Job | None:
        """Lengthen the lease and tell the progress; None if the job is another's now."""
        moved = case((jobs.c.t != t, 1), else_=0)
        kept = self._change(*_held(held), lease_until=self._clock() + lease, progress=progress, t=t,
                            version=jobs.c.version + moved)
        return self.get(held.id) if kept else None

    def finish(self, held: Job, status: Status, outcome: str, message: str, dataset: Dataset | None,
               progress: float, t: float) -> bool:
        """Write how a job ended; False if it is another's now, and nothing was written."""
        told: dict[str, Any] = {"status": status, "outcome": outcome, "message": message,
                                "progress": progress, "t": t}
        if dataset is not None:
            told |= {"dataset_file": dataset.file, "dataset_sha256": dataset.sha256,
                     "dataset_bytes": dataset.bytes}
        return self._end(*_held(held), **told) == 1

    def release(self, held: Job) -> None:
        """Hand back a job that could not be finished through no fault of its own: it waits again."""
        self._change(*_held(held), status=Status.ACCEPTED.value, attempts=jobs.c.attempts - 1, rung=0.0,
                     lease_until=None, progress=0.0, t=0.0, worker="", version=jobs.c.version + 1)

    # --- what the reconciler does

    def overdue(self, ring_again: float, limit: int) -> list[str]:
        """Mark the oldest waiting or lost jobs that were not rung for lately, and give their ids."""
        now = self._clock()
        silent = and_(or_(jobs.c.status == Status.ACCEPTED, _expired(now)), jobs.c.rung < now - ring_again)
        with self._engine.connect() as connection:
            found = list(connection.scalars(select(jobs.c.id).where(silent).order_by(jobs.c.id).limit(limit)))
        return [job_id for job_id in found if self._change(jobs.c.id == job_id, silent, rung=now)]

    def end_lost(self, attempts: int) -> int:
        """End the jobs whose worker is lost and that were cancelled, or tried often enough."""
        lost = _expired(self._clock())
        fence = jobs.c.epoch + 1
        cancelled = self._end(lost, jobs.c.cancel_requested, status=Status.DISMISSED, epoch=fence,
                              outcome="cancelled", message="cancelled; its worker had stopped answering")
        message = (f"its worker stopped answering {attempts} times: the case may need more memory than there "
                   "is; try fewer intervals or frames, and see the worker's log")
        return cancelled + self._end(lost, jobs.c.attempts >= attempts, status=Status.FAILED, epoch=fence,
                                     outcome="worker_lost", message=message)

    # --- the one place that writes

    def _end(self, *where: ColumnElement[bool], status: Status, **values: Any) -> int:
        return self._change(*where, jobs.c.status.in_(allowed_before(status)), status=status.value,
                            finished=self._clock(), lease_until=None, version=jobs.c.version + 1, **values)

    def _change(self, *where: ColumnElement[bool], **values: Any) -> int:
        with self._engine.begin() as connection:
            return connection.execute(update(jobs).where(*where).values(**values)).rowcount


def _held(held: Job) -> tuple[ColumnElement[bool], ...]:
    return jobs.c.id == held.id, jobs.c.epoch == held.epoch, jobs.c.status == Status.RUNNING


def _expired(now: float) -> ColumnElement[bool]:
    return and_(jobs.c.status == Status.RUNNING, jobs.c.lease_until < now)
