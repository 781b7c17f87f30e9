"""A job in the hands of a worker: taken in turn, and written only by who still holds it."""

from __future__ import annotations

import json
from collections.abc import Collection, Mapping
from dataclasses import asdict, dataclass
from typing import Any

from sqlalchemy import ColumnElement, case, exists, func, select, update

from outcomes import Outcome
from service.jobs.database import Database
from service.jobs.job import Dataset, Drift, Job, Reached
from service.jobs.lifecycle import ENDED, Status
from service.jobs.tables import JOB_COLUMNS, job_of, jobs, owners

CANCELLED = "cancelled while it ran; no dataset is kept"


def next_in_turn(database: Database, besides: Collection[str] = ()) -> str | None:
    """The job to be claimed next, but none of `besides`; None if none waits.

    It is of the owner who has the fewest running, and of these the one who was served longest ago; of
    his jobs it is the oldest among those of the highest priority.
    """
    of_owner = (jobs.c.owner == owners.c.name, *_waiting(besides))
    running = (
        select(func.count()).where(jobs.c.status == Status.RUNNING, jobs.c.owner == owners.c.name).scalar_subquery()
    )
    owner = (
        select(owners.c.name).where(exists().where(*of_owner))
        .order_by(running, owners.c.served, owners.c.name).limit(1).scalar_subquery()
    )
    his = (jobs.c.owner == owner, *_waiting(besides))
    highest = select(func.max(jobs.c.priority)).where(*his).scalar_subquery()
    oldest = select(jobs.c.id).where(*his, jobs.c.priority == highest).order_by(jobs.c.id).limit(1)
    with database.reading() as connection:
        return connection.scalar(oldest)


def claim(database: Database, job_id: str, lease: float, worker: str) -> HeldJob | None:
    """Take a job that waits, for `lease` seconds; None if it does not wait any more."""
    with database.writing() as transaction:
        taken = transaction.change(
            jobs.c.id == job_id, *_waiting(), event="started", status=Status.RUNNING,
            epoch=jobs.c.epoch + 1, attempts=jobs.c.attempts + 1, fruitless=jobs.c.fruitless + 1,
            lease_until=transaction.now + lease, started=transaction.now, worker=worker,
        )  # fmt: skip
        if not taken:
            return None
        connection = transaction.connection
        row = dict(connection.execute(
            select(*JOB_COLUMNS, jobs.c.case_json).where(jobs.c.id == job_id)
        ).mappings().one())  # fmt: skip
        case_data = json.loads(row.pop("case_json"))
        job = job_of(row)
        latest = select(func.max(owners.c.served)).scalar_subquery()
        connection.execute(update(owners).where(owners.c.name == job.owner).values(served=latest + 1))
    return HeldJob(database, job, case_data)


@dataclass(frozen=True)
class HeldJob:
    """A claimed job and its case. Each write holds only for the epoch of its claim."""

    database: Database
    job: Job
    case: dict[str, Any]

    def renew(self, lease: float, reached: Reached) -> bool | None:
        """Lengthen the lease and tell how far the run is.

        Returns whether the owner wants it cancelled; None if the job is another's now.
        """
        seen = (jobs.c.steps != reached.steps) | (jobs.c.phase != reached.phase)
        moved = case((seen, 1), else_=0)
        with self.database.writing() as transaction:
            kept = transaction.change(*self._mine, lease_until=transaction.now + lease,
                                      version=jobs.c.version + moved, **asdict(reached))
            if not kept:
                return None
            return transaction.connection.scalar(select(jobs.c.cancel_requested).where(jobs.c.id == self.job.id))

    def checkpointed(self, reached: Reached) -> bool:
        """Tell of a checkpoint; one farther than any before makes all attempts so far fruitful."""
        farther = jobs.c.checkpoint_steps < reached.steps
        with self.database.writing() as transaction:
            return bool(transaction.change(
                *self._mine, fruitless=case((farther, 0), else_=jobs.c.fruitless),
                checkpoint_steps=case((farther, reached.steps), else_=jobs.c.checkpoint_steps), **asdict(reached),
            ))  # fmt: skip

    def finish(self, status: Status, outcome: str, message: str, dataset: Dataset | None, reached: Reached,
               drift: Drift | None = None, attributes: Mapping[str, float | int | str] | None = None,
               scalars: Mapping[str, Any] | None = None) -> Status | None:
        """Write how the job ended: as told, or dismissed and without a dataset if its owner has cancelled it meanwhile.

        Returns with which status it has ended; None if it is another's now, and nothing was written. It may be tried
        again after a failure that leaves open whether it was written.
        """
        columns = {f"dataset_{name}": value for name, value in asdict(dataset).items()} if dataset else {}
        columns |= {f"drift_{name}": value for name, value in asdict(drift).items()} if drift else {}
        columns |= {"attributes": json.dumps(attributes or {}), "scalars": json.dumps(scalars) if scalars else None}
        with self.database.writing() as transaction:
            (
                transaction.change(*self._mine, ~jobs.c.cancel_requested, event="ended", status=status,
                                   outcome=outcome, message=message, **columns, **asdict(reached))
                or transaction.change(*self._mine, event="ended", status=Status.DISMISSED,
                                      outcome=Outcome.CANCELLED.value, message=CANCELLED, **asdict(reached))
            )  # fmt: skip
            ended = select(jobs.c.status).where(jobs.c.id == self.job.id, jobs.c.epoch == self.job.epoch,
                                                jobs.c.status.in_(ENDED))
            written = transaction.connection.scalar(ended)
        return Status(written) if written else None

    def release(self) -> None:
        """Hand back a job that could not be finished through no fault of its own: it waits again."""
        with self.database.writing() as transaction:
            transaction.change(
                *self._mine, event="handed_back", status=Status.ACCEPTED, attempts=jobs.c.attempts - 1,
                fruitless=case((jobs.c.fruitless > 0, jobs.c.fruitless - 1), else_=0), worker="",
            )  # fmt: skip

    def followers(self) -> list[int]:
        """The frames from which other jobs will begin."""
        query = select(jobs.c.begins_at).distinct().where(jobs.c.begins_with == self.job.id, jobs.c.waits)
        with self.database.reading() as connection:
            return list(connection.scalars(query))

    @property
    def _mine(self) -> tuple[ColumnElement[bool], ...]:
        return jobs.c.id == self.job.id, jobs.c.epoch == self.job.epoch, jobs.c.status == Status.RUNNING


def _waiting(besides: Collection[str] = ()) -> tuple[ColumnElement[bool], ...]:
    free = (jobs.c.status == Status.ACCEPTED, ~jobs.c.cancel_requested, ~jobs.c.waits)
    return (*free, jobs.c.id.not_in(besides)) if besides else free
