"""How the registry's database is opened, read and written."""

from __future__ import annotations

import json
import time
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass
from typing import Any

from sqlalchemy import ColumnElement, Connection, Engine, create_engine, insert, make_url, update

from service.jobs.lifecycle import ENDED, Status, allowed_before
from service.jobs.migrations import migrate
from service.jobs.sqlite import BUSY, Files, isolation, sqlite_engine
from service.jobs.tables import events, jobs, owners

FOUND_DEAD = {
    "connect_timeout": 5, "keepalives_idle": 10, "keepalives_interval": 5, "keepalives_count": 3,
    "tcp_user_timeout": 15_000,  # ms
    "options": "-c tcp_keepalives_idle=10 -c tcp_keepalives_interval=5 -c tcp_keepalives_count=3",
}  # fmt: skip
"""Of connections to PostgreSQL: each side finds within some 25 s that the other's host is gone, not within hours. Else
nobody would reconcile, since the lock of a dead leader lies in its session, and no request would be answered."""

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
            data = {"status": status.value} if status is not None else {}
            for row in changed:
                self.note(row.id, row.version, event, data | {"epoch": row.epoch})
        return [row.id for row in changed]

    def _finished(self, ended: Sequence[Any]) -> None:
        many, size = Counter(row.owner for row in ended), Counter[str]()
        for row in ended:
            size[row.owner] += row.dataset_bytes or 0
        for owner in sorted(many):  # in one order: rows are locked in it
            now = {"unfinished": owners.c.unfinished - many[owner], "bytes": owners.c.bytes + size[owner]}
            self.connection.execute(update(owners).where(owners.c.name == owner).values(**now))
        followers = jobs.c.begins_with.in_([row.id for row in ended]), jobs.c.waits
        self.connection.execute(update(jobs).where(*followers).values(waits=False))

    def note(self, job_id: str, version: int, kind: str, data: Mapping[str, Any]) -> None:
        """Write an event of a job, told by its version."""
        self.connection.execute(insert(events), {"job_id": job_id, "seq": version, "time": self.now,
                                                 "kind": kind, "data": json.dumps(data)})


class Database:
    """One database at a URL (SQLAlchemy's spelling), with its tables at the newest version."""

    def __init__(self, url: str, clock: Callable[[], float] = time.time) -> None:
        """Open it, making or upgrading its tables. Raises WrongSchema if a newer hockle has written it."""
        self._files: Files | None = None
        if url.startswith("sqlite"):
            self._files = files = Files(make_url(url).database or "")
            self.engine, self._reading = (sqlite_engine(url, files, reading) for reading in (False, True))
        else:
            self.engine, self._reading = (_postgresql(url, reading) for reading in (False, True))
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
        self.check()  # what was written into a file that is gone will not be there

    def check(self) -> None:
        """Raise FilesReplaced unless the files that this process has open are still those that lie there."""
        if self._files is not None:
            self._files.check()

    def close(self) -> None:
        """Close every connection."""
        self.engine.dispose()
        self._reading.dispose()


def _postgresql(url: str, reading: bool) -> Engine:
    # the connection that was used last knows the statements already
    return create_engine(url, connect_args=FOUND_DEAD, pool_pre_ping=True, pool_use_lifo=True, pool_timeout=BUSY,
                         **isolation(reading))
