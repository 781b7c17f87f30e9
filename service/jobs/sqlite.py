"""How SQLite is opened: with a log (WAL), so that all read while one writes, and with a look at its files."""

from __future__ import annotations

import os
import sqlite3
import threading
import time
from collections.abc import Callable
from typing import Any

from sqlalchemy import Connection, Engine, create_engine, event
from sqlalchemy.exc import OperationalError

from service.jobs.turn import turn

BUSY = 20.0
"""Seconds for which a write waits for another one, or for a connection."""
PRIMARY = 0xFF
"""The part of SQLite's error codes that says what, not why: another process may also be recovering the log."""
FILES = ("", "-wal", "-shm")
"""What SQLite adds to the name: the database, its log and the index of that. While a process has a connection that has
read, each is one and the same file."""

Identity = tuple[int, int] | None


class FilesReplaced(OperationalError):
    """A file of the database was removed or replaced under this process: what it would write would be lost."""

    def __init__(self, path: str) -> None:
        super().__init__("", None, Exception(f"{path} was removed or replaced under the running service"))


class Files:
    """The files of a database that this process has open, for as long as it has a connection."""

    def __init__(self, path: str) -> None:
        self._paths = [path + ending for ending in FILES]
        self._opened: list[Identity] = []
        self._connections = 0
        self._lock = threading.Lock()

    def open(self) -> None:
        """There is one connection more."""
        with self._lock:
            self._connections += 1
            if self._connections == 1:
                self._opened = [_identity(path) for path in self._paths]

    def close(self) -> None:
        """There is one connection less; after the last one SQLite removes the log."""
        with self._lock:
            self._connections -= 1

    def check(self) -> None:
        """Raise FilesReplaced unless all are those that were opened."""
        with self._lock:
            if not self._connections:
                return
            for i, path in enumerate(self._paths):
                identity = _identity(path)
                if self._opened[i] is None:
                    self._opened[i] = identity  # SQLite makes it when it first needs it
                elif identity != self._opened[i]:
                    raise FilesReplaced(path)


def isolation(reading: bool) -> dict[str, Any]:
    """The level of an engine's transactions, on every database. Reads have connections of their own: to change the
    level of one costs as much as a read itself."""
    return {"isolation_level": "AUTOCOMMIT"} if reading else {}


def sqlite_engine(url: str, files: Files, reading: bool) -> Engine:
    """An engine whose connections raise FilesReplaced where they would write what is lost, or open another database
    than the first one of this process."""
    connect_args = {"timeout": BUSY if reading else 0.0}
    engine = create_engine(url, connect_args=connect_args, pool_timeout=BUSY, **isolation(reading))

    def set_up(connection: Any, _record: object) -> None:
        try:
            connection.isolation_level = None  # the driver shall begin nothing by itself
            _patiently(connection.execute, "PRAGMA journal_mode=WAL")
            connection.execute("PRAGMA synchronous=FULL")  # a 202 outlives a power cut
        except sqlite3.Error as error:
            raise OperationalError("PRAGMA", None, error) from error
        files.open()

    event.listen(engine, "do_connect", lambda *_: files.check())
    event.listen(engine, "connect", set_up)
    event.listen(engine.pool, "close", lambda *_: files.close())
    if not reading:
        event.listen(engine, "begin", lambda connection: _begin(connection, files))
    return engine


def _begin(connection: Connection, files: Files) -> None:
    """Writers wait where they begin, in turn: one that first reads cannot be refused in its middle."""
    driver: Any = connection.connection.dbapi_connection  # a refusal costs it a fiftieth
    try:
        with turn(f"{connection.engine.url.database}-turn"):
            _patiently(driver.execute, "BEGIN IMMEDIATE")
    except sqlite3.Error as error:
        raise OperationalError("BEGIN IMMEDIATE", None, error) from error
    files.check()


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


def _identity(path: str) -> Identity:
    try:
        stat = os.stat(path)  # noqa: PTH116  # three of them at each commit
    except OSError:
        return None
    return stat.st_dev, stat.st_ino
