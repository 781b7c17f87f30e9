"""How the registry does, as an operator watches it: read from the rows, so alike in every process."""

from __future__ import annotations

from dataclasses import dataclass

from sqlalchemy import Column, ColumnElement, case, func, select

from service.jobs.database import Database
from service.jobs.lifecycle import ENDED, Status
from service.jobs.tables import jobs, owners

BOUNDS = [10.0**exponent for exponent in range(-15, 1)]
"""Of the histograms: what is drift at all lies anywhere between rounding and one."""


@dataclass(frozen=True)
class Histogram:
    """Ended runs by one method: how many lie below each of BOUNDS, how many there are, and the sum of their values."""

    method: str
    below: list[int]
    count: int
    total: float


@dataclass(frozen=True)
class Measures:
    """Jobs by status and, of those that ended, by status and outcome; ages in seconds; steps of all jobs together.

    `queue_age`: how long the oldest waiting job waits. `lease_age`: how long ago the most silent worker renewed.
    `bytes` of datasets by owner, `lost` datasets that are missing or damaged, `pinned` and `deleted` jobs.
    `drift_topology` (turn) and `drift_energy`: of ended runs, as service.jobs.Drift has them.
    """

    by_status: dict[str, int]
    by_outcome: dict[tuple[str, str], int]
    queue_age: float
    lease_age: float
    steps: int
    steps_redone: int
    bytes: dict[str, int]
    lost: int
    pinned: int
    deleted: int
    drift_topology: list[Histogram]
    drift_energy: list[Histogram]


def measure(database: Database, lease: float, now: float) -> Measures:
    """The measures at the time `now`, where a lease lasts `lease` seconds."""
    with database.reading() as connection:
        rows = connection.execute(
            select(jobs.c.status, jobs.c.outcome, func.count(), func.sum(jobs.c.steps), func.sum(jobs.c.steps_redone))
            .group_by(jobs.c.status, jobs.c.outcome)
        ).all()  # fmt: skip
        oldest = connection.scalar(select(func.min(jobs.c.created)).where(jobs.c.status == Status.ACCEPTED))
        bytes_ = {row.name: row.bytes for row in connection.execute(select(owners.c.name, owners.c.bytes))}
        counts = connection.execute(select(
            _count(jobs.c.dataset_fault != ""), _count(jobs.c.pinned), _count(jobs.c.deleted.is_not(None))
        )).one()  # fmt: skip
        silent = connection.scalar(select(func.min(jobs.c.lease_until)).where(jobs.c.status == Status.RUNNING))
    by_status = {status.value: 0 for status in Status}
    for status, _, count, _, _ in rows:
        by_status[status] += count
    return Measures(
        by_status,
        {(status, outcome): count for status, outcome, count, _, _ in rows if status in ENDED},
        max(0.0, now - oldest) if oldest is not None else 0.0,
        max(0.0, now - (silent - lease)) if silent is not None else 0.0,
        sum(int(steps) for *_, steps, _ in rows),
        sum(int(redone) for *_, redone in rows),
        bytes_,
        *counts,
        _histograms(database, jobs.c.drift_topology),
        _histograms(database, jobs.c.drift_energy),
    )


def _count(condition: ColumnElement[bool]) -> ColumnElement[int]:
    return func.coalesce(func.sum(case((condition, 1), else_=0)), 0)


def counted(database: Database) -> tuple[int, int]:
    """How many jobs wait, and how many run."""
    unfinished = jobs.c.status.in_((Status.ACCEPTED, Status.RUNNING))
    with database.reading() as connection:
        rows = connection.execute(select(jobs.c.status, func.count()).where(unfinished).group_by(jobs.c.status)).all()
    counts: dict[str, int] = dict(map(tuple, rows))
    return counts.get(Status.ACCEPTED, 0), counts.get(Status.RUNNING, 0)


def _histograms(database: Database, column: Column[float]) -> list[Histogram]:
    """The values of a column by the method of their runs."""
    below = [func.sum(case((column <= bound, 1), else_=0)) for bound in BOUNDS]
    query = select(jobs.c.drift_method, func.count(column), func.sum(column), *below).where(column.is_not(None))
    with database.reading() as connection:
        rows = connection.execute(query.group_by(jobs.c.drift_method).order_by(jobs.c.drift_method)).all()
    return [Histogram(method, [int(n) for n in below], count, total) for method, count, total, *below in rows]
