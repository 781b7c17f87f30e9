"""What comes of a submission: a new job, the one that its idempotency key stands for, or one that has run it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, replace

from sqlalchemy import bindparam, delete, func, insert, select, tuple_

from service.jobs.audit import Actor, note
from service.jobs.database import Transaction
from service.jobs.job import Job, NewJob, Webhook
from service.jobs.lifecycle import Status
from service.jobs.registry import DeletedJob, insert_jobs
from service.jobs.tables import JOBS, idempotency_keys, job_of, jobs, owners, webhooks

REMEMBERED = 3 * 86400.0
"""How long (s) an idempotency key is remembered: a day, which is promised, between clocks that are a day wrong."""

REUSABLE = (jobs.c.status == Status.SUCCESSFUL) & jobs.c.deleted.is_(None) & (jobs.c.dataset_fault == "")
ALIKE = (
    select(jobs.c.owner, jobs.c.case_sha256, func.max(jobs.c.id).filter(REUSABLE).label("id"))
    .where(jobs.c.case_sha256.in_(bindparam("hashes", expanding=True)))
    .group_by(jobs.c.owner, jobs.c.case_sha256)
)
"""By the cases alone: with more conditions SQLite, and PostgreSQL without statistics, read all that is not deleted."""
MOST_KEYS = 100_000
"""Idempotency keys that are remembered of one owner: whoever sends more must wait until some are forgotten."""
OWNED = (
    select(owners.c.name, owners.c.unfinished, owners.c.bytes)
    .where(owners.c.name.in_(bindparam("names", expanding=True)))
)


class KeyReused(Exception):
    """The idempotency key came with another body before."""


class QuotaReached(Exception):
    """The owner has as many unfinished jobs as one may have, or bytes of datasets."""


@dataclass(frozen=True)
class Submission:
    """A job that somebody wants, and on what terms.

    `key`: with the same one and the same `body_sha256` the same job is given again. `reuse`: a job of the same
    owner that has run the same case is as good. `webhook`: whom to tell of the end.
    """

    new: NewJob
    actor: Actor
    key: str = ""
    body_sha256: str = ""
    reuse: bool = False
    webhook: str = ""

    @property
    def mark(self) -> tuple[str, str]:
        """What the idempotency key is known by."""
        return self.new.owner, self.key


@dataclass(frozen=True)
class Terms:
    """What every owner may have: so many unfinished jobs, and bytes of datasets (None: as many as there is room for).

    `looks_good`: whether a dataset (its file, its stamp) looks as it did when it was good: only then is it given again.
    """

    unfinished: int
    bytes: int | None = None
    looks_good: Callable[[str, str], bool] = lambda _file, _stamp: True


def submit_all(transaction: Transaction, submissions: Sequence[Submission], terms: Terms) -> list[Job | Exception]:
    """Write what is new of some submissions; gives the job of each, or why there is none."""
    desk = _Desk(transaction, submissions, terms)
    verdicts = [desk.judge(submission) for submission in submissions]
    now = {job.id: job for job in desk.write()}
    if older := {verdict for verdict in verdicts if isinstance(verdict, str)} - now.keys():
        rows = transaction.connection.execute(JOBS.where(jobs.c.id.in_(older))).mappings()
        now |= {row["id"]: job_of(row) for row in rows}
    return [_unless_deleted(now[verdict]) if isinstance(verdict, str) else verdict for verdict in verdicts]


def _unless_deleted(job: Job) -> Job | DeletedJob:
    return job if job.deleted is None else DeletedJob(job)


class _Desk:
    """What is known when some submissions are judged, one after the other, and what is to be written of them."""

    def __init__(self, transaction: Transaction, submissions: Sequence[Submission], terms: Terms) -> None:
        self._transaction, self._terms = transaction, terms
        keyed = [submission for submission in submissions if submission.key]
        reusing = {submission.new.case_sha256 for submission in submissions if submission.reuse}
        self._answered = _answered(transaction, {submission.mark for submission in keyed})
        self._alike = _alike(transaction, reusing, terms.looks_good)
        self._unfinished, self._bytes = _owned(transaction, {submission.new.owner for submission in submissions})
        self._remembered = _remembered(transaction, {submission.new.owner for submission in keyed})
        self._accepted: list[Submission] = []
        self._keys: list[dict[str, object]] = []

    def judge(self, submission: Submission) -> str | Exception:
        """The id of the job that a submission is answered with."""
        new = submission.new
        if submission.key and submission.mark in self._answered:
            body_sha256, job_id = self._answered[submission.mark]
            return job_id if body_sha256 == submission.body_sha256 else KeyReused(submission.key)
        if submission.key and self._remembered[new.owner] >= MOST_KEYS:
            return QuotaReached(f"{new.owner} has {MOST_KEYS:,} idempotency keys that are remembered for three "
                                "days, and may have no more: wait, or send none")
        verdict = self._alike.get((new.owner, new.case_sha256)) if submission.reuse else None
        if verdict is None:
            if refusal := self._beyond(new.owner):
                return refusal
            self._unfinished[new.owner] += 1
            self._accepted.append(submission)
            verdict = new.id
        if submission.key:
            self._remembered[new.owner] += 1
            self._answered[submission.mark] = submission.body_sha256, verdict
            self._keys.append({"owner": new.owner, "key": submission.key, "body_sha256": submission.body_sha256,
                               "job_id": verdict, "created": self._transaction.now})
        return verdict

    def _beyond(self, owner: str) -> QuotaReached | None:
        """Why this owner may have no job more."""
        many, size = self._unfinished[owner], self._bytes[owner]
        if many >= self._terms.unfinished:
            return QuotaReached(f"{owner} has {many} unfinished jobs, and may have {self._terms.unfinished}: "
                                "wait for some of them, or cancel them")
        if self._terms.bytes is not None and size >= self._terms.bytes:
            return QuotaReached(f"{owner} has {size:,} bytes of datasets, and may have {self._terms.bytes:,}: "
                                "delete some jobs")
        return None

    def write(self) -> list[Job]:
        """Write the jobs that are new, and what belongs to them; gives the jobs."""
        connection = self._transaction.connection
        new = [submission.new for submission in self._accepted]
        accepted = insert_jobs(self._transaction, new) if new else []
        for actor in {submission.actor for submission in self._accepted}:
            ids = [submission.new.id for submission in self._accepted if submission.actor == actor]
            note(self._transaction, actor, "job_submitted", *ids)
        if self._keys:
            connection.execute(insert(idempotency_keys), self._keys)
        hooked = [submission for submission in self._accepted if submission.webhook]
        if not hooked:
            return accepted
        connection.execute(insert(webhooks), [
            {"job_id": submission.new.id, "url": submission.webhook, "key": submission.actor.key, "due": 0.0}
            for submission in hooked
        ])  # fmt: skip
        hooks = {submission.new.id: Webhook(submission.webhook) for submission in hooked}
        return [replace(job, webhook=hooks.get(job.id)) for job in accepted]


def _answered(transaction: Transaction, marks: Collection[tuple[str, str]]) -> dict[tuple[str, str], tuple[str, str]]:
    """Body and job of the idempotency keys that came before."""
    if not marks:
        return {}
    table = idempotency_keys.c
    connection = transaction.connection
    forget_keys(transaction)
    rows = connection.execute(
        select(table.owner, table.key, table.body_sha256, table.job_id).where(tuple_(table.owner, table.key).in_(marks))
    )
    return {(row.owner, row.key): (row.body_sha256, row.job_id) for row in rows}


def forget_keys(transaction: Transaction) -> None:
    """Forget the idempotency keys that are remembered no longer."""
    old = idempotency_keys.c.created < transaction.now - REMEMBERED
    transaction.connection.execute(delete(idempotency_keys).where(old))


def _remembered(transaction: Transaction, names: Collection[str]) -> Counter[str]:
    """How many idempotency keys of some owners are remembered, counted up to MOST_KEYS."""
    many = Counter[str]()
    for name in names:
        keys = select(idempotency_keys.c.key).where(idempotency_keys.c.owner == name).limit(MOST_KEYS).subquery()
        many[name] = transaction.connection.scalar(select(func.count()).select_from(keys)) or 0
    return many


def _alike(transaction: Transaction, hashes: Collection[str],
           looks_good: Callable[[str, str], bool]) -> dict[tuple[str, str], str]:
    """The newest successful job of each case, by owner and hash, if its dataset looks good."""
    if not hashes:
        return {}
    connection = transaction.connection
    newest = {row.id: (row.owner, row.case_sha256) for row in connection.execute(ALIKE, {"hashes": list(hashes)})
              if row.id is not None}
    if not newest:
        return {}
    published = select(jobs.c.id, jobs.c.dataset_file, jobs.c.dataset_stamp).where(jobs.c.id.in_(newest))
    return {newest[job_id]: job_id for job_id, *dataset in connection.execute(published) if looks_good(*dataset)}


def _owned(transaction: Transaction, names: Collection[str]) -> tuple[Counter[str], Counter[str]]:
    """How many unfinished jobs, and bytes of datasets, each of some owners has."""
    rows = transaction.connection.execute(OWNED, {"names": list(names)}).all()
    return Counter({row.name: row.unfinished for row in rows}), Counter({row.name: row.bytes for row in rows})
