"""A worker with no API process beside it, so that nobody but itself rings."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

import solver
from service.jobs import Database, Job, NewJob, Registry, Status
from service.jobs.doorbell import Doorbell
from service.settings import Settings


@pytest.fixture
def settings(broker, tmp_path: Path) -> Settings:
    made = Settings(tmp_path, broker=f"redis://127.0.0.1:{broker}/0")
    made.make_directories()
    return made


@pytest.fixture
def registry(settings) -> Iterator[Registry]:
    database = Database(settings.database_url)
    yield Registry(database)
    database.close()


@contextmanager
def worker(settings: Settings) -> Iterator[subprocess.Popen[bytes]]:
    """A worker as `hockle serve` starts it."""
    solver.warm()  # else it may compile for longer than a test waits
    command = [sys.executable, "-m", "hockle", "worker", "--workers", "1"]
    process = subprocess.Popen(command, env=os.environ | settings.environment())
    try:
        yield process
    finally:
        process.send_signal(signal.SIGQUIT)
        process.wait(60)


def statuses(registry: Registry, jobs: list[Job]) -> list[Status]:
    return [registry.get(job.id).status for job in jobs]


def test_one_message_is_enough_for_all_that_wait(registry, settings, quick, until):
    jobs = [registry.submit(NewJob(quick)) for _ in range(5)]
    assert Doorbell(settings).ring()
    with worker(settings):
        until(lambda: statuses(registry, jobs) == [Status.SUCCESSFUL] * 5, "all end")


def test_a_worker_that_is_told_to_stop_finishes_its_job_and_takes_no_other(registry, settings, slow, quick, until):
    jobs = [registry.submit(NewJob(case)) for case in (slow, quick, quick)]
    Doorbell(settings).leave(len(jobs))
    with worker(settings) as process:
        until(lambda: registry.get(jobs[0].id).status is Status.RUNNING, "the job runs")
        process.send_signal(signal.SIGTERM)
        assert process.wait(60) == 0
    assert statuses(registry, jobs) == [Status.SUCCESSFUL, Status.ACCEPTED, Status.ACCEPTED]
