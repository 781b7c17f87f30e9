"""What faults are done to, and what they use."""

from __future__ import annotations

import random
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, field

from sqlalchemy import select

from chaos.postgres import Postgres
from chaos.served import Served
from service.jobs import Database, Status
from service.jobs.tables import jobs

SOON = 3.0
"""Seconds for which the right moment is waited for."""
PUT_TOGETHER, RENAMED = ".nc.part", ".nc"
"""How a dataset's file is called on its way."""


@dataclass
class Target:
    """What the faults are done to, and what they use."""

    served: Served
    database: Database
    random: random.Random
    postgres: Postgres | None
    small_disk: bool
    submit: Callable[[], object]
    """Hands in one more job."""
    later: list[threading.Thread] = field(default_factory=list)

    @property
    def lease(self) -> float:
        """Seconds."""
        return self.served.settings.lease

    def running(self) -> list[tuple[str, int]]:
        """The jobs that run, and the processes that run them."""
        query = select(jobs.c.id, jobs.c.worker).where(jobs.c.status == Status.RUNNING)
        with self.database.reading() as connection:
            claims = [(row.id, int(row.worker.rsplit(":", 1)[1])) for row in connection.execute(query)]
        alive = set(self.served.children())
        return [(job_id, pid) for job_id, pid in claims if pid in alive]

    def pick(self) -> tuple[str, int] | None:
        """One of those."""
        running = self.running()
        return self.random.choice(running) if running else None

    def in_a_while(self, seconds: float, action: Callable[[], object]) -> None:
        """Do something later, while other faults are done."""
        timer = threading.Timer(seconds, action)
        timer.start()
        self.later.append(timer)

    def ending(self, file: str) -> tuple[str, int] | None:
        """A job that runs and whose dataset is called so already, and its process; None if there is none soon."""
        settings, deadline = self.served.settings, time.monotonic() + SOON
        while time.monotonic() < deadline:
            for job_id, pid in self.running():
                directory = settings.datasets if file == RENAMED else settings.work / job_id
                if any(directory.glob(f"{job_id}.*{file}")):
                    return job_id, pid
            time.sleep(0.0005)
        return None


Fault = Callable[[Target], bool]
"""Does something bad, and tells whether it could be done now."""
