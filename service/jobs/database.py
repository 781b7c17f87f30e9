"""The registry's table and how its database is opened."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from sqlalchemy import (
    Boolean,
    Column,
    Engine,
    Float,
    Index,
    Integer,
    MetaData,
    String,
    Table,
    Text,
    create_engine,
    event,
    insert,
    select,
)

from service.jobs.job import Dataset, Job
from service.jobs.lifecycle import Status

SCHEMA_VERSION = 1
metadata = MetaData()

schema_version = Table("schema_version", metadata, Column("version", Integer, primary_key=True))

jobs = Table(
    "jobs",
    metadata,
    Column("id", String(26), primary_key=True),
    Column("status", String(10), nullable=False),
    Column("title", Text, nullable=False),
    Column("case_json", Text, nullable=False),
    Column("case_sha256", String(64), nullable=False),
    Column("progress", Float, nullable=False, default=0.0),
    Column("t", Float, nullable=False, default=0.0),
    Column("outcome", String(64), nullable=False, default=""),
    Column("message", Text, nullable=False, default=""),
    Column("cancel_requested", Boolean, nullable=False, default=False),
    Column("created", Float, nullable=False),
    Column("rung", Float, nullable=False),
    Column("started", Float),
    Column("finished", Float),
    Column("attempts", Integer, nullable=False, default=0),
    Column("epoch", Integer, nullable=False, default=0),
    Column("lease_until", Float),
    Column("version", Integer, nullable=False, default=1),
    Column("worker", Text, nullable=False, default=""),
    Column("dataset_file", Text),
    Column("dataset_sha256", String(64)),
    Column("dataset_bytes", Integer),
    Index("jobs_by_status", "status", "id"),
)

JOB_COLUMNS = [column for column in jobs.columns if column.name not in ("case_json", "rung")]


class WrongSchema(Exception):
    """The database was written by another version of hockle."""


def open_database(url: str) -> Engine:
    """Open the database, making the tables if it is new.

    Raises WrongSchema if it holds tables of another version.
    """
    engine = create_engine(url, connect_args={"timeout": 10.0} if url.startswith("sqlite") else {})
    if engine.dialect.name == "sqlite":
        event.listen(engine, "connect", _set_up_sqlite)
    metadata.create_all(engine)
    with engine.begin() as connection:
        found = connection.scalar(select(schema_version.c.version))
        if found is None:
            connection.execute(insert(schema_version).prefix_with("OR IGNORE", dialect="sqlite"),
                               {"version": SCHEMA_VERSION})
        elif found != SCHEMA_VERSION:
            raise WrongSchema(f"the registry has schema version {found}, this hockle needs {SCHEMA_VERSION}")
    return engine


def _set_up_sqlite(connection: Any, _record: object) -> None:
    for pragma in ("journal_mode=WAL", "synchronous=FULL"):  # a 202 outlives a power cut
        connection.execute(f"PRAGMA {pragma}")


def job_of(row: Mapping[Any, Any]) -> Job:
    """The job that a row of JOB_COLUMNS tells of."""
    fields = dict(row)
    file, sha256, size = (fields.pop(f"dataset_{name}") for name in ("file", "sha256", "bytes"))
    dataset = Dataset(file, sha256, size) if file is not None else None
    return Job(**fields | {"status": Status(fields["status"]), "dataset": dataset})
