"""One seed: jobs are submitted while faults are done, until enough of both; then all must come to its end."""

from __future__ import annotations

import random
import signal
import socket
import threading
import time
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import httpx
from sqlalchemy import func, select

from chaos.disk import small_disk
from chaos.faults import WEIGHTS, Fault, Target
from chaos.postgres import postgres
from chaos.served import PATIENCE, Served, send, wait_for
from chaos.watch import Watch
from service.cases import apply_settings, load_case
from service.jobs import Database, Limits, NewJob, Registry, Status
from service.jobs.tables import jobs
from service.settings import Settings

LEASE, CHECKPOINT = 3.0, 0.1
STEPS_BETWEEN = 1000.0
"""Steps that the workers take between two faults, on average: one job."""
IDLE = 10.0
"""Seconds after which the next fault comes even so."""
QUEUED = 6
"""So many jobs are kept open while faults are done."""
SMALL_MEMORY = Limits(memory=64_000_000)
GREEDY = apply_settings(load_case("hanging-cable"), {"numerics.intervals": 10_000})
"""A case that needs more at once."""


@dataclass
class Record:
    """What was done in one seed, and what is known of its jobs."""

    seed: int
    accepted: dict[str, str] = field(default_factory=dict)
    """Case names by job id, of the jobs that were answered 202 or written by hand."""
    starved: set[str] = field(default_factory=set)
    """The jobs of too little memory."""
    poisoned: set[str] = field(default_factory=set)
    """The jobs whose every process is killed."""
    faults: Counter[str] = field(default_factory=Counter)
    all_ended: bool = False


@contextmanager
def environment(kind: str, data: Path) -> Iterator[tuple[Settings, Any, bool]]:
    """Settings for a database of this kind, with a small disk where that can be had."""
    with ExitStack() as stack:
        small = stack.enter_context(small_disk(data))
        server = stack.enter_context(postgres()) if kind == "postgresql" else None
        url = server.create("hockle") if server else ""
        settings = Settings(data=data, database=url, lease=LEASE, checkpoint=CHECKPOINT)
        settings.make_directories()
        yield settings, server, small


def run_seed(seed: int, settings: Settings, server: Any, small: bool, cases: Mapping[str, Any],
             count: int, faults: int, only: Sequence[Fault] = ()) -> tuple[Record, Watch]:
    """Run one seed; the database and the datasets are left for the judge."""
    record, chance = Record(seed), random.Random(seed)  # no secret
    served = Served(settings, _free_port())
    served.clock.write_text("0")
    database = Database(settings.database_url)
    target = Target(served, database, chance, server, small)
    served.start()
    try:
        with Watch(settings, served) as watch:
            _make_trouble(target, record, cases, count, faults, only or tuple(WEIGHTS))
            for thread in target.later:
                thread.join()
            record.all_ended = _come_to_an_end(target)
        served.stop()
    finally:
        with suppress(Exception):
            served.stop()
        database.close()
    return record, watch


def _make_trouble(target: Target, record: Record, cases: Mapping[str, Any], count: int, faults: int,
                  only: Sequence[Fault]) -> None:
    stopped = threading.Event()
    submitter = threading.Thread(target=_submit, args=(target, record, cases, count, stopped))
    poisoner = threading.Thread(target=_poison, args=(target, record, stopped))
    submitter.start()
    poisoner.start()
    weights = [WEIGHTS[fault] for fault in only]
    try:
        while record.faults.total() < faults or len(record.accepted) < count:
            target.served.look_after()
            fault = target.random.choices(only, weights)[0]
            with suppress(Exception):  # the database may be away, a process may have just ended
                record.faults[fault.__name__] += fault(target)
            _let_run(target, target.random.expovariate(1 / STEPS_BETWEEN))
    finally:
        stopped.set()
        submitter.join()
        poisoner.join()


def _let_run(target: Target, steps: float) -> None:
    """Wait until the workers have taken so many steps, however fast the machine is, or take none for a while."""
    began, deadline = None, time.monotonic() + IDLE
    while time.monotonic() < deadline:
        time.sleep(0.05)
        with suppress(Exception):
            taken = _steps_taken(target.database)
            if began is None:
                began = taken
            if taken - began >= steps:
                return


def _steps_taken(database: Database) -> int:
    with database.reading() as connection:
        return int(connection.scalar(select(func.sum(jobs.c.steps + jobs.c.steps_redone))) or 0)


def _submit(target: Target, record: Record, cases: Mapping[str, Any], count: int, stopped: threading.Event) -> None:
    """Keep some jobs open, until there were enough and the faults are done."""
    chance = random.Random(record.seed + 1)
    names = sorted(cases)
    while not stopped.wait(0.05):
        with suppress(Exception):
            if _open_jobs(target.database) >= min(QUEUED, count):
                continue
            name, number = chance.choice(names), len(record.accepted)
            if number % 25 in (7, 19):
                _submit_by_hand(target, record, name, cases[name], number, poisoned=number % 25 == 19)
                continue
            job_id = _accepted(target, f"{record.seed}-{number}", cases[name])
            record.accepted[job_id] = name


def _accepted(target: Target, label: str, case: dict[str, Any]) -> str:
    """Hand in a case until there is an answer: the key makes one job of it, whatever became of answers before."""
    body = {"case": case, "label": label, "reuse": False}
    deadline = time.monotonic() + PATIENCE
    while time.monotonic() < deadline:
        with suppress(httpx.TransportError):
            answer = httpx.post(f"{target.served.address}/v1/jobs", json=body, timeout=20.0, trust_env=False,
                                headers={"Idempotency-Key": label})  # fmt: skip
            if answer.status_code in (200, 202):
                return str(answer.json()["id"])
        time.sleep(0.1)
    raise TimeoutError("the API accepts nothing")


def _submit_by_hand(target: Target, record: Record, name: str, case: dict[str, Any], number: int,
                    poisoned: bool) -> None:
    """A job whose every process is killed, or one that has too little memory: limits are no part of the API yet."""
    told = (case, Limits()) if poisoned else (GREEDY, SMALL_MEMORY)
    new = NewJob(told[0], label=f"{record.seed}-{number}", limits=told[1])
    chosen = record.poisoned if poisoned else record.starved
    chosen.add(new.id)
    try:
        Registry(target.database).submit(new)
    except Exception:
        chosen.discard(new.id)
        raise
    record.accepted[new.id] = name


def _poison(target: Target, record: Record, stopped: threading.Event) -> None:
    """Kill whatever runs a poisoned job, at once."""
    while not stopped.wait(0.01):
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


def _come_to_an_end(target: Target) -> bool:
    """Whether all jobs end once nothing happens any more."""
    target.served.clock.write_text("0")

    def done() -> bool:
        target.served.look_after()
        with suppress(Exception):
            return _open_jobs(target.database) == 0
        return False

    return wait_for(done)


def _free_port() -> int:
    with socket.socket() as listening:
        listening.bind(("127.0.0.1", 0))
        return int(listening.getsockname()[1])
