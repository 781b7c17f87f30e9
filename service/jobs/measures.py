"""How the registry does, as an operator watches it: read from the rows, so alike in every process."""

from __future__ import annotations

from dataclasses import dataclass

from sqlalchemy import func, select

from service.jobs.database import Database
from service.jobs.lifecycle import ENDED, Status
from service.jobs.tables import jobs


@dataclass(frozen=True)
class Measures:
    """Jobs by status and, of those that ended, by status and outcome; ages in seconds; steps of all jobs together.

    `queue_age`: how long the oldest waiting job waits. `lease_age`: how long ago the most silent worker renewed.
    """

    by_status: dict[str, int]
    by_outcome: dict[tuple[str, str], int]
    queue_age: float
    lease_age: float
    steps: int
    steps_redone: int


def measure(database: Database, lease: float, now: float) -> Measures:
    """The measures at the time `now`, where a lease lasts `lease` seconds."""
    with database.reading() as connection:
        many = connection.execute(
            select(jobs.c.status, jobs.c.outcome, func.count(), func.sum(jobs.c.steps), func.sum(jobs.c.steps_redone))
            .group_by(jobs.c.status, jobs.c.outcome)
        ).all()  # fmt: skip
        oldest = connection.scalar(select(func.min(jobs.c.created)).where(jobs.c.status == Status.ACCEPTED))
        silent = connection.scalar(select(func.min(jobs.c.lease_until)).where(jobs.c.status == Status.RUNNING))
    by_status = {status.value: 0 for status in Status}
    for status, _, count, _, _ in many:
        by_status[status] += count
    return Measures(
        by_status,
        {(status, outcome): count for status, outcome, count, _, _ in many if status in ENDED},
        max(0.0, now - oldest) if oldest is not None else 0.0,
        max(0.0, now - (silent - lease)) if silent is not None else 0.0,
        sum(int(steps) for *_, steps, _ in many),
        sum(int(redone) for *_, redone in many),
    )
