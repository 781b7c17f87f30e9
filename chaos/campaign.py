"""One seed: jobs are submitted while faults are done, until enough of both; then all must come to its end."""

from __future__ import annotations

import random
import signal
import socket
import threading
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import Any

from sqlalchemy import func, select

from chaos.disk import SIZE, small_disk
from chaos.faults import WEIGHTS, Fault, Target
from chaos.postgres import postgres
from chaos.reader import reading
from chaos.record import Record
from chaos.served import Served, send, wait_for
from chaos.submitter import Submitter
from chaos.watch import Watch
from service.jobs import Database, Status
from service.jobs.tables import jobs
from service.settings import Settings

LEASE, CHECKPOINT = 3.0, 0.1
STEPS_BETWEEN = 4000.0
"""Steps that the workers take between two faults, on average: one job."""
IDLE = 10.0
"""Seconds after which the next fault comes even so."""
WITHIN = 1800.0
"""Seconds within which a seed has done its faults, or nobody takes jobs any more."""
QUEUED = 6
"""So many jobs are kept open while faults are done."""


@contextmanager
def environment(kind: str, data: Path, size: str = SIZE) -> Iterator[tuple[Settings, Any, bool]]:
    """Settings for a database of this kind, with a small disk where that can be had."""
    with ExitStack() as stack:
        small = stack.enter_context(small_disk(data, size))
        server = stack.enter_context(postgres(small_disk)) if kind == "postgresql" else None
        url = server.create("hockle") if server else ""
        settings = Settings(data=data, database=url, lease=LEASE, checkpoint=CHECKPOINT)
        settings.make_directories()
        yield settings, server, small


def run_seed(seed: int, settings: Settings, server: Any, small: bool, cases: Mapping[str, Any],
             count: int, faults: int, only: Sequence[Fault] = ()) -> tuple[Record, Watch]:
    """Run one seed; the database and the datasets are left for the judge."""
    record, watch = Record(seed), Watch(settings)
    served = Served(settings, free_port())
    served.clock.write_text("0")
    database = Database(settings.database_url)
    submitter = Submitter(served, record, cases)
    target = Target(served, database, random.Random(seed), server, small, submitter.submit)  # no secret
    served.start()
    try:
        with watch.looking(), reading(served.address, record.reads):
            _make_trouble(target, record, count, faults, only or tuple(WEIGHTS))
            for thread in target.later:
                thread.join()
            record.all_ended = come_to_an_end(target)
        served.stop()
    finally:
        with suppress(Exception):
            served.stop()
        database.close()
    return record, watch


def _make_trouble(target: Target, record: Record, count: int, faults: int, only: Sequence[Fault]) -> None:
    stopped = threading.Event()
    threads = [threading.Thread(target=keep_open, args=(target, min(QUEUED, count), stopped)),
               threading.Thread(target=_poison, args=(target, record, stopped))]
    for thread in threads:
        thread.start()
    weights, deadline = [WEIGHTS[fault] for fault in only], time.monotonic() + WITHIN
    try:
        while record.done < faults or len(record.accepted) < count:
            if time.monotonic() > deadline:
                raise TimeoutError(f"after {WITHIN:.0f} s: {record.done} faults, {len(record.accepted)} jobs accepted")
            target.served.look_after()
            fault = target.random.choices(only, weights)[0]
            with suppress(Exception):  # the database may be away, a process may have just ended
                record.faults[fault.__name__] += fault(target)
            let_run(target, target.random.expovariate(1 / STEPS_BETWEEN))
    finally:
        stopped.set()
        for thread in threads:
            thread.join()


def let_run(target: Target, steps: float) -> None:
    """Wait until the workers have taken so many steps, however fast the machine is, or take none for a while."""
    began, deadline = None, time.monotonic() + IDLE
    while time.monotonic() < deadline:
        time.sleep(0.05)
        with suppress(Exception):
            steps_taken = _steps_taken(target.database)
            if began is None:
                began = steps_taken
            if steps_taken - began >= steps:
                return


def _steps_taken(database: Database) -> int:
    with database.reading() as connection:
        return int(connection.scalar(select(func.sum(jobs.c.steps + jobs.c.steps_redone))) or 0)


def keep_open(target: Target, most: int, stopped: threading.Event, pace: float = 0.05) -> None:
    """Keep some jobs open, handing in one every `pace` seconds at the most."""
    while not stopped.wait(pace):
        with suppress(Exception):  # the database may be away
            if _open_jobs(target.database) < most:
                target.submit()


def _poison(target: Target, record: Record, stopped: threading.Event) -> None:
    """Kill whatever runs a poisoned job, at once."""
    while not stopped.wait(0.03):
        if record.poisoned:
            with suppress(Exception):
                for job_id, pid in target.running():
                    if job_id in record.poisoned and send(pid, signal.SIGKILL):
                        record.faults["poison"] += 1
                        time.sleep(0.2)


def _open_jobs(database: Database) -> int:
    some = jobs.c.status.in_([Status.ACCEPTED, Status.RUNNING])
    with database.reading() as connection:
        return connection.scalar(select(func.count()).select_from(jobs).where(some)) or 0


def come_to_an_end(target: Target) -> bool:
    """Whether all jobs end once nothing happens any more."""
    target.served.clock.write_text("0")

    def done() -> bool:
        target.served.look_after()
        with suppress(Exception):
            return _open_jobs(target.database) == 0
        return False

    return wait_for(done)


def free_port() -> int:
    """A port on loopback that nobody listens on."""
    with socket.socket() as listening:
        listening.bind(("127.0.0.1", 0))
        return int(listening.getsockname()[1])
