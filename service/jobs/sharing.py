"""How the workers are shared out between owners: whose job is next, and whose gives way where others wait."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Sequence
from dataclasses import dataclass

from sqlalchemy import ColumnElement, exists, func, select, true, update

from service.jobs.database import Database, Transaction
from service.jobs.leader import Leader
from service.jobs.lifecycle import Status
from service.jobs.tables import jobs, owners, pauses

PATIENCE = 5.0
"""Seconds that a job has waited before another gives way to it: for so long a worker may just be free."""
ALL_HOSTS = ""


def next_in_turn(database: Database, besides: Collection[str] = (), host: str = ALL_HOSTS,
                 most: int | None = None) -> str | None:
    """The job to be claimed next on a host, but none of `besides`; None if none waits, or may be had.

    It is of the owner who has the fewest running, fewer than `most`, and of these the one who was served longest ago;
    of his jobs it is the oldest among those of the highest priority.
    """
    of_owner = (jobs.c.owner == owners.c.name, *waiting_for_a_worker(besides))
    running = (
        select(func.count()).where(jobs.c.status == Status.RUNNING, jobs.c.owner == owners.c.name).scalar_subquery()
    )
    # the first row, not `exists` and `max`: by old statistics, with no job that waits, PostgreSQL reads all that wait
    waits = select(jobs.c.id).where(*of_owner).limit(1).scalar_subquery().is_not(None)
    owner = (
        select(owners.c.name)
        .where(waits, ~_paused(host), true() if most is None else running < most)
        .order_by(running, owners.c.served, owners.c.name).limit(1).scalar_subquery()
    )  # fmt: skip
    of_next_owner = (jobs.c.owner == owner, *waiting_for_a_worker(besides))
    highest = (
        select(jobs.c.priority).where(*of_next_owner).order_by(jobs.c.priority.desc()).limit(1).scalar_subquery()
    )
    oldest = select(jobs.c.id).where(*of_next_owner, jobs.c.priority == highest).order_by(jobs.c.id).limit(1)
    with database.reading() as connection:
        return connection.scalar(oldest)


def may_run(transaction: Transaction, job_id: str, host: str, most: int | None) -> bool:
    """Whether a job may be started now on a host: no pause, and fewer than `most` of its owner running."""
    connection = transaction.connection
    if connection.scalar(select(_paused(host))):
        return False
    if most is None:
        return True
    owner = select(jobs.c.owner).where(jobs.c.id == job_id).scalar_subquery()
    claiming = select(owners.c.name).where(owners.c.name == owner).with_for_update()  # one at a time of an owner
    connection.execute(claiming)
    running = select(func.count()).where(jobs.c.owner == owner, jobs.c.status == Status.RUNNING)
    return (connection.scalar(running) or 0) < most


def waiting_for_a_worker(besides: Collection[str] = ()) -> tuple[ColumnElement[bool], ...]:
    """What holds for the jobs that wait, but for some."""
    free = (jobs.c.status == Status.ACCEPTED, ~jobs.c.cancel_requested, ~jobs.c.waits)
    return (*free, jobs.c.id.not_in(besides)) if besides else free


def serve_last(transaction: Transaction, owner: str) -> None:
    """Let all other owners with as many running jobs go before this one."""
    latest = select(func.max(owners.c.served)).scalar_subquery()
    transaction.connection.execute(update(owners).where(owners.c.name == owner).values(served=latest + 1))


def host_of(worker: str) -> str:
    """The host of a worker, which names itself by host and process."""
    return worker.rpartition(":")[0]


@dataclass(frozen=True)
class Running:
    """A running job: whose it is, since when (Unix seconds), and whether it gives way already."""

    id: str
    owner: str
    started: float
    gives_way: bool


def make_room(database: Database | Leader, turn: float, most: int | None, now: float) -> None:
    """Have jobs that have run for `turn` seconds give way to those of owners who have fewer running, at the time
    `now`."""
    waits = select(jobs.c.owner).where(*waiting_for_a_worker(), jobs.c.created < now - PATIENCE, ~_paused()).distinct()
    runs = select(jobs.c.id, jobs.c.owner, jobs.c.started, jobs.c.gives_way).where(jobs.c.status == Status.RUNNING)
    with database.reading() as connection:
        waiting = connection.scalars(waits).all()
        running = [Running(*row) for row in connection.execute(runs)] if waiting else []
    if chosen := choose(waiting, running, now - turn, most):
        with database.writing() as transaction:
            give_way(transaction, jobs.c.id.in_(chosen))


def give_way(transaction: Transaction, *where: ColumnElement[bool]) -> None:
    """Have running jobs be handed back with a checkpoint."""
    transaction.change(*where, jobs.c.status == Status.RUNNING, ~jobs.c.gives_way, gives_way=True)


def choose(waiting: Collection[str], running: Sequence[Running], before: float, most: int | None = None) -> list[str]:
    """Which of the running jobs give way to the owners who wait: for each owner one at the most, that began `before`.

    It is one of the owner who has the most running, so that none has more than one more than another; where one has
    none at all, of any other. A job that gives way already is a place for the one who waits first.
    """
    count = Counter(job.owner for job in running if not job.gives_way)
    leaving = sum(job.gives_way for job in running)
    old = {job.id: job for job in running if not job.gives_way and job.started <= before}
    chosen: list[str] = []
    for owner in sorted(waiting, key=lambda owner: (count[owner], owner)):
        if most is not None and count[owner] >= most:
            continue
        if leaving:
            leaving -= 1
            continue
        than = 0 if count[owner] == 0 else count[owner] + 1
        candidates = [job for job in old.values() if job.owner != owner and count[job.owner] > than]
        if not candidates:
            continue
        longest = min(candidates, key=lambda job: (-count[job.owner], job.started))
        chosen.append(longest.id)
        count[longest.owner] -= 1
        count[owner] += 1
        del old[longest.id]
    return chosen


def _paused(host: str = ALL_HOSTS) -> ColumnElement[bool]:
    """Whether a host, or the whole queue, is paused."""
    return exists().where(pauses.c.host.in_((host, ALL_HOSTS)))
