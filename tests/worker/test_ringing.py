"""A long queue is worked off though nobody submits: who has run a job rings for those that still wait."""

from __future__ import annotations

import mmap
import os

import pytest

from service.jobs import NewJob, Registry, Status
from service.jobs.doorbell import Doorbell
from service.settings import Settings
from worker import app, stopping
from worker.lock import job_lock


class Bell:
    def __init__(self) -> None:
        self.wanted: list[int] = []

    def leave(self, wanted: int) -> None:
        self.wanted.append(wanted)


@pytest.fixture
def bell(registry, settings, monkeypatch) -> Bell:
    """What the worker of this registry rings."""
    bell = Bell()
    for name, its in {"settings": settings, "database": lambda: registry.database, "doorbell": lambda: bell}.items():
        monkeypatch.setattr(app, name, its)
    return bell


def statuses(registry: Registry) -> list[Status]:
    """Those of all jobs, the newest first."""
    return [job.status for job in registry.page(10).jobs]


def test_who_has_run_a_job_rings_while_others_wait_and_runs_the_next(registry, case, bell, monkeypatch):
    for _ in range(4):
        registry.submit(NewJob(case))
    monkeypatch.setattr(app, "RING_EVERY", 0.0)
    app.run_next()
    assert bell.wanted == [1, 1, 1]
    assert statuses(registry) == [Status.SUCCESSFUL] * 4


def test_between_short_jobs_it_rings_once_in_a_while(registry, case, bell, monkeypatch):
    for _ in range(4):
        registry.submit(NewJob(case))
    monkeypatch.setattr(app, "RING_EVERY", 1e9)
    app.run_next()
    assert bell.wanted == [1]


def test_who_is_told_to_stop_finishes_its_job_and_takes_no_other(registry, case, bell, monkeypatch):
    """Its parent is told, and tells by the memory that they share."""
    for _ in range(2):
        registry.submit(NewJob(case))
    monkeypatch.setattr(stopping, "_pool_ends", mmap.mmap(-1, 1))
    monkeypatch.setattr(bell, "leave", lambda _: fork_and_end_pool())
    app.run_next()
    assert statuses(registry) == [Status.ACCEPTED, Status.SUCCESSFUL]


def fork_and_end_pool() -> None:
    if os.fork() == 0:
        app.end_pool()
        os._exit(0)
    os.wait()


def test_who_has_run_the_last_job_does_not_ring(job, registry, bell):
    app.run_next()
    assert registry.get(job.id).status is Status.SUCCESSFUL
    assert bell.wanted == []


def test_who_could_take_none_does_not_ring_though_one_waits(job, settings, bell):
    """Or messages without end would go round while a stopped process keeps the job's lock."""
    with job_lock(settings.locks / f"{job.id}.lock"):
        app.run_next()
    assert bell.wanted == []


def test_a_broker_that_is_away_costs_no_job(registry, settings, case, bell, monkeypatch):
    nowhere = Doorbell(Settings(broker=f"redis+socket://{settings.data}/nothing.sock"))
    monkeypatch.setattr(app, "doorbell", lambda: nowhere)
    first, second = (registry.submit(NewJob(case)) for _ in range(2))
    app.run_next()
    assert [registry.get(job.id).status for job in (first, second)] == [Status.SUCCESSFUL, Status.SUCCESSFUL]
