"""The registry's schema, step by step: `versions` holds one file for each change."""

from __future__ import annotations

import logging
from pathlib import Path

from sqlalchemy import Connection, inspect, text

ONE_AT_A_TIME = 0x686F636B6C65
"""The name of the lock under which PostgreSQL lets one process migrate."""


logging.getLogger("alembic").setLevel(logging.WARNING)  # it tells of every opening


class WrongSchema(Exception):
    """The tables cannot be brought to the version of this hockle."""


def migrate(connection: Connection, version: str = "head") -> None:
    """Bring the tables to the newest version, or another one, within the transaction of `connection`.

    Raises WrongSchema if they are of a version that this hockle does not know, or its own steps cannot be read.
    """
    if connection.dialect.name == "postgresql":
        connection.execute(text(f"SELECT pg_advisory_xact_lock({ONE_AT_A_TIME})"))
    if inspect(connection).has_table("schema_version"):
        raise WrongSchema("the registry was made by hockle 0.1.0, before there were migrations: "
                          "give this one another data directory")
    if version == "head" and _version_of(connection) == _newest():
        return
    from alembic import command  # a sixth of a second
    from alembic.config import Config
    from alembic.script.revision import RevisionError
    from alembic.util import CommandError

    config = Config()
    config.set_main_option("script_location", "service.jobs:migrations")
    config.attributes["connection"] = connection
    try:
        command.upgrade(config, version)
    except CommandError as error:
        rule = ("was written by a newer hockle than this one" if isinstance(error.__cause__, RevisionError)
                else "cannot be made: its migrations cannot be read")  # fmt: skip
        raise WrongSchema(f"the registry {rule}: {error}") from None


def _newest() -> str:
    """The newest version that there is a file for."""
    return max((path.stem[:4] for path in Path(__file__).with_name("versions").glob("[0-9]*.py")), default="")


def _version_of(connection: Connection) -> str | None:
    """Of the tables; None of an empty database."""
    if not inspect(connection).has_table("alembic_version"):
        return None
    version: str | None = connection.scalar(text("SELECT version_num FROM alembic_version"))
    return version
