"""The audit trail: who did what, written in the transaction that did it."""

from __future__ import annotations

from dataclasses import dataclass

from sqlalchemy import insert, select

from service.jobs.database import Database, Transaction
from service.jobs.tables import audit


@dataclass(frozen=True)
class Actor:
    """An owner, and the prefix of the key that was used (empty on loopback without one)."""

    owner: str
    key: str = ""


CONSOLE = Actor("console")
"""Whoever uses `hockle keys` on the service's own machine."""


@dataclass(frozen=True)
class Deed:
    """One line of the trail: `subject` is a job's id or a key's prefix. Time in Unix seconds."""

    id: int
    time: float
    owner: str
    key: str
    action: str
    subject: str


def note(transaction: Transaction, actor: Actor, action: str, *subjects: str) -> None:
    """Add a line for each subject."""
    rows = [{"time": transaction.now, "owner": actor.owner, "key": actor.key, "action": action, "subject": subject}
            for subject in subjects]  # fmt: skip
    transaction.connection.execute(insert(audit), rows)


def trail(database: Database, limit: int, before: int | None = None) -> list[Deed]:
    """At most `limit` lines, newest first, those before the line `before` only."""
    query = select(audit).order_by(audit.c.id.desc()).limit(limit)
    if before is not None:
        query = query.where(audit.c.id < before)
    with database.reading() as connection:
        return [Deed(**row) for row in connection.execute(query).mappings()]
