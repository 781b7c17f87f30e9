"""The connection of the commands that talk to a server."""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from hockle.failure import Failure

if TYPE_CHECKING:
    from hockle_client import Client, JobState

PATIENCE = 300.0
"""Seconds for which a command that follows a job waits for a server that has gone."""


def add_server(*parsers: argparse.ArgumentParser) -> None:
    """Let a command name its server."""
    for parser in parsers:
        parser.add_argument("--server", metavar="URL", help="default HOCKLE_SERVER, or http://127.0.0.1:8000")


@contextmanager
def connected(server: str | None) -> Iterator[Client]:
    """A client of a server. What it raises becomes a Failure, at once where no server answers."""
    from hockle_client import Client, HockleError, Unreachable

    try:
        with Client(server, patience=0.0) as client:
            yield client
    except Unreachable as error:
        raise Failure(f"{error}: start one with hockle serve, or name another with --server") from None
    except HockleError as error:
        raise Failure(str(error)) from None


def follow(client: Client, job_id: str) -> JobState:
    """Show a job to its end, over restarts of the server; gives how it ended."""
    from hockle.progress import show

    job = client.job(job_id)
    client.patience = PATIENCE
    show(current.state.model_dump() for current in job.watch())
    return job.state


def sentence(job: JobState) -> str:
    """How a job is doing."""
    text = f"{job.id}: {job.status}"
    if job.status == "running":
        text += f", {job.phase or 'starting'}, {job.progress:.0%} done, t = {job.t:.2f} s"
    if job.outcome not in ("", "completed"):
        text += f", {job.outcome}"
    if job.message:
        text += f": {job.message}"
    return text
