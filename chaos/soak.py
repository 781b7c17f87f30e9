"""`python -m chaos.soak`: an hour of mixed load with faults on one service; whether anything grows, leaks or is stuck.

Only processes that run jobs are killed here: the others must live through it all, for their memory to show something.
Ended early, by Ctrl-C or SIGTERM, it judges the time it had.
"""

from __future__ import annotations

import argparse
import itertools
import os
import random
import signal
import sys
import tempfile
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from pathlib import Path

import httpx

from chaos.campaign import CHECKPOINT, LEASE, come_to_an_end, free_port, keep_open
from chaos.cases import cases, undisturbed
from chaos.faults import Fault, Target
from chaos.faults.broker import delay_message, double_messages, lose_message, wipe_broker
from chaos.faults.database import cancel_at_end, cancel_job, lock_database
from chaos.faults.files import tear_checkpoint
from chaos.faults.processes import (
    kill_at_rename,
    kill_child,
    stop_child_for_a_moment,
    stop_child_past_its_lease,
)
from chaos.growth import Growth
from chaos.judge import Verdict, judge
from chaos.record import Record
from chaos.report import RESULTS
from chaos.served import Served, wait_for
from chaos.submitter import Submitter
from chaos.watch import Watch
from hockle.supervisor import ENVIRONMENT
from service.jobs import Database
from service.settings import Settings
from validation.provenance import provenance

FAULTS: tuple[Fault, ...] = (
    kill_child, stop_child_for_a_moment, stop_child_past_its_lease, wipe_broker, lose_message, double_messages,
    delay_message, tear_checkpoint, kill_at_rename, cancel_job, cancel_at_end, lock_database,
)  # fmt: skip
BETWEEN = 8.0
"""Seconds between two faults, on average."""
OPEN, PACE = 3, 8.0
"""So many jobs are open at the most, and so many seconds lie between two that are handed in: all of the last ten
minutes are kept, so that a machine that has less else to do for a while would keep more on its disk."""
LISTEN = 5.0
"""Seconds for which the events of a job are followed."""
KEEP, LOG = 50_000_000, 1_000_000
"""Bytes of datasets that are kept, but for those of the last ten minutes, and of each log."""
CROWD = 60
"""So many ask at once, after each sample: more than an API process has threads."""


def main() -> int:
    """Soak, print and keep what was seen; 1 if anything grew, leaked, was stuck or went wrong."""
    parser = argparse.ArgumentParser(prog="python -m chaos.soak", description=__doc__)
    parser.add_argument("--minutes", type=float, default=60.0)
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    code = provenance()
    os.environ |= ENVIRONMENT
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    with tempfile.TemporaryDirectory(prefix="hockle-soak-", ignore_cleanup_errors=True) as directory:
        settings = Settings(data=Path(directory) / "data", lease=LEASE, checkpoint=CHECKPOINT, keep_bytes=KEEP,
                            log_bytes=LOG)  # fmt: skip
        settings.make_directories()
        record, watch, served = Record(arguments.seed), Watch(settings), Served(settings, free_port())
        database, named_cases = Database(settings.database_url), cases()
        submitter = Submitter(served, record, named_cases)
        target = Target(served, database, random.Random(arguments.seed), None, False, submitter.submit)  # no secret
        served.start()
        began = time.monotonic()
        try:
            with watch.looking():
                growth = _soak(target, record, 60.0 * arguments.minutes)
                minutes = (time.monotonic() - began) / 60.0
                record.all_ended = come_to_an_end(target)
                wait_for(lambda: not _leftover(settings))
                leftover = _leftover(settings)
        finally:
            served.stop()
            database.close()
        verdict = judge(record, watch, settings, {name: undisturbed(case) for name, case in named_cases.items()})
    good = verdict.good and growth.flat and record.all_ended and not leftover
    made_with = [*code, f"seed {arguments.seed}, {minutes:.0f} min"]
    text = "\n".join(["# Soak", "", *(f"- {line}" for line in made_with), "",
                      _summary(record, verdict, growth, leftover), "", *growth.lines(), "",
                      "good" if good else "BAD", ""])  # fmt: skip
    print(text)
    RESULTS.mkdir(exist_ok=True)
    (RESULTS / "soak.md").write_text(text, encoding="utf-8")
    (RESULTS / "soak.json").write_text(growth.as_json(), encoding="utf-8")
    return 0 if good else 1


def _leftover(settings: Settings) -> list[str]:
    """Work directories and lock files of jobs."""
    locks = (path for path in settings.locks.glob("*.lock") if path.stem != "reconciler")
    return [path.name for path in (*settings.work.iterdir(), *locks)]


def _summary(record: Record, verdict: Verdict, growth: Growth, left: list[str]) -> str:
    faults, outcomes = (", ".join(f"{name} {count}" for name, count in counted.most_common())
                        for counted in (record.faults, verdict.outcomes))  # fmt: skip
    return (f"{verdict.jobs} jobs ({outcomes}), {verdict.deleted} deleted, {verdict.published} datasets, "
            f"{growth.requests} looks at a job, {verdict.faults} faults ({faults}). Lost {verdict.lost}, ended twice "
            f"{verdict.duplicated}, overlaps {verdict.overlaps}, differing {verdict.not_identical}, wrongly ended "
            f"{verdict.wrong_outcome}, stuck {'none' if record.all_ended else 'some'}, work directories and lock files "
            f"left {len(left)}, datasets {verdict.left_over}; {verdict.redone:.1%} of the steps redone.")  # fmt: skip


def _soak(target: Target, record: Record, seconds: float) -> Growth:
    """Load and faults for so long, with a sample a minute."""
    growth, stopped = Growth(target.served), threading.Event()
    threads = [threading.Thread(target=keep_open, args=(target, OPEN, stopped, PACE)),
               threading.Thread(target=_look, args=(target, record, growth, stopped)),
               threading.Thread(target=_listen, args=(target, stopped))]  # fmt: skip
    for thread in threads:
        thread.start()
    end, due = time.monotonic() + seconds, time.monotonic()
    try:
        while time.monotonic() < end:
            if time.monotonic() >= due:
                growth.sample()
                _crowd(target, record)
                due += min(60.0, seconds / 20)
            with suppress(Exception):  # a process may have just ended
                fault = target.random.choice(FAULTS)
                record.faults[fault.__name__] += fault(target)
            time.sleep(target.random.expovariate(1 / BETWEEN))
        growth.sample()
    except KeyboardInterrupt:
        print("ended early", flush=True)
    finally:
        stopped.set()
        for thread in (*threads, *target.later):
            thread.join()
    return growth


def _crowd(target: Target, record: Record) -> None:
    """Many ask at once, each on a connection of its own, so that the pools are as full as they ever get."""
    of_jobs = [f"/v1/jobs/{job_id}/data?variables=Tw,r&time_stride=20" for job_id in list(record.accepted)[-OPEN - 3 :]]
    paths = itertools.islice(itertools.cycle(["/v1/jobs", "/metrics", *of_jobs]), CROWD)

    def ask(path: str) -> None:
        with suppress(httpx.TransportError):
            httpx.get(target.served.address + path, timeout=20.0, trust_env=False)

    with ThreadPoolExecutor(CROWD) as pool:
        list(pool.map(ask, paths))


def _look(target: Target, record: Record, growth: Growth, stopped: threading.Event) -> None:
    """Ask for what dashboards and programs ask for, on connections that stay open and on new ones."""
    with httpx.Client(base_url=target.served.address, timeout=20.0, trust_env=False) as client:
        while not stopped.wait(0.1):
            with suppress(httpx.TransportError):
                client.get("/v1/jobs", params={"limit": 20})
                for job_id in list(record.accepted)[-5:]:
                    job = client.get(f"/v1/jobs/{job_id}").json()
                    if job.get("dataset"):
                        client.get(f"/v1/jobs/{job_id}/data", params={"variables": "Tw", "time_stride": 10})
                        httpx.get(f"{target.served.address}/v1/jobs/{job_id}/dataset", timeout=20.0, trust_env=False)
                    growth.requests += 1
                client.get("/metrics")


def _listen(target: Target, stopped: threading.Event) -> None:
    """Follow the events of one job after the other for a while, and go away in the middle."""
    while not stopped.wait(0.5):
        with suppress(httpx.HTTPError):
            for job_id, _ in target.running()[:1]:
                address = f"{target.served.address}/v1/jobs/{job_id}/events"
                with httpx.stream("GET", address, timeout=LISTEN, trust_env=False) as answer:
                    until = time.monotonic() + LISTEN
                    for _ in answer.iter_lines():
                        if time.monotonic() > until:
                            break


if __name__ == "__main__":
    sys.exit(main())
