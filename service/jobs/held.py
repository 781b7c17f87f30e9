"""A job in the hands of a worker: written only by who still holds it."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from enum import StrEnum
from typing import Any

from sqlalchemy import ColumnElement, case, select

from outcomes import Outcome
from service.jobs.database import Database
from service.jobs.job import Dataset, Drift, Job, Reached
from service.jobs.lifecycle import ENDED, Status
from service.jobs.sharing import host_of, may_run, serve_last, waiting_for_a_worker
from service.jobs.tables import JOB_COLUMNS, job_of, jobs

CANCELLED = "cancelled while it ran; no dataset is kept"


class Wish(StrEnum):
    """What becomes of a running job, as its row says."""

    GO_ON = "go_on"
    CANCEL = "cancel"  # its owner does not want it any more
    GIVE_WAY = "give_way"  # others wait, or this host is to have none


def claim(database: Database, job_id: str, lease: float, worker: str, most: int | None = None) -> HeldJob | None:
    """Take a job that waits, for `lease` seconds; None if it does not wait any more, or not for this worker.

    `worker`: its host, a colon and its process; `most`: how many jobs of one owner may run.
    """
    with database.writing() as transaction:
        if not may_run(transaction, job_id, host_of(worker), most):
            return None
        claimed = transaction.change(
            jobs.c.id == job_id, *waiting_for_a_worker(), event="started", status=Status.RUNNING,
            epoch=jobs.c.epoch + 1, attempts=jobs.c.attempts + 1, fruitless=jobs.c.fruitless + 1,
            lease_until=transaction.now + lease, started=transaction.now, worker=worker, gives_way=False,
        )  # fmt: skip
        if not claimed:
            return None
        connection = transaction.connection
        row = dict(connection.execute(
            select(*JOB_COLUMNS, jobs.c.case_json).where(jobs.c.id == job_id)
        ).mappings().one())  # fmt: skip
        case_data = json.loads(row.pop("case_json"))
        job = job_of(row)
        serve_last(transaction, job.owner)
    return HeldJob(database, job, case_data)


@dataclass(frozen=True)
class HeldJob:
    """A claimed job and its case. Each write holds only for the epoch of its claim."""

    database: Database
    job: Job
    case: dict[str, Any]

    def renew(self, lease: float, reached: Reached) -> Wish | None:
        """Lengthen the lease and tell how far the run is.

        Returns what is to become of the run; None if the job is another's now.
        """
        progressed = (jobs.c.steps != reached.steps) | (jobs.c.phase != reached.phase)
        moved = case((progressed, 1), else_=0)
        with self.database.writing() as transaction:
            renewed = transaction.change(*self._mine, lease_until=transaction.now + lease,
                                         version=jobs.c.version + moved, **asdict(reached))
            if not renewed:
                return None
            wishes = select(jobs.c.cancel_requested, jobs.c.gives_way).where(jobs.c.id == self.job.id)
            cancelled, gives_way = transaction.connection.execute(wishes).one()
        return Wish.CANCEL if cancelled else Wish.GIVE_WAY if gives_way else Wish.GO_ON

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
        """Hand back a job that could not be finished through no fault of its own: it waits again, and its owner is
        served last."""
        with self.database.writing() as transaction:
            released = transaction.change(
                *self._mine, event="handed_back", status=Status.ACCEPTED, attempts=jobs.c.attempts - 1,
                fruitless=case((jobs.c.fruitless > 0, jobs.c.fruitless - 1), else_=0), worker="",
            )  # fmt: skip
            if released:
                serve_last(transaction, self.job.owner)

    def begins_by_itself(self, message: str) -> None:
        """Tell that it does not begin with another job, and why."""
        with self.database.writing() as transaction:
            transaction.change(*self._mine, begins_with=None, message=message)

    def followers(self) -> list[int]:
        """The frames from which other jobs will begin."""
        query = select(jobs.c.begins_at).distinct().where(jobs.c.begins_with == self.job.id, jobs.c.waits)
        with self.database.reading() as connection:
            return list(connection.scalars(query))

    @property
    def _mine(self) -> tuple[ColumnElement[bool], ...]:
        return jobs.c.id == self.job.id, jobs.c.epoch == self.job.epoch, jobs.c.status == Status.RUNNING
