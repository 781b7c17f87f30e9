"""Ensembles: jobs that were handed in together, of cases that differ in some values. Each method is one transaction."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from sqlalchemy import ColumnElement, Select, func, insert, select, true, update
from sqlalchemy.exc import IntegrityError

from outcomes import Outcome
from service.jobs.audit import Actor, note
from service.jobs.database import Database, Transaction
from service.jobs.job import Job, NewJob, new_id
from service.jobs.lifecycle import ENDED, Status
from service.jobs.submission import KeyReused, Submission, Terms, submit_all
from service.jobs.tables import JOB_COLUMNS, ensembles, job_of, jobs, members


class UnknownEnsemble(LookupError):
    """No ensemble has this id."""


@dataclass(frozen=True)
class NewEnsemble:
    """What somebody wants run. `design` is JSON data that tells how the values were chosen; `values[i]` are those of
    the i-th member, whose job is `jobs[i]`: equal cases are one job.

    `key`: with the same one and the same `body_sha256` the same ensemble is given again. `reuse`: a job of the same
    owner that has run the same case is as good as a new one.
    """

    design: Mapping[str, Any]
    values: Sequence[Sequence[Any]]
    jobs: Sequence[NewJob]
    actor: Actor
    title: str = ""
    label: str = ""
    key: str = ""
    body_sha256: str = ""
    reuse: bool = True
    id: str = field(default_factory=new_id)


@dataclass(frozen=True)
class Ensemble:
    """One row. `created` in Unix seconds."""

    id: str
    owner: str
    title: str
    label: str
    design: dict[str, Any]
    created: float

    @property
    def names(self) -> list[str]:
        """The parameters."""
        return list(self.design["parameters"])


@dataclass(frozen=True)
class Standing:
    """How the members of an ensemble are doing, equal ones counted each. `version` grows with every change."""

    statuses: Counter[Status]
    outcomes: Counter[str]
    progress: float
    jobs: int
    version: int
    finished: float | None

    @property
    def members(self) -> int:
        """How many there are."""
        return self.statuses.total()

    @property
    def ended(self) -> bool:
        """Whether all have."""
        return all(status in ENDED for status in self.statuses)

    @property
    def status(self) -> Status:
        """That of the whole: once all have ended, the worst of theirs."""
        if self.ended:
            worst = (Status.DISMISSED, Status.FAILED, Status.SUCCESSFUL)
            return next((status for status in worst if self.statuses[status]), Status.SUCCESSFUL)
        return Status.ACCEPTED if set(self.statuses) == {Status.ACCEPTED} else Status.RUNNING


@dataclass(frozen=True)
class Member:
    """The values of a member, and its job."""

    number: int
    values: list[Any]
    job: Job


class Ensembles:
    """The ensembles in a database: those of one owner, or everybody's."""

    def __init__(self, database: Database, owner: str | None = None) -> None:
        """`owner`: whose are seen; all others are not there. None: everybody's."""
        self._database, self._owner = database, owner

    def submit(self, new: NewEnsemble, terms: Terms) -> str:
        """Accept all members, or none; gives the ensemble's id. Raises KeyReused, QuotaReached."""
        try:
            return self._submit(new, terms)
        except IntegrityError:  # another process has written the same key in the meantime
            return self._submit(new, terms)

    def get(self, ensemble_id: str) -> Ensemble:
        """One ensemble. Raises UnknownEnsemble."""
        query = _ensembles().where(ensembles.c.id == ensemble_id, self._visible)
        with self._database.reading() as connection:
            row = None if "\0" in ensemble_id else connection.execute(query).mappings().first()
        if row is None:
            raise UnknownEnsemble(ensemble_id)
        return _ensemble(row)

    def page(self, limit: int, after: str | None = None) -> list[Ensemble]:
        """At most so many, newest first, older than the one with the id `after`."""
        query = _ensembles().where(self._visible).order_by(ensembles.c.id.desc()).limit(limit)
        if after is not None:
            query = query.where(ensembles.c.id < after)
        with self._database.reading() as connection:
            return [_ensemble(row) for row in connection.execute(query).mappings()]

    def standing(self, ensemble_id: str) -> Standing:
        """How the members are doing."""
        query = (
            select(jobs.c.status, jobs.c.outcome, func.count().label("many"), func.sum(jobs.c.version).label("version"),
                   func.sum(jobs.c.progress).label("progress"), func.count(jobs.c.id.distinct()).label("jobs"),
                   func.max(jobs.c.finished).label("finished"))
            .select_from(_members()).where(members.c.ensemble_id == ensemble_id)
            .group_by(jobs.c.status, jobs.c.outcome)
        )  # fmt: skip
        with self._database.reading() as connection:
            rows = connection.execute(query).all()
        statuses: Counter[Status] = Counter()
        outcomes: Counter[str] = Counter()
        progress = 0.0
        for row in rows:
            statuses[Status(row.status)] += row.many
            outcomes[row.outcome] += row.many
            progress += row.many if Status(row.status) in ENDED else row.progress
        del outcomes[""]
        ended = all(status in ENDED for status in statuses)
        return Standing(statuses, outcomes, progress / max(statuses.total(), 1), sum(row.jobs for row in rows),
                        int(sum(row.version for row in rows)),
                        max((row.finished for row in rows), default=None) if ended else None)

    def version(self, ensemble_id: str) -> int:
        """The version of its standing."""
        query = select(func.sum(jobs.c.version)).select_from(_members()).where(members.c.ensemble_id == ensemble_id)
        with self._database.reading() as connection:
            return int(connection.scalar(query) or 0)

    def members(self, ensemble_id: str, limit: int | None = None, after: int = -1,
                status: Status | None = None) -> list[Member]:
        """At most so many in their order, those with a number above `after` only."""
        query = (
            select(members.c.number, members.c["values"], *JOB_COLUMNS).select_from(_members())
            .where(members.c.ensemble_id == ensemble_id, members.c.number > after)
            .order_by(members.c.number).limit(limit)
        )  # fmt: skip
        if status is not None:
            query = query.where(jobs.c.status == status)
        with self._database.reading() as connection:
            return [_member(dict(row)) for row in connection.execute(query).mappings()]

    def cancel(self, ensemble_id: str, actor: Actor) -> None:
        """Dismiss the members that wait, and tell the workers of those that run."""
        of_ensemble = jobs.c.id.in_(select(members.c.job_id).where(members.c.ensemble_id == ensemble_id))
        open_ = jobs.c.status.in_([Status.ACCEPTED, Status.RUNNING])
        with self._database.writing() as transaction:
            changed = transaction.change(of_ensemble, open_, ~jobs.c.cancel_requested, event="cancel_requested",
                                         cancel_requested=True)
            if changed:
                note(transaction, actor, "ensemble_cancelled", ensemble_id)
            transaction.change(of_ensemble, jobs.c.status == Status.ACCEPTED, event="ended", status=Status.DISMISSED,
                               outcome=Outcome.CANCELLED.value, message="cancelled before it started")

    def _submit(self, new: NewEnsemble, terms: Terms) -> str:
        with self._database.writing() as transaction:
            earlier = _ensemble_of_key(transaction, new)
            if earlier is not None:
                return earlier
            submissions: dict[str, Submission] = {}
            for job in new.jobs:
                submissions.setdefault(job.case_sha256, Submission(job, new.actor, reuse=new.reuse))
            results = submit_all(transaction, list(submissions.values()), terms)
            ids: dict[str, str] = {}
            for case_sha256, result in zip(submissions, results, strict=True):
                if isinstance(result, Exception):
                    raise result
                ids[case_sha256] = result.id
            _write(transaction, new, [ids[job.case_sha256] for job in new.jobs])
            _follow(transaction, {job.id: ids[job.case_sha256] for job in new.jobs})
        return new.id

    @property
    def _visible(self) -> ColumnElement[bool]:
        return true() if self._owner is None else ensembles.c.owner == self._owner


def _ensemble_of_key(transaction: Transaction, new: NewEnsemble) -> str | None:
    """The ensemble that came with the same key before. Raises KeyReused."""
    same = ensembles.c.owner == new.actor.owner, ensembles.c.key == new.key
    if not new.key:
        return None
    row = transaction.connection.execute(select(ensembles.c.id, ensembles.c.body_sha256).where(*same)).first()
    if row is not None and row.body_sha256 != new.body_sha256:
        raise KeyReused(new.key)
    return None if row is None else row.id


def _write(transaction: Transaction, new: NewEnsemble, job_ids: Sequence[str]) -> None:
    transaction.connection.execute(insert(ensembles), {
        "id": new.id, "owner": new.actor.owner, "title": new.title, "label": new.label,
        "design": json.dumps(new.design), "created": transaction.now, "key": new.key or None,
        "body_sha256": new.body_sha256,
    })  # fmt: skip
    transaction.connection.execute(insert(members), [
        {"ensemble_id": new.id, "number": number, "job_id": job_id, "values": json.dumps(list(values))}
        for number, (job_id, values) in enumerate(zip(job_ids, new.values, strict=True))
    ])  # fmt: skip
    note(transaction, new.actor, "ensemble_submitted", new.id)


def _follow(transaction: Transaction, accepted: Mapping[str, str]) -> None:
    """Have those that begin with a job which was not accepted, as another one is as good, begin with that; none waits
    for what has ended, or for itself."""
    for own_id, accepted_id in accepted.items():
        if own_id != accepted_id:
            followers = update(jobs).where(jobs.c.begins_with == own_id)
            ended = select(jobs.c.id).where(jobs.c.id == accepted_id, jobs.c.status.in_(ENDED)).exists()
            transaction.connection.execute(followers.values(begins_with=accepted_id, waits=~ended))
    itself = update(jobs).where(jobs.c.begins_with == jobs.c.id, jobs.c.waits)
    transaction.connection.execute(itself.values(begins_with=None, waits=False))


def _members() -> Any:
    return members.join(jobs, jobs.c.id == members.c.job_id)


def _ensembles() -> Select[Any]:
    return select(*(column for column in ensembles.columns if column.name not in ("key", "body_sha256")))


def _ensemble(row: Mapping[Any, Any]) -> Ensemble:
    return Ensemble(**{**row, "design": json.loads(row["design"])})


def _member(row: dict[Any, Any]) -> Member:
    return Member(row.pop("number"), json.loads(row.pop("values")), job_of(row))
