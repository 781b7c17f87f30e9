"""Every process is killed, or stopped for longer than any lease, at random, while jobs run."""

from __future__ import annotations

import random
import tempfile
import threading
import time
from contextlib import suppress
from pathlib import Path

from chaos.attack.table import Row
from chaos.campaign import come_to_an_end, environment, free_port, keep_open, let_run
from chaos.cases import cases, undisturbed
from chaos.faults import Fault, Target
from chaos.faults.broker import kill_broker, stall_broker
from chaos.faults.files import fill_disk
from chaos.faults.processes import (
    jump_clock,
    kill_api,
    kill_child,
    kill_supervisor,
    kill_worker,
    stop_api_past_its_lease,
    stop_child_past_its_lease,
    stop_worker_past_its_lease,
)
from chaos.judge import judge
from chaos.record import Record
from chaos.served import Served
from chaos.submitter import Submitter
from chaos.watch import Watch
from service.jobs import Database

FAULTS: tuple[Fault, ...] = (
    kill_child, kill_worker, kill_api, kill_broker, kill_supervisor, stop_child_past_its_lease,
    stop_worker_past_its_lease, stop_api_past_its_lease, stall_broker, jump_clock, fill_disk,
)  # fmt: skip
QUEUED = 4
STEPS_BETWEEN = 12_000.0
"""Steps that the workers take between two faults, on average: three jobs, since a stop for longer than a lease takes as
long as many."""
ROOM = "3g"
"""Disk: each job leaves 4.5 MB, and 500 are wanted."""
LEASES = 3
CASES = ("short-loop", "free-flight")


def disturbed(seed: int, count: int, minutes: float) -> list[Row]:
    """Disturb the service until so many jobs were accepted or so many minutes are over; then all must end, and soon."""
    named_cases = {name: case for name, case in cases().items() if name in CASES}
    expected = {name: undisturbed(case) for name, case in named_cases.items()}
    with (
        tempfile.TemporaryDirectory(prefix="hockle-attack-", ignore_cleanup_errors=True) as directory,
        environment("sqlite", Path(directory) / "data", ROOM) as (settings, server, small),
    ):
        record, watch, served = Record(seed), Watch(settings), Served(settings, free_port())
        served.clock.write_text("0")
        database = Database(settings.database_url)
        submitter = Submitter(served, record, named_cases)
        target = Target(served, database, random.Random(seed), server, small, submitter.submit)  # no secret
        served.start()
        try:
            with watch.looking():
                _disturb(target, record, count, time.monotonic() + 60.0 * minutes)
                began = time.monotonic()
                record.all_ended = come_to_an_end(target)
                took = time.monotonic() - began
        finally:
            with suppress(Exception):
                served.stop()
            database.close()
        verdict = judge(record, watch, settings, expected)
    faults = ", ".join(f"{name} {many}" for name, many in sorted(record.faults.items()) if many)
    bound = LEASES * settings.lease + QUEUED * QUIET
    return [
        Row(f"seed {seed}: {faults}", f"{verdict.jobs} jobs, {verdict.lost} lost, {verdict.duplicated} ended twice, "
            f"{verdict.overlaps} run twice at once, {verdict.not_identical} with other bits, "
            f"{verdict.redone:.1%} redone",
            "none lost, none twice, all to the bit", not any(verdict.bad)),
        Row("the last of them, after the last fault", f"ended within {took:.1f} s",
            f"<= {LEASES} leases of {settings.lease:.0f} s, and the time that {QUEUED} jobs run", record.all_ended
            and took <= bound),
    ]  # fmt: skip


QUIET = 10.0
"""Seconds that a job may take by itself beside others, and processes to start."""


def _disturb(target: Target, record: Record, count: int, end: float) -> None:
    stopped = threading.Event()
    open_ = threading.Thread(target=keep_open, args=(target, QUEUED, stopped))
    open_.start()
    waiting: list[Fault] = []
    try:
        while len(record.accepted) < count and time.monotonic() < end:
            target.served.look_after()
            if not waiting:  # each once in a round, in another order each time
                waiting = target.random.sample(FAULTS, len(FAULTS))
            fault = waiting.pop()
            with suppress(Exception):  # the database may be away, a process may have just ended
                record.faults[fault.__name__] += fault(target)
            let_run(target, target.random.expovariate(1 / STEPS_BETWEEN))
    finally:
        stopped.set()
        open_.join()
        for thread in target.later:
            thread.join()
