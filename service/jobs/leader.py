"""Which of several processes reconciles: the one that holds a lock. It dies with its holder."""

from __future__ import annotations

import fcntl
from io import TextIOWrapper
from pathlib import Path

from sqlalchemy import Connection, text

from service.jobs.database import Database

NAME = 0x686F636B
"""What PostgreSQL calls the lock."""


class Leader:
    """A claim to lead. What leaders do must be safe if two do it: a lost connection is noticed late.

    On PostgreSQL the lock is of the database, so there is one leader on all hosts; with SQLite it is
    the file `path`, on the one host there is.
    """

    def __init__(self, database: Database, path: Path) -> None:
        self._engine, self._path = database.engine, path
        self._connection: Connection | None = None
        self._file: TextIOWrapper | None = None

    def elected(self) -> bool:
        """Whether this process leads now. Raises what the database raises."""
        if self._engine.dialect.name == "postgresql":
            return self._by_database()
        return self._by_file()

    def resign(self) -> None:
        """Let another lead."""
        if self._connection is not None:
            self._connection.invalidate()
            self._connection.close()
        if self._file is not None:
            self._file.close()
        self._connection = self._file = None

    def _by_database(self) -> bool:
        if self._connection is None:
            self._connection = self._engine.connect().execution_options(isolation_level="AUTOCOMMIT")
        try:
            return bool(self._connection.scalar(text(f"SELECT pg_try_advisory_lock({NAME})")))
        except Exception:
            self.resign()
            raise

    def _by_file(self) -> bool:
        if self._file is None:
            file = self._path.open("w")
            try:
                fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                file.close()
                return False
            self._file = file
        return True
