"""The service whose data lie on this machine: for the commands that need no server."""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from hockle.failure import Failure

if TYPE_CHECKING:
    from service.jobs import Database
    from service.settings import Settings


def add_data(*parsers: argparse.ArgumentParser) -> None:
    """Let a command name the service."""
    for parser in parsers:
        parser.add_argument("--data", type=Path, help="directory of the service (default HOCKLE_DATA, or ./var)")


def settings_of(arguments: argparse.Namespace) -> Settings:
    """The settings, with the directories that they name. Raises Failure."""
    from service.settings import from_environment

    try:
        settings = from_environment()
    except ValueError as error:
        raise Failure(str(error)) from None
    if getattr(arguments, "data", None) is not None:
        settings = replace(settings, data=arguments.data)
    make_directories(settings)
    return settings


def make_directories(settings: Settings) -> None:
    """Make its directories. Raises Failure."""
    try:
        settings.make_directories()
    except OSError as error:
        raise Failure(f"the directory {error.filename} cannot be used: {error.strerror}") from None


@contextmanager
def registry_of(settings: Settings) -> Iterator[Database]:
    """The registry. Raises Failure."""
    from sqlalchemy.exc import SQLAlchemyError

    from service.jobs import Database
    from service.jobs.migrations import WrongSchema

    try:
        database = Database(settings.database_url)
    except (SQLAlchemyError, WrongSchema) as error:
        raise Failure(f"the registry cannot be opened: {str(error).splitlines()[0]}") from None
    try:
        yield database
    finally:
        database.close()
