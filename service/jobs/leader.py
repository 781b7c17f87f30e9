"""Which of several processes reconciles: the one that renews a lease in the database."""

from __future__ import annotations

import secrets
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager

from sqlalchemy import Connection, select, update

from service.jobs.database import Database, Transaction
from service.jobs.tables import leader

LEASE = 5.0
"""Seconds of silence after which another process leads."""


class Deposed(Exception):
    """Another process leads by now: what was to be written is not."""


class Leader:
    """A claim to lead, for one process.

    A lease is over when this process has seen it unchanged for LEASE seconds, by a clock that nobody can set: so no
    clock that is wrong deposes a leader, and one that is stopped is deposed. What it writes by `writing` after it has
    been stopped for that long is refused, if another one leads by then.
    """

    def __init__(self, database: Database, clock: Callable[[], float] = time.monotonic) -> None:
        self._database, self._clock = database, clock
        self._me = secrets.token_hex(8)
        self._seen: tuple[str, int] = ("", -1)
        self._since = clock()

    @property
    def silent(self) -> float:
        """Seconds since the leader, this process or another, was last seen to renew."""
        return self._clock() - self._since

    def elected(self) -> bool:
        """Renew the lease, or take one that is over; whether this process leads. Raises what the database raises."""
        with self._database.reading() as connection:
            holder, beat = connection.execute(select(leader.c.holder, leader.c.beat)).one()
        if (holder, beat) != self._seen:
            self._seen, self._since = (holder, beat), self._clock()
        if holder not in ("", self._me) and self.silent < LEASE:
            return False
        with self._database.writing() as transaction:
            same = (leader.c.holder == holder, leader.c.beat == beat)
            statement = update(leader).where(*same).values(holder=self._me, beat=beat + 1)
            return transaction.connection.execute(statement).rowcount == 1

    def resign(self) -> None:
        """Let another lead at once."""
        with self._database.writing() as transaction:
            transaction.connection.execute(update(leader).where(leader.c.holder == self._me).values(holder=""))

    def reading(self) -> AbstractContextManager[Connection]:
        """As the database's."""
        return self._database.reading()

    @contextmanager
    def writing(self) -> Iterator[Transaction]:
        """As the database's, but raises Deposed where another process leads."""
        with self._database.writing() as transaction:
            query = select(leader.c.holder).with_for_update(read=True)  # until the commit, where it is not all locked
            if transaction.connection.scalar(query) != self._me:
                raise Deposed
            yield transaction
