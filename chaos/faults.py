"""The faults, each a function that tells whether it could be done now."""

from __future__ import annotations

import os
import random
import signal
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import redis
from sqlalchemy import select, text

from chaos.postgres import Postgres
from chaos.served import Served, send
from service.jobs import Database, Registry, Status
from service.jobs.doorbell import QUEUE
from service.jobs.tables import jobs

FULL = 1.0
"""Seconds for which a disk, or the broker, is full."""


@dataclass
class Target:
    """What the faults are done to, and what they use."""

    served: Served
    database: Database
    random: random.Random
    postgres: Postgres | None
    small_disk: bool
    later: list[threading.Thread] = field(default_factory=list)

    @property
    def lease(self) -> float:
        """Seconds."""
        return self.served.settings.lease

    def running(self) -> list[tuple[str, int]]:
        """The jobs that run, and the processes that run them."""
        query = select(jobs.c.id, jobs.c.worker).where(jobs.c.status == Status.RUNNING)
        with self.database.reading() as connection:
            found = [(row.id, int(row.worker.rsplit(":", 1)[1])) for row in connection.execute(query)]
        alive = set(self.served.children())
        return [(job_id, pid) for job_id, pid in found if pid in alive]

    def pick(self) -> tuple[str, int] | None:
        """One of those."""
        found = self.running()
        return self.random.choice(found) if found else None

    def in_a_while(self, seconds: float, what: Callable[[], object]) -> None:
        """Do something later, while other faults are done."""
        timer = threading.Timer(seconds, what)
        timer.start()
        self.later.append(timer)


Fault = Callable[[Target], bool]


def kill_child(target: Target) -> bool:
    """kill -9 of a process that runs a job."""
    picked = target.pick()
    return picked is not None and send(picked[1], signal.SIGKILL)


def kill_worker(target: Target) -> bool:
    """kill -9 of the Celery worker, with its children."""
    return send(target.served.worker(), signal.SIGKILL)


def kill_api(target: Target) -> bool:
    """kill -9 of the API while jobs are submitted: before, in and after commits."""
    return send(target.served.api(), signal.SIGKILL)


def kill_supervisor(target: Target) -> bool:
    """kill -9 of `hockle serve`, with all it started; then it is started again."""
    target.served.end(signal.SIGKILL)
    target.served.start()
    return True


def stop_gracefully(target: Target) -> bool:
    """Ctrl-C in the middle of runs; then it is started again."""
    target.served.stop()
    target.served.start()
    return True


def stop_child_past_its_lease(target: Target) -> bool:
    """SIGSTOP of a process that runs a job until long after its lease, then SIGCONT."""
    picked = target.pick()
    if picked is None or not send(picked[1], signal.SIGSTOP):
        return False
    target.in_a_while(target.lease * target.random.uniform(1.2, 2.0), lambda: send(picked[1], signal.SIGCONT))
    return True


def stop_child_for_a_moment(target: Target) -> bool:
    """SIGSTOP and SIGCONT within the lease."""
    picked = target.pick()
    if picked is None or not send(picked[1], signal.SIGSTOP):
        return False
    target.in_a_while(0.3 * target.lease, lambda: send(picked[1], signal.SIGCONT))
    return True


def kill_broker(target: Target) -> bool:
    """kill -9 of Redis."""
    return send(target.served.broker(), signal.SIGKILL)


def stall_broker(target: Target) -> bool:
    """Redis answers nothing for a while."""
    pid = target.served.broker()
    if not send(pid, signal.SIGSTOP):
        return False
    target.in_a_while(target.random.uniform(0.5, 3.0), lambda: send(pid, signal.SIGCONT))
    return True


def _with_broker(target: Target, what: Callable[[redis.Redis], object]) -> bool:
    client = target.served.redis()
    if client is None:
        return False
    with suppress(redis.RedisError, OSError):
        what(client)
        return True
    return False


def wipe_broker(target: Target) -> bool:
    """All messages are gone."""
    return _with_broker(target, lambda client: client.flushall())


def fill_broker(target: Target) -> bool:
    """Redis takes no more, for a while."""

    def empty() -> None:
        _with_broker(target, lambda client: client.config_set("maxmemory", 0))

    if not _with_broker(target, lambda client: client.config_set("maxmemory", 1)):
        return False
    target.in_a_while(FULL, empty)
    return True


def lose_message(target: Target) -> bool:
    """A message is taken, and nobody gets it."""
    lost: list[object] = []
    return _with_broker(target, lambda client: lost.append(client.rpop(QUEUE))) and lost != [None]


def double_messages(target: Target) -> bool:
    """Every message that lies there comes twice."""

    def double(client: redis.Redis) -> None:
        for message in client.lrange(QUEUE, 0, -1):
            client.lpush(QUEUE, message)

    return _with_broker(target, double)


def delay_message(target: Target) -> bool:
    """A message comes seconds late."""
    taken: list[Any] = []
    _with_broker(target, lambda client: taken.append(client.rpop(QUEUE)))
    if taken in ([], [None]):
        return False
    target.in_a_while(2.0, lambda: _with_broker(target, lambda client: client.lpush(QUEUE, *taken)))
    return True


def tear_checkpoint(target: Target) -> bool:
    """The newest checkpoint of a running job loses its end, and its process is killed."""
    picked = target.pick()
    if picked is None:
        return False
    found = sorted((target.served.settings.work / picked[0]).glob("checkpoint-*"))
    if not found or not send(picked[1], signal.SIGKILL):
        return False
    with suppress(OSError):
        os.truncate(found[-1], target.random.randrange(found[-1].stat().st_size))
        return True
    return False


def kill_at_rename(target: Target) -> bool:
    """kill -9 while a dataset is put together, or between its rename and the commit of its row."""
    after = target.random.choice([".nc", ".nc.part"])
    deadline = time.monotonic() + 3.0
    while time.monotonic() < deadline:
        for job_id, pid in target.running():
            if _has(target.served.settings, job_id, after):
                return send(pid, signal.SIGKILL)
        time.sleep(0.0005)
    return False


def _has(settings: object, job_id: str, ending: str) -> bool:
    directory: Path = settings.datasets if ending == ".nc" else settings.work / job_id  # type: ignore[attr-defined]
    return any(directory.glob(f"{job_id}.*{ending}"))


def jump_clock(target: Target) -> bool:
    """The clock of every process goes wrong by up to a day."""
    target.served.clock.write_text(str(target.random.uniform(-86400, 86400)))
    return True


def fill_disk(target: Target) -> bool:
    """Checkpoints, datasets, the database, logs and the broker's file have no room, for a while."""
    if not target.small_disk:
        return False
    ballast = target.served.settings.data / "ballast"
    with suppress(OSError), ballast.open("wb") as file:
        for block in (1 << 20, 1 << 12):
            with suppress(OSError):
                while True:
                    file.write(b"\0" * block)
                    file.flush()
    target.in_a_while(FULL, lambda: ballast.unlink(missing_ok=True))
    return True


def lock_database(target: Target) -> bool:
    """Nobody else may write for a while."""
    with suppress(Exception), target.database.writing() as transaction:
        if target.postgres is not None:
            transaction.connection.execute(text("LOCK TABLE jobs IN ACCESS EXCLUSIVE MODE"))
        time.sleep(0.4 * target.lease)
        return True
    return False


def restart_database(target: Target) -> bool:
    """PostgreSQL ends as in a power cut, and comes again."""
    if target.postgres is None:
        return False
    target.postgres.kill()
    time.sleep(target.random.uniform(0.0, 0.3 * target.lease))
    target.postgres.start()
    return True


def cancel_job(target: Target) -> bool:
    """A job is cancelled, whatever its state."""
    query = select(jobs.c.id).where(jobs.c.status.in_([Status.ACCEPTED, Status.RUNNING]))
    with target.database.reading() as connection:
        found = list(connection.scalars(query))
    if not found:
        return False
    Registry(target.database).cancel(target.random.choice(found))
    return True


WEIGHTS: dict[Fault, int] = {
    kill_child: 14, stop_child_past_its_lease: 5, stop_child_for_a_moment: 3, kill_worker: 2, kill_api: 2,
    kill_supervisor: 1, stop_gracefully: 1, kill_broker: 2, stall_broker: 2, wipe_broker: 3, fill_broker: 2,
    lose_message: 3, double_messages: 3, delay_message: 2, tear_checkpoint: 4, kill_at_rename: 5, jump_clock: 3,
    fill_disk: 2, lock_database: 2, restart_database: 2, cancel_job: 2,
}  # fmt: skip
"""How often each fault is done."""
