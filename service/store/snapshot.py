"""The registry as it is at one moment, in a SQLite file of its own, and back."""

from __future__ import annotations

import os
import shutil
import sqlite3
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path

from sqlalchemy import Connection, Engine, func, insert, select, text

from service.jobs import Database, Dataset
from service.jobs.tables import audit, leader, metadata, processes
from service.results.durable import sync

AT_ONCE = 1000
SQLITE = "sqlite:///"
COPIED = [table for table in metadata.sorted_tables if table not in (leader, processes)]
"""What is copied row by row: not who runs at the moment."""


def save(database: Database, path: Path) -> None:
    """Write all rows, as they are at one moment, to a new file; the service may write meanwhile."""
    beside = path.with_name(f"{path.name}.part")
    beside.unlink(missing_ok=True)
    if database.engine.dialect.name == "sqlite":
        _save_sqlite(Path(str(database.engine.url.database)), beside)
    else:
        with _opened(beside) as copied:
            _copy_rows(database.engine, copied.engine)
    with closing(sqlite3.connect(beside)) as alone:
        alone.execute("PRAGMA journal_mode=DELETE")  # all in one file
    sync(beside)
    beside.replace(path)
    sync(path.parent)


def datasets_in(path: Path) -> dict[str, Dataset]:
    """The datasets that such a file names, by job."""
    query = "SELECT id, dataset_file, dataset_sha256, dataset_bytes FROM jobs WHERE dataset_file IS NOT NULL"
    with closing(sqlite3.connect(f"{path.absolute().as_uri()}?immutable=1", uri=True)) as saved:
        return {job_id: Dataset(*fields) for job_id, *fields in saved.execute(query)}


def check_empty(url: str) -> None:
    """Raises FileExistsError where a registry is kept already."""
    if url.startswith(SQLITE):
        if Path(url.removeprefix(SQLITE)).exists():
            raise FileExistsError(f"{url.removeprefix(SQLITE)} is a registry already")
        return
    database = Database(url)
    with database.reading() as connection:
        filled = [table.name for table in COPIED if connection.scalar(select(func.count()).select_from(table))]
    database.close()
    if filled:
        raise FileExistsError(f"the database has rows already, in {', '.join(filled)}")


def bring_back(path: Path, url: str) -> Database:
    """Make a registry at `url`, where none is kept, from such a file, which stays as it is."""
    if not url.startswith(SQLITE):
        return _into_empty(path, Database(url))
    target = Path(url.removeprefix(SQLITE))
    beside = target.with_name(f"{target.name}.part")
    shutil.copyfile(path, beside)
    sync(beside)
    os.rename(beside, target)  # noqa: PTH104 (as replace, but its meaning is that nothing is replaced)
    return Database(url)


def _save_sqlite(source: Path, target: Path) -> None:
    """By SQLite's own means: a copy of the file would lack what lies in its log."""
    with closing(sqlite3.connect(source)) as live, closing(sqlite3.connect(target)) as copied:
        live.backup(copied)


def _into_empty(path: Path, database: Database) -> Database:
    upgraded = path.with_name(f"{path.name}.upgraded")
    shutil.copyfile(path, upgraded)
    try:
        with _opened(upgraded) as saved:
            _copy_rows(saved.engine, database.engine)
    finally:
        upgraded.unlink()
    return database


@contextmanager
def _opened(path: Path) -> Iterator[Database]:
    """A registry in a SQLite file, with the tables of this version."""
    opened = Database(f"sqlite:///{path}")
    try:
        yield opened
    finally:
        opened.close()
        path.with_name(f"{path.name}-turn").unlink(missing_ok=True)


def _copy_rows(source: Engine, target: Engine) -> None:
    with source.connect() as reading, target.begin() as writing:
        if source.dialect.name == "postgresql":
            reading = reading.execution_options(isolation_level="REPEATABLE READ")
        for table in COPIED:
            for rows in reading.execute(select(table)).mappings().partitions(AT_ONCE):
                writing.execute(insert(table), [dict(row) for row in rows])
        if target.dialect.name == "postgresql":
            _go_on_counting(writing)


def _go_on_counting(connection: Connection) -> None:
    """New lines of the trail come after those that were copied."""
    last = connection.scalar(select(func.coalesce(func.max(audit.c.id), 0) + 1))
    connection.execute(text("SELECT setval(pg_get_serial_sequence('audit', 'id'), :last, false)"), {"last": last})
