"""Pauses: while one holds, workers of a host, or all, take no job; where it drains, they hand back what they run."""

from __future__ import annotations

from dataclasses import dataclass

from sqlalchemy import ColumnElement, delete, insert, select, true

from service.jobs.audit import Actor, note
from service.jobs.database import Database
from service.jobs.leader import Leader
from service.jobs.lifecycle import Status
from service.jobs.sharing import ALL_HOSTS, give_way
from service.jobs.tables import jobs, pauses


@dataclass(frozen=True)
class Pause:
    """Of a host, or of all (host empty): since when (Unix seconds), by whom, and whether jobs are handed back."""

    host: str
    drains: bool
    since: float
    owner: str


def pause(database: Database, host: str, drains: bool, actor: Actor) -> None:
    """Have a host, or all, take no more jobs, and, if it `drains`, hand back those it runs, with a checkpoint."""
    with database.writing() as transaction:
        transaction.connection.execute(delete(pauses).where(pauses.c.host == host))
        row = {"host": host, "drains": drains, "since": transaction.now, "owner": actor.owner}
        transaction.connection.execute(insert(pauses), row)
        if drains:
            give_way(transaction, _runs_on(host))
        note(transaction, actor, f"{_what(host)}_{'drained' if drains else 'paused'}", host)


def resume(database: Database, host: str, actor: Actor) -> bool:
    """End the pause of a host, or of all; whether there was one."""
    with database.writing() as transaction:
        ended = transaction.connection.execute(delete(pauses).where(pauses.c.host == host)).rowcount > 0
        if ended:
            note(transaction, actor, f"{_what(host)}_resumed", host)
    return ended


def paused(database: Database) -> list[Pause]:
    """The pauses that hold, that of all hosts first."""
    with database.reading() as connection:
        return [Pause(**row) for row in connection.execute(select(pauses).order_by(pauses.c.host)).mappings()]


def drain(database: Database | Leader) -> None:
    """Have what runs where it should not be handed back, also what was claimed while a pause began."""
    with database.reading() as connection:
        drained = connection.scalars(select(pauses.c.host).where(pauses.c.drains)).all()
        job_ids = [connection.scalar(select(jobs.c.id).where(_runs_on(host), ~jobs.c.gives_way).limit(1))
                 for host in drained]  # fmt: skip
    if not any(job_ids):
        return
    with database.writing() as transaction:
        for host in drained:
            give_way(transaction, _runs_on(host))


def _runs_on(host: str) -> ColumnElement[bool]:
    running = jobs.c.status == Status.RUNNING
    return running & (true() if host == ALL_HOSTS else jobs.c.worker.startswith(f"{host}:", autoescape=True))


def _what(host: str) -> str:
    return "queue" if host == ALL_HOSTS else "host"
