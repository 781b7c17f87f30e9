"""The doorbell may fail; the reconciler rings until somebody opens."""

from __future__ import annotations

from pathlib import Path

import pytest

from service.jobs import NewJob, Registry, Status
from service.jobs.doorbell import Doorbell, celery_settings
from service.jobs.reconciler import Reconciler, reconcile
from service.settings import Settings


class Bell:
    def __init__(self, works: bool = True) -> None:
        self.works, self.rung = works, []

    def ring(self, job_id: str) -> bool:
        self.rung.append(job_id)
        return self.works


@pytest.fixture
def settings(tmp_path: Path) -> Settings:
    made = Settings(data=tmp_path, lease=0.1, ring_again=0.01)
    made.make_directories()
    return made


@pytest.fixture
def registry(settings: Settings) -> Registry:
    return Registry(settings.database_url)


def test_a_dead_broker_costs_no_job(settings, registry, tmp_path):
    nowhere = Doorbell(Settings(data=tmp_path, broker=f"redis+socket://{tmp_path}/nothing.sock"))
    job = registry.submit(NewJob({}))
    assert not nowhere.ring(job.id)
    assert not nowhere.reachable()
    assert registry.get(job.id).status is Status.ACCEPTED


def test_without_a_broker_process_messages_lie_as_files(settings, registry):
    doorbell = Doorbell(settings)
    assert doorbell.reachable()
    assert doorbell.ring(registry.submit(NewJob({})).id)
    assert len(list(settings.messages.glob("*.msg"))) == 1


def test_a_waiting_job_is_rung_for_until_it_is_claimed(settings, registry, until):
    bell = Bell()
    job = registry.submit(NewJob({}))
    with Reconciler(registry, bell, settings):
        until(lambda: len(bell.rung) >= 2)
    assert set(bell.rung) == {job.id}


def test_a_broken_bell_is_not_rung_for_every_job(settings, registry):
    bell = Bell(works=False)
    clock = 1e12  # long after every submission
    for _ in range(5):
        registry.submit(NewJob({}))
    registry._clock = lambda: clock
    reconcile(registry, bell, settings)
    assert len(bell.rung) == 1


def test_the_broker_is_told_nothing_that_would_run_a_job_twice(settings):
    told = celery_settings(Settings(broker="redis+socket:///x.sock"))
    assert told["task_acks_late"] is False
    assert told["broker_transport_options"]["visibility_timeout"] > 1e8
    assert told["accept_content"] == ["json"]
