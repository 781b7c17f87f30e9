"""What owners do with jobs. Each method is one transaction."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from sqlalchemy import ColumnElement, Executable, bindparam, func, insert, select, true
from sqlalchemy.dialects import postgresql, sqlite

from outcomes import Outcome
from service.jobs.audit import Actor, note
from service.jobs.database import Database, Transaction
from service.jobs.deletion import delete_jobs
from service.jobs.job import Job, NewJob
from service.jobs.lifecycle import ENDED, Status
from service.jobs.tables import FRESH, JOBS, events, job_of, jobs, members, owners

AT_ONCE = 1000
ONE_JOB = JOBS.where(jobs.c.id == bindparam("job_id"))
"""The read that is made most: put together once."""


class UnknownJob(LookupError):
    """No job has this id."""


class DeletedJob(UnknownJob):
    """The job that has this id was deleted; of it stays when and by whom."""

    def __init__(self, job: Job) -> None:
        super().__init__(job.id)
        self.job = job


class Pinned(Exception):
    """The job is pinned, and so cannot be deleted."""


@dataclass(frozen=True)
class Page:
    """Some jobs, newest first, and the cursor after which the next page starts (None at the end)."""

    jobs: list[Job]
    next: str | None


@dataclass(frozen=True)
class Selection:
    """Which jobs a page holds: all those that meet what is given. Times are Unix seconds of submission."""

    after: str | None = None  # older than this id
    status: Status | None = None
    label: str | None = None
    owner: str | None = None
    since: float | None = None
    until: float | None = None
    ensemble: str | None = None


@dataclass(frozen=True)
class Event:
    """What happened to a job. `seq` is the job's version after it, `time` Unix seconds."""

    seq: int
    time: float
    kind: str
    data: dict[str, Any]


class Registry:
    """The jobs in a database: those of one owner, or everybody's."""

    def __init__(self, database: Database, owner: str | None = None) -> None:
        """`owner`: whose jobs are seen; all others are not there. None: everybody's."""
        self.database, self.owner = database, owner

    def of(self, owner: str | None) -> Registry:
        """The registry as this owner sees it."""
        return Registry(self.database, owner)

    def submit(self, new: NewJob) -> Job:
        """Write an accepted job; when this returns, it is on disk."""
        with self.database.writing() as transaction:
            [job] = insert_jobs(transaction, [new])
        return job

    def get(self, job_id: str) -> Job:
        """One job, by a point read. Raises UnknownJob, DeletedJob."""
        _check(job_id)
        with self.database.reading() as connection:
            row = connection.execute(ONE_JOB, {"job_id": job_id}).mappings().first()
        if row is None or self.owner not in (None, row["owner"]):
            raise UnknownJob(job_id)
        job = job_of(row)
        if job.deleted is not None:
            raise DeletedJob(job)
        return job

    def case(self, job_id: str) -> dict[str, Any]:
        """The case of a job. Raises UnknownJob, DeletedJob."""
        self.get(job_id)
        with self.database.reading() as connection:
            text = connection.scalar(select(jobs.c.case_json).where(jobs.c.id == job_id))
        case: dict[str, Any] = json.loads(text or "{}")
        return case

    def scalars(self, job_ids: Collection[str]) -> dict[str, dict[str, Any]]:
        """The last values of some jobs, by id; those of which only a dataset tells are left out."""
        scalars: dict[str, dict[str, Any]] = {}
        with self.database.reading() as connection:
            for batch in _batches(list(job_ids)):
                query = select(jobs.c.id, jobs.c.scalars).where(jobs.c.id.in_(batch), self._visible)
                scalars |= {row.id: json.loads(row.scalars) for row in connection.execute(query) if row.scalars}
        return scalars

    def page(self, limit: int, selection: Selection = Selection()) -> Page:
        """At most `limit` jobs of a selection, newest first."""
        conditions = (self._visible, jobs.c.deleted.is_(None))
        query = JOBS.where(*conditions).order_by(jobs.c.id.desc()).limit(limit + 1)
        filters = {jobs.c.status: selection.status, jobs.c.label: selection.label, jobs.c.owner: selection.owner}
        query = query.where(*(column == value for column, value in filters.items() if value is not None))
        if selection.ensemble is not None:
            of_ensemble = select(members.c.job_id).where(members.c.ensemble_id == selection.ensemble)
            query = query.where(jobs.c.id.in_(of_ensemble))
        if selection.after is not None:
            query = query.where(jobs.c.id < selection.after)
        if selection.since is not None:
            query = query.where(jobs.c.created >= selection.since)
        if selection.until is not None:
            query = query.where(jobs.c.created < selection.until)
        with self.database.reading() as connection:
            listed = [job_of(row) for row in connection.execute(query).mappings()]
        return Page(listed[:limit], listed[limit - 1].id if len(listed) > limit else None)

    def before(self, job: Job) -> int:
        """How many waiting jobs of the same owner go first; 0 for a job that does not wait."""
        if job.status is not Status.ACCEPTED:
            return 0
        sooner = (jobs.c.priority > job.priority) | ((jobs.c.priority == job.priority) & (jobs.c.id < job.id))
        with self.database.reading() as connection:
            query = select(func.count()).where(jobs.c.status == Status.ACCEPTED, jobs.c.owner == job.owner, sooner)
            return connection.scalar(query) or 0

    def cancel(self, job_id: str, actor: Actor | None = None) -> Job:
        """Dismiss a job that waits; tell the worker of one that runs. Raises UnknownJob, DeletedJob."""
        _check(job_id)
        with self.database.writing() as transaction:
            conditions = (jobs.c.id == job_id, self._visible)
            open_ = jobs.c.status.in_([Status.ACCEPTED, Status.RUNNING])
            if transaction.change(*conditions, open_, ~jobs.c.cancel_requested, event="cancel_requested",
                                  cancel_requested=True) and actor is not None:
                note(transaction, actor, "job_cancelled", job_id)
            transaction.change(*conditions, jobs.c.status == Status.ACCEPTED, event="ended", status=Status.DISMISSED,
                               outcome=Outcome.CANCELLED.value, message="cancelled before it started")
        return self.get(job_id)

    def delete(self, job_id: str, actor: Actor) -> bool:
        """Delete a job that has ended; False if it has not. Raises UnknownJob, DeletedJob, Pinned."""
        job = self.get(job_id)
        if job.status not in ENDED:
            return False
        with self.database.writing() as transaction:
            deleted = delete_jobs(transaction, actor, [job_id])
        if not deleted:  # somebody has just pinned it, if not deleted it
            self.get(job_id)
            raise Pinned(job_id)
        return True

    def pin(self, job_id: str, pinned: bool, actor: Actor) -> Job:
        """Have a job kept whatever retention says, or no more. Raises UnknownJob, DeletedJob."""
        _check(job_id)
        with self.database.writing() as transaction:
            other = (jobs.c.id == job_id, self._visible, jobs.c.deleted.is_(None), jobs.c.pinned != pinned)
            if transaction.change(*other, pinned=pinned):
                note(transaction, actor, "job_pinned" if pinned else "job_unpinned", job_id)
        return self.get(job_id)

    def versions(self, job_ids: Collection[str]) -> dict[str, int]:
        """The versions of some jobs, by id."""
        with self.database.reading() as connection:
            rows = connection.execute(select(jobs.c.id, jobs.c.version).where(jobs.c.id.in_(job_ids), self._visible))
            return {row.id: row.version for row in rows}

    def events(self, job_id: str, after: int = 0) -> list[Event]:
        """What happened to a job since its version `after`, oldest first."""
        query = select(events.c.seq, events.c.time, events.c.kind, events.c.data).order_by(events.c.seq)
        query = query.join(jobs, jobs.c.id == events.c.job_id).where(jobs.c.id == job_id, self._visible)
        with self.database.reading() as connection:
            rows = connection.execute(query.where(events.c.seq > after))
            return [Event(row.seq, row.time, row.kind, json.loads(row.data)) for row in rows]

    @property
    def _visible(self) -> ColumnElement[bool]:
        return true() if self.owner is None else jobs.c.owner == self.owner


def _adding(dialect: Any) -> Executable:
    """An owner with so many unfinished jobs, or with so many more."""
    added = dialect.insert(owners)
    more = {"unfinished": owners.c.unfinished + added.excluded.unfinished}
    return added.on_conflict_do_update(index_elements=["name"], set_=more)  # type: ignore[no-any-return]


ADD_UNFINISHED = {"sqlite": _adding(sqlite), "postgresql": _adding(postgresql)}
"""By the dialect's name; put together once, not with each submission."""


def insert_jobs(transaction: Transaction, new: Sequence[NewJob]) -> list[Job]:
    """Write accepted jobs, the owners that are new, and the jobs' first events; gives the jobs."""
    connection = transaction.connection
    many = sorted(Counter(job.owner for job in new).items())  # in one order: rows are locked in it
    counts = [{"name": owner, "unfinished": more} for owner, more in many]
    connection.execute(ADD_UNFINISHED[connection.dialect.name], counts)
    rows = [{
        "id": job.id, "owner": job.owner, "status": Status.ACCEPTED.value, "title": job.title, "label": job.label,
        "priority": job.priority, "case_json": job.case_json, "case_sha256": job.case_sha256,
        "created": transaction.now, "limit_wall": job.limits.wall, "limit_memory": job.limits.memory,
        "limit_disk": job.limits.disk, "begins_with": job.begins_with, "begins_at": job.begins_at, "waits": job.waits,
        "message": job.message,
    } for job in new]  # fmt: skip
    connection.execute(insert(jobs), rows)
    first = json.dumps({"status": Status.ACCEPTED.value})
    connection.execute(insert(events), [{"job_id": job.id, "seq": 1, "time": transaction.now, "kind": "accepted",
                                         "data": first} for job in new])  # fmt: skip
    return [job_of({name: row.get(name, unwritten) for name, unwritten in FRESH.items()}) for row in rows]


def _batches(ids: Sequence[str]) -> Iterator[Sequence[str]]:
    """As many as a query may name."""
    for start in range(0, len(ids), AT_ONCE):
        yield ids[start : start + AT_ONCE]


def _check(job_id: str) -> None:
    """PostgreSQL takes no NUL in a text."""
    if "\0" in job_id:
        raise UnknownJob(job_id)
