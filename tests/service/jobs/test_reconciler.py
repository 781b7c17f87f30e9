"""The doorbell may fail and workers may die; the reconciler sees to it that every job ends."""

from __future__ import annotations

from pathlib import Path

import pytest
from sqlalchemy import insert, select, update

from service.jobs import Database, NewJob, Reached, Registry, Status, reconciler
from service.jobs.doorbell import Doorbell, celery_settings
from service.jobs.held import HeldJob, Wish, claim
from service.jobs.reconciler import (
    AT_ONCE,
    Reconciler,
    Watch,
    beats,
    dismiss_cancelled,
    recount,
    ring_for_all,
    take_back,
)
from service.jobs.tables import owners, processes
from service.settings import Settings

LEASE, ATTEMPTS = 10.0, 3


class Bell:
    def __init__(self) -> None:
        self.wanted: list[int] = []

    def leave(self, wanted: int) -> None:
        self.wanted.append(wanted)


@pytest.fixture
def settings(tmp_path: Path) -> Settings:
    made = Settings(data=tmp_path, lease=0.1)
    made.make_directories()
    return made


def held(registry: Registry, job_id: str | None = None) -> HeldJob:
    taken = claim(registry.database, job_id or registry.submit(NewJob({})).id, LEASE, "here")
    assert taken is not None
    return taken


def lose(database: Database) -> None:
    for beat in beats(database):
        take_back(database, beat, ATTEMPTS)


def test_a_lease_is_lost_when_it_was_seen_unchanged_for_its_whole_length(registry, clock):
    watch = Watch(LEASE, clock)
    job = held(registry)
    assert watch.lost(beats(registry.database)) == []
    clock.now += LEASE - 1
    job.renew(LEASE, Reached())
    assert watch.lost(beats(registry.database)) == []
    clock.now += LEASE - 1
    assert watch.lost(beats(registry.database)) == []
    clock.now += 2
    assert [beat.job_id for beat in watch.lost(beats(registry.database))] == [job.job.id]


def test_the_unfinished_jobs_of_an_owner_are_counted_again_where_their_number_is_wrong(registry):
    """As after a rolling upgrade, in which processes that do not keep the number end jobs."""
    held(registry)
    registry.submit(NewJob({}))
    with registry.database.writing() as transaction:
        transaction.connection.execute(update(owners).values(unfinished=7))
    recount(registry.database)
    with registry.database.reading() as connection:
        assert connection.scalars(select(owners.c.unfinished)).all() == [2]


def test_a_clock_that_jumps_takes_no_job_from_a_living_worker(registry, clock):
    """The watch has a clock of its own: what the rows say of time is only compared for being the same."""
    watch = Watch(LEASE, lambda: 0.0)
    job = held(registry)
    for jump in (1e9, -2e9):
        clock.now += jump
        assert watch.lost(beats(registry.database)) == []
        assert job.renew(LEASE, Reached()) is Wish.GO_ON


def test_a_lost_job_waits_again_and_its_worker_is_shut_out(registry):
    job = held(registry)
    lose(registry.database)
    waiting = registry.get(job.job.id)
    assert (waiting.status, waiting.epoch, waiting.worker) == (Status.ACCEPTED, 2, "")
    assert job.renew(LEASE, Reached()) is None
    assert held(registry, job.job.id).job.epoch == 3


def test_a_renewal_in_the_last_moment_is_stronger(registry, clock):
    job = held(registry)
    seen = beats(registry.database)
    clock.now += 1
    job.renew(LEASE, Reached())
    take_back(registry.database, seen[0], ATTEMPTS)
    assert registry.get(job.job.id).status is Status.RUNNING


def test_a_job_lost_three_times_without_a_checkpoint_fails_by_name(registry):
    job_id = registry.submit(NewJob({})).id
    for _ in range(ATTEMPTS):
        assert registry.get(job_id).status is Status.ACCEPTED
        last = held(registry, job_id)
        lose(registry.database)
    ended = registry.get(job_id)
    assert (ended.status, ended.outcome) == (Status.FAILED, "worker_lost")
    assert "3 times" in ended.message
    assert not last.finish(Status.SUCCESSFUL, "completed", "", None, Reached(1.0))


def test_a_job_that_gets_farther_each_time_is_never_given_up(registry):
    job_id = registry.submit(NewJob({})).id
    for attempt in range(1, 3 * ATTEMPTS):
        held(registry, job_id).checkpointed(Reached(steps=attempt))
        lose(registry.database)
    assert registry.get(job_id).status is Status.ACCEPTED


def test_a_cancelled_job_whose_worker_is_lost_is_dismissed(registry):
    job = held(registry)
    registry.cancel(job.job.id)
    lose(registry.database)
    assert registry.get(job.job.id).status is Status.DISMISSED


def test_a_cancelled_job_that_is_handed_back_is_dismissed(registry):
    job = held(registry)
    registry.cancel(job.job.id)
    job.release()
    dismiss_cancelled(registry.database)
    assert registry.get(job.job.id).status is Status.DISMISSED


@pytest.mark.parametrize(("workers", "left"), [(0, [1, 1]), (2, [2, 2]), (1000, [3, AT_ONCE])])
def test_messages_are_left_for_as_many_workers_as_there_are_and_jobs_wait_up_to_a_bound(registry, workers, left):
    rows = [{"id": f"{kind} {pid}", "kind": kind, "host": "here", "pid": pid, "beat": 1, "seen": 0.0, "stuck": ""}
            for kind, pid in [("api", 0), *(("worker", pid) for pid in range(workers))]]  # fmt: skip
    with registry.database.writing() as transaction:
        transaction.connection.execute(insert(processes), rows)
    bell = Bell()
    ring_for_all(registry.database, bell)
    assert bell.wanted == []
    for count in (3, AT_ONCE):
        for _ in range(count):
            registry.submit(NewJob({}))
        ring_for_all(registry.database, bell)
    assert bell.wanted == left


def test_what_the_lost_have_left_is_removed_though_no_job_comes_any_more(registry, settings, monkeypatch):
    """A worker removes it at any message: so one comes at the start, and again and again."""
    for every, wanted in ((1000.0, [1]), (0.0, [1, 1, 1])):
        monkeypatch.setattr(reconciler, "TIDY", every)
        bell = Bell()
        looks = Reconciler(registry.database, bell, settings)
        for _ in range(3):
            looks.once()
        assert bell.wanted == wanted
        looks.leader.resign()


def test_a_running_reconciler_takes_back_a_lost_job(registry, settings, until):
    job = held(registry)
    with Reconciler(registry.database, Bell(), settings).rounds():
        until(lambda: registry.get(job.job.id).status is Status.ACCEPTED)


def test_a_dead_broker_is_told_not_raised(tmp_path):
    nowhere = Doorbell(Settings(data=tmp_path, broker=f"redis+socket://{tmp_path}/nothing.sock"))
    assert not nowhere.ring()
    assert not nowhere.reachable()
    nowhere.leave(3)


def test_messages_are_left_until_there_are_enough(settings):
    doorbell = Doorbell(settings)
    assert doorbell.reachable()
    assert doorbell.ring()
    for wanted in (3, 2, 4):
        doorbell.leave(wanted)
        assert len(list(settings.messages.glob("*.msg"))) == max(3, wanted)


def test_the_broker_is_told_nothing_that_would_run_a_job_twice():
    told = celery_settings(Settings(broker="redis+socket:///x.sock"))
    assert told["task_acks_late"] is False
    assert told["broker_transport_options"]["visibility_timeout"] > 1e8
    assert told["accept_content"] == ["json"]
