"""How the registry's database is opened, read and written."""

from __future__ import annotations

import json
import sqlite3
import time
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass
from typing import Any

from sqlalchemy import ColumnElement, Connection, Engine, create_engine, event, insert, update
from sqlalchemy.exc import OperationalError

from service.jobs.lifecycle import ENDED, Status, allowed_before
from service.jobs.migrations import migrate
from service.jobs.tables import events, jobs, owners
from service.jobs.turn import turn

BUSY = 20.0
"""Seconds for which a write waits for another one, or for a connection."""

FOUND_DEAD = {
    "connect_timeout": 5, "keepalives_idle": 10, "keepalives_interval": 5, "keepalives_count": 3,
    "tcp_user_timeout": 15_000,  # ms
    "options": "-c tcp_keepalives_idle=10 -c tcp_keepalives_interval=5 -c tcp_keepalives_count=3",
}  # fmt: skip
"""Of connections to PostgreSQL: each side finds within some 25 s that the other's host is gone, not within hours. Else
nobody would reconcile, since the lock of a dead leader lies in its session, and no request would be answered."""

PRIMARY = 0xFF
"""The part of SQLite's error codes that says what, not why: another process may also be recovering the log."""


@dataclass(frozen=True)
class Transaction:
    """Writes that are made together, or not at all. `now` is the Unix time they happen at."""

    connection: Connection
    now: float

    def change(self, *where: ColumnElement[bool], event: str = "", status: Status | None = None,
               **values: Any) -> list[str]:
        """Change the jobs that meet `where`, and give their ids.

        Each gets the next version, and the event if one is named. To a new `status` go only those that
        the lifecycle lets; in one that ends them they lose their lease.
        """
        if status is not None:
            where = (*where, jobs.c.status.in_(allowed_before(status)))
            values |= {"status": status.value}
            if status is not Status.RUNNING:
                values |= {"lease_until": None}
            if status in ENDED:
                values |= {"finished": self.now}
        values = {"version": jobs.c.version + 1} | values
        changed = self.connection.execute(
            update(jobs).where(*where).values(**values)
            .returning(jobs.c.id, jobs.c.owner, jobs.c.version, jobs.c.epoch, jobs.c.dataset_bytes)
        ).all()  # fmt: skip
        if status in ENDED:
            self._finished(changed)
        if event:
            told = {"status": status.value} if status is not None else {}
            for row in changed:
                self.note(row.id, row.version, event, told | {"epoch": row.epoch})
        return [row.id for row in changed]

    def _finished(self, ended: Sequence[Any]) -> None:
        many, size = Counter(row.owner for row in ended), Counter[str]()
        for row in ended:
            size[row.owner] += row.dataset_bytes or 0
        for owner in sorted(many):  # in one order: rows are locked in it
            now = {"unfinished": owners.c.unfinished - many[owner], "bytes": owners.c.bytes + size[owner]}
            self.connection.execute(update(owners).where(owners.c.name == owner).values(**now))

    def note(self, job_id: str, version: int, kind: str, data: Mapping[str, Any]) -> None:
        """Write an event of a job, told by its version."""
        self.connection.execute(insert(events), {"job_id": job_id, "seq": version, "time": self.now,
                                                 "kind": kind, "data": json.dumps(data)})


class Database:
    """One database at a URL (SQLAlchemy's spelling), with its tables at the newest version."""

    def __init__(self, url: str, clock: Callable[[], float] = time.time) -> None:
        """Open it, making or upgrading its tables. Raises WrongSchema if a newer hockle has written it."""
        self.engine = _engine(url)
        self._reading = _engine(url, reading=True)
        self._clock = clock
        with self.engine.begin() as connection:
            migrate(connection)

    def reading(self) -> AbstractContextManager[Connection]:
        """A connection for reads, each of which sees what is committed."""
        return self._reading.connect()

    @contextmanager
    def writing(self) -> Iterator[Transaction]:
        """A transaction, committed to the disk when the block ends."""
        with self.engine.begin() as connection:
            yield Transaction(connection, round(self._clock(), 6))  # as finely as times are shown

    def close(self) -> None:
        """Close every connection."""
        self.engine.dispose()
        self._reading.dispose()


def _engine(url: str, reading: bool = False) -> Engine:
    """Reads have connections of their own: to change the level of one costs as much as a read itself."""
    told: dict[str, Any] = {"isolation_level": "AUTOCOMMIT"} if reading else {}
    if not url.startswith("sqlite"):
        return create_engine(url, connect_args=FOUND_DEAD, pool_pre_ping=True, pool_timeout=BUSY, **told)
    engine = create_engine(url, connect_args={"timeout": BUSY if reading else 0.0}, pool_timeout=BUSY, **told)
    event.listen(engine, "connect", _set_up_sqlite)
    if not reading:
        event.listen(engine, "begin", _begin_sqlite)
    return engine


def _set_up_sqlite(connection: Any, _record: object) -> None:
    connection.isolation_level = None  # the driver shall begin nothing by itself
    _patiently(connection.execute, "PRAGMA journal_mode=WAL")
    connection.execute("PRAGMA synchronous=FULL")  # a 202 outlives a power cut


def _begin_sqlite(connection: Connection) -> None:
    """Writers wait where they begin, in turn: one that first reads cannot be refused in its middle."""
    driver: Any = connection.connection.dbapi_connection  # a refusal costs it a fiftieth
    try:
        with turn(f"{connection.engine.url.database}-turn"):
            _patiently(driver.execute, "BEGIN IMMEDIATE")
    except sqlite3.Error as error:
        raise OperationalError("BEGIN IMMEDIATE", None, error) from error


def _patiently(execute: Callable[[str], object], statement: str) -> None:
    """Execute what needs the database for itself as soon as it is free.

    SQLite's own waiting does not serve: it sleeps up to 0.1 s while another process writes again and again, and
    where the journal mode changes it does not wait at all.
    """
    deadline = time.monotonic() + BUSY
    while True:
        try:
            execute(statement)
        except sqlite3.OperationalError as error:
            if error.sqlite_errorcode & PRIMARY != sqlite3.SQLITE_BUSY or time.monotonic() > deadline:
                raise
            time.sleep(0.001)
        else:
            return
