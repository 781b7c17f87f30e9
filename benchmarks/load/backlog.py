"""A queue that keeps a worker busy and does not get shorter."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

from sqlalchemy import func, select

from benchmarks.load.clients import connect, submit_all
from benchmarks.load.scenes import case
from service.jobs import Database, Status
from service.jobs.tables import jobs
from service.settings import Settings

SUBMITTERS = 24
LOW = -1
"""The priority of the jobs in it: one less than that of a job whose submission names none."""
LOOK = 0.1  # s


@asynccontextmanager
async def backlog(host: str, port: int, settings: Settings, many: int) -> AsyncIterator[None]:
    """So many jobs of one step wait while the block runs: those that the worker takes are made up for."""
    database, over = Database(settings.database_url), asyncio.Event()

    async def fill() -> None:
        missing = many - waiting(database)
        connections = await connect(host, port, min(missing, SUBMITTERS))
        await submit_all(connections, [{"case": case(number), "priority": LOW} for number in range(missing)])
        for connection in connections:
            connection.close()

    async def keep_full() -> None:
        while not over.is_set():
            await asyncio.sleep(LOOK)
            await fill()

    await fill()
    async with asyncio.TaskGroup() as group:
        group.create_task(keep_full())
        try:
            yield
        finally:
            over.set()
    database.close()


def waiting(database: Database) -> int:
    """How many jobs no worker has yet."""
    with database.reading() as connection:
        return connection.scalar(select(func.count()).where(jobs.c.status == Status.ACCEPTED)) or 0
