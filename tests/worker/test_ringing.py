"""A long queue is worked off though nobody submits: who has run a job rings for those that still wait."""

from __future__ import annotations

import pytest

from service.jobs import NewJob, Status
from service.jobs.doorbell import Doorbell
from service.jobs.reconciler import AT_ONCE
from service.settings import Settings
from worker import app
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


def test_who_has_run_a_job_rings_for_as_many_as_still_wait_up_to_a_bound(registry, case, bell):
    for _ in range(AT_ONCE + 2):
        registry.submit(NewJob(case))
    for _ in range(3):
        app.run_next()
    assert bell.wanted == [AT_ONCE, AT_ONCE, AT_ONCE - 1]


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
    assert [registry.get(job.id).status for job in (first, second)] == [Status.SUCCESSFUL, Status.ACCEPTED]
