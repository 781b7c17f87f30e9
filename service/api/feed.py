"""Wakes those who wait for a job to change: one look at the registry a tick, however many wait."""

from __future__ import annotations

import asyncio
import logging
import time
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import dataclass, field

from service.jobs import Job, Registry

TICK = 0.1
AT_ONCE = 500
log = logging.getLogger(__name__)


@dataclass(eq=False)
class _Waiter:
    job_id: str
    version: int
    woken: asyncio.Future[None] = field(default_factory=lambda: asyncio.get_running_loop().create_future())


class Feed:
    """The versions of the jobs that somebody waits for."""

    def __init__(self, registry: Registry) -> None:
        self._registry = registry
        self._waiters: set[_Waiter] = set()
        self._moved = time.monotonic()

    @property
    def silent(self) -> float:
        """Seconds since the last look."""
        return time.monotonic() - self._moved

    @asynccontextmanager
    async def running(self) -> AsyncIterator[Feed]:
        """Look while the block runs."""
        task = asyncio.create_task(self._run())
        try:
            yield self
        finally:
            task.cancel()

    async def changed(self, job: Job, seconds: float) -> bool:
        """Wait until the job has a newer version; False if it had none after so many seconds."""
        waiter = _Waiter(job.id, job.version)
        self._waiters.add(waiter)
        try:
            await asyncio.wait_for(waiter.woken, seconds)
        except TimeoutError:
            return False
        finally:
            self._waiters.discard(waiter)
        return True

    async def _run(self) -> None:
        while True:
            await asyncio.sleep(TICK)
            self._moved = time.monotonic()
            try:
                self._look()
            except Exception:
                log.exception("the jobs that are waited for could not be read; they are read again")

    def _look(self) -> None:
        ids = list({waiter.job_id for waiter in self._waiters})
        for start in range(0, len(ids), AT_ONCE):
            versions = self._registry.versions(ids[start : start + AT_ONCE])
            for waiter in self._waiters:
                if versions.get(waiter.job_id, 0) > waiter.version and not waiter.woken.done():
                    waiter.woken.set_result(None)
