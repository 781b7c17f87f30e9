"""The processes that make up the service, on all hosts: each shows by its row that it gets on, and can write."""

from __future__ import annotations

import os
import platform
from collections.abc import Callable, Collection
from contextlib import suppress
from dataclasses import dataclass
from typing import Literal

from sqlalchemy import delete, func, insert, select, update

from service.jobs.database import Database
from service.jobs.leader import Leader
from service.jobs.tables import processes
from service.pulse import Listener

Kind = Literal["api", "worker"]

EVERY = 2.0
"""Seconds between two beats of a process."""
SILENT = 10.0
"""Seconds without a beat after which a process stands still, or is lost."""
FORGOTTEN = 600.0
"""Seconds after which a process that is silent is forgotten."""


@dataclass(frozen=True)
class Process:
    """One row. `beat` grows while the process gets on; `stuck` names parts of it that do not. Time in Unix seconds."""

    id: str
    kind: Kind
    host: str
    pid: int
    beat: int
    seen: float
    stuck: str


class Presence:
    """This process among them."""

    def __init__(self, database: Database, kind: Kind) -> None:
        self._database, self._kind = database, kind
        self._host, self._pid = platform.node(), os.getpid()
        self._id = f"{kind} {self._host}:{self._pid}"

    def beat(self, stuck: Collection[str] = ()) -> None:
        """Show that this process gets on, but for what is `stuck`; the first time take along the rows of those of
        this host that ended without a word. Raises what the database raises."""
        with self._database.writing() as transaction:
            values = {"stuck": ",".join(stuck), "seen": transaction.now}
            statement = update(processes).where(processes.c.id == self._id).values(beat=processes.c.beat + 1, **values)
            if transaction.connection.execute(statement).rowcount:
                return
            new = {"id": self._id, "kind": self._kind, "host": self._host, "pid": self._pid, "beat": 1}
            transaction.connection.execute(insert(processes), new | values)
        self._bury()

    def leave(self) -> None:
        """Be gone."""
        forget(self._database, [self._id])

    def _bury(self) -> None:
        here = (processes.c.host == self._host, processes.c.kind == self._kind)  # others may count pids by themselves
        with self._database.reading() as connection:
            rows = connection.execute(select(processes.c.id, processes.c.pid).where(*here)).all()
        if dead := [row.id for row in rows if not _runs(row.pid)]:
            forget(self._database, dead)


class Roll:
    """Calls the roll of all processes: which get on, as this one hears it by a clock that nobody can set."""

    def __init__(self, listener: Callable[[], Listener] = Listener) -> None:
        self._listener = listener
        self._listeners: dict[str, Listener] = {}
        self.ages: dict[str, float] = {}
        """Seconds in which nothing was heard of each."""
        self.silent: list[str] = []
        """Those that stand still, or are lost."""
        self.workers = 0
        """How many can run a job."""

    def call(self, database: Database) -> None:
        """Look at the rows."""
        with database.reading() as connection:
            rows = [Process(**row) for row in connection.execute(select(processes)).mappings()]
        self._listeners = {process.id: self._listeners.get(process.id) or self._listener() for process in rows}
        self.ages = {process.id: self._listeners[process.id].silent(process.beat) for process in rows}
        quiet = {name for name, age in self.ages.items() if age > SILENT}
        able = (process.id not in quiet and not process.stuck for process in rows if process.kind == "worker")
        self.workers = sum(able)
        parts = [f"{process.id} {part}" for process in rows if process.stuck for part in process.stuck.split(",")]
        self.silent = sorted(quiet) + parts


def hosts(database: Database) -> dict[str, int]:
    """The hosts with workers, and how many each has."""
    many = select(processes.c.host, func.count()).where(processes.c.kind == "worker").group_by(processes.c.host)
    with database.reading() as connection:
        return dict(map(tuple, connection.execute(many)))


def forget(database: Database | Leader, ids: Collection[str]) -> None:
    """Remove the rows of processes that are gone."""
    with database.writing() as transaction:
        transaction.connection.execute(delete(processes).where(processes.c.id.in_(ids)))


def forget_lost(database: Database | Leader) -> None:
    """Remove the rows of processes that were not heard of for long."""
    with database.writing() as transaction:
        lost = processes.c.seen < transaction.now - FORGOTTEN
        transaction.connection.execute(delete(processes).where(lost))


def _runs(pid: int) -> bool:
    with suppress(ProcessLookupError):
        os.kill(pid, 0)
        return True
    return False
