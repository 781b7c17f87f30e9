"""The registry: what a job's row may become, and who may write it."""

from __future__ import annotations

import threading
from pathlib import Path

import pytest
from sqlalchemy import text

from service.jobs import ENDED, Dataset, Job, NewJob, Registry, Status, UnknownJob, new_id
from service.jobs.database import WrongSchema, open_database
from service.jobs.lifecycle import TRANSITIONS, allowed_before

LEASE, ATTEMPTS = 10.0, 3


class Clock:
    now = 1_000.0

    def __call__(self) -> float:
        return self.now


@pytest.fixture
def clock() -> Clock:
    return Clock()


@pytest.fixture
def registry(tmp_path: Path, clock: Clock) -> Registry:
    return Registry(f"sqlite:///{tmp_path}/registry.db", clock)


def submitted(registry: Registry) -> Job:
    return registry.submit(NewJob({"b": 1, "a": [1.5, None]}, "a case"))


def claimed(registry: Registry, job_id: str) -> Job:
    claim = registry.claim(job_id, LEASE, ATTEMPTS, "here")
    assert claim is not None
    return claim.job


def test_ended_states_are_those_that_lead_nowhere():
    assert {Status.SUCCESSFUL, Status.FAILED, Status.DISMISSED} == ENDED
    assert all(before not in ENDED for before, _ in TRANSITIONS)
    assert allowed_before(Status.SUCCESSFUL) == [Status.RUNNING]


def test_identifiers_sort_by_time_and_differ():
    ids = [new_id() for _ in range(1000)]
    assert len(set(ids)) == 1000
    assert all(len(i) == 26 and i.isalnum() and i.islower() for i in ids)
    assert [i[:9] for i in ids] == sorted(i[:9] for i in ids)


def test_a_submitted_job_waits_and_keeps_its_case(registry):
    job = submitted(registry)
    assert (job.status, job.progress, job.attempts, job.version) == (Status.ACCEPTED, 0.0, 0, 1)
    claim = registry.claim(job.id, LEASE, ATTEMPTS, "here")
    assert claim is not None
    assert claim.case == {"a": [1.5, None], "b": 1}


def test_equal_cases_share_a_hash_whatever_the_order_of_their_fields():
    assert NewJob({"a": 1, "b": 2}).case_sha256 == NewJob({"b": 2, "a": 1}).case_sha256
    assert NewJob({"a": 1}).case_sha256 != NewJob({"a": 2}).case_sha256


def test_an_unknown_id_is_told_so(registry):
    with pytest.raises(UnknownJob):
        registry.get("nobody")
    with pytest.raises(UnknownJob):
        registry.cancel("nobody")


def test_only_one_of_many_claims_wins(registry):
    job = submitted(registry)
    won: list[Job] = []

    def try_to_claim() -> None:
        if claim := registry.claim(job.id, LEASE, ATTEMPTS, "here"):
            won.append(claim.job)

    threads = [threading.Thread(target=try_to_claim) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert [j.epoch for j in won] == [1]


def test_a_lease_that_ran_out_gives_the_job_to_another_and_fences_the_first(registry, clock):
    first = claimed(registry, submitted(registry).id)
    assert registry.claim(first.id, LEASE, ATTEMPTS, "there") is None
    clock.now += LEASE + 1
    second = claimed(registry, first.id)
    assert (second.epoch, second.attempts) == (2, 2)
    assert registry.renew(first, LEASE, 0.5, 1.0) is None
    assert not registry.finish(first, Status.SUCCESSFUL, "completed", "", None, 1.0, 34.0)
    assert registry.finish(second, Status.SUCCESSFUL, "completed", "", Dataset("x.nc", "ab", 3), 1.0, 34.0)
    ended = registry.get(first.id)
    assert (ended.status, ended.progress, ended.dataset) == (Status.SUCCESSFUL, 1.0, Dataset("x.nc", "ab", 3))


def test_a_late_holder_keeps_its_job_while_nobody_else_has_it(registry, clock):
    job = claimed(registry, submitted(registry).id)
    clock.now += 5 * LEASE
    assert registry.renew(job, LEASE, 0.5, 1.0) is not None
    assert registry.claim(job.id, LEASE, ATTEMPTS, "there") is None


def test_progress_changes_the_version_and_a_bare_renewal_does_not(registry):
    job = claimed(registry, submitted(registry).id)
    moved = registry.renew(job, LEASE, 0.5, 1.0)
    again = registry.renew(job, LEASE, 0.5, 1.0)
    assert moved is not None and again is not None
    assert job.version < moved.version == again.version
    assert (moved.progress, moved.t) == (0.5, 1.0)


def test_a_waiting_job_is_dismissed_at_once(registry):
    job = registry.cancel(submitted(registry).id)
    assert (job.status, job.outcome) == (Status.DISMISSED, "cancelled")
    assert registry.claim(job.id, LEASE, ATTEMPTS, "here") is None


def test_a_running_job_is_told_of_its_cancelling_at_the_next_renewal(registry):
    job = claimed(registry, submitted(registry).id)
    assert registry.cancel(job.id).status is Status.RUNNING
    renewed = registry.renew(job, LEASE, 0.1, 0.1)
    assert renewed is not None and renewed.cancel_requested


def test_cancelling_an_ended_job_changes_nothing(registry):
    job = claimed(registry, submitted(registry).id)
    registry.finish(job, Status.SUCCESSFUL, "completed", "", None, 1.0, 34.0)
    before = registry.get(job.id)
    assert registry.cancel(job.id) == before


def test_a_released_job_waits_again_without_a_lost_attempt(registry):
    job = claimed(registry, submitted(registry).id)
    registry.release(job)
    waiting = registry.get(job.id)
    assert (waiting.status, waiting.attempts) == (Status.ACCEPTED, 0)
    assert registry.overdue(30.0, 10) == [job.id]
    assert claimed(registry, job.id).epoch == 2


def test_a_job_is_rung_for_again_only_after_a_while(registry, clock):
    waiting, running = submitted(registry), submitted(registry)
    claimed(registry, running.id)
    assert registry.overdue(30.0, 10) == []
    clock.now += 31.0
    assert sorted(registry.overdue(30.0, 10)) == sorted([waiting.id, running.id])
    assert registry.overdue(30.0, 10) == []


def test_a_job_lost_three_times_fails_by_name(registry, clock):
    job = submitted(registry)
    for _ in range(ATTEMPTS):
        assert registry.end_lost(ATTEMPTS) == 0
        last = claimed(registry, job.id)
        clock.now += LEASE + 1
    assert registry.claim(job.id, LEASE, ATTEMPTS, "here") is None
    assert registry.end_lost(ATTEMPTS) == 1
    ended = registry.get(job.id)
    assert (ended.status, ended.outcome) == (Status.FAILED, "worker_lost")
    assert "3 times" in ended.message
    assert not registry.finish(last, Status.SUCCESSFUL, "completed", "", None, 1.0, 34.0)


def test_a_cancelled_job_whose_worker_is_lost_is_dismissed(registry, clock):
    job = claimed(registry, submitted(registry).id)
    registry.cancel(job.id)
    clock.now += LEASE + 1
    assert registry.end_lost(ATTEMPTS) == 1
    assert registry.get(job.id).status is Status.DISMISSED


def test_pages_go_from_the_newest_to_the_oldest_without_gap_or_repeat(registry):
    made = sorted((submitted(registry).id for _ in range(7)), reverse=True)
    registry.cancel(made[3])
    seen, after = [], None
    while True:
        page = registry.page(3, after)
        seen += [job.id for job in page.jobs]
        if page.next is None:
            break
        after = page.next
    assert seen == made
    assert [job.id for job in registry.page(3, status=Status.DISMISSED).jobs] == [made[3]]


def test_a_status_read_is_a_point_read_by_the_primary_key(registry):
    with registry._engine.connect() as connection:
        plan = connection.execute(text("EXPLAIN QUERY PLAN SELECT status FROM jobs WHERE id = 'x'")).all()
    assert "SEARCH jobs USING INDEX" in str(plan)


def test_a_registry_of_another_version_is_refused(tmp_path):
    url = f"sqlite:///{tmp_path}/registry.db"
    engine = open_database(url)
    with engine.begin() as connection:
        connection.execute(text("UPDATE schema_version SET version = 99"))
    with pytest.raises(WrongSchema, match=r"schema version 99.*needs 1"):
        open_database(url)
