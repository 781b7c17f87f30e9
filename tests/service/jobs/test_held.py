"""A claimed job: whose turn it was, and that only its holder writes it."""

from __future__ import annotations

import threading

import pytest

from service.jobs import Database, Dataset, NewJob, Reached, Registry, Status
from service.jobs.held import HeldJob, Wish, claim
from service.jobs.sharing import next_in_turn

LEASE = 10.0


def submitted(registry: Registry, owner: str = "local", priority: int = 0) -> str:
    return registry.submit(NewJob({"b": 1, "a": [1.5, None]}, owner=owner, priority=priority)).id


def held(registry: Registry, job_id: str | None = None) -> HeldJob:
    taken = claim(registry.database, job_id or submitted(registry), LEASE, "here")
    assert taken is not None
    return taken


def served(database: Database, count: int) -> list[str]:
    """The owners of the next jobs, each of which is run to its end before the next one starts."""
    found = []
    for _ in range(count):
        taken = claim(database, next_in_turn(database), LEASE, "here")
        taken.finish(Status.SUCCESSFUL, "completed", "", None, Reached())
        found.append(taken.job.owner)
    return found


def test_a_claim_gives_the_case_as_it_was_told_and_an_epoch(registry):
    job = held(registry)
    assert job.case == {"a": [1.5, None], "b": 1}
    assert (job.job.status, job.job.epoch, job.job.attempts) == (Status.RUNNING, 1, 1)


def test_only_one_of_many_claims_wins(registry):
    job_id = submitted(registry)
    won: list[HeldJob] = []

    def try_to_claim() -> None:
        if taken := claim(registry.database, job_id, LEASE, "here"):
            won.append(taken)

    threads = [threading.Thread(target=try_to_claim) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert [taken.job.epoch for taken in won] == [1]


def test_nothing_waits_in_an_empty_registry(database):
    assert next_in_turn(database) is None


def test_of_one_owner_the_oldest_of_the_highest_priority_is_next(registry):
    made = sorted(submitted(registry, priority=p) for p in (0, 0))
    urgent = submitted(registry, priority=5)
    assert next_in_turn(registry.database) == urgent
    assert next_in_turn(registry.database, [urgent]) == made[0]
    assert next_in_turn(registry.database, [urgent, *made]) is None


def test_a_thousand_jobs_of_one_owner_do_not_starve_anothers_one(registry):
    for _ in range(20):
        submitted(registry, "many", priority=9)
    assert served(registry.database, 2) == ["many", "many"]
    submitted(registry, "one")
    assert served(registry.database, 2) == ["one", "many"]


def test_owners_take_turns(registry):
    for owner in "aaabbbccc":
        submitted(registry, owner)
    order = served(registry.database, 9)
    assert all(sorted(order[i : i + 3]) == ["a", "b", "c"] for i in (0, 3, 6))


def test_who_has_fewer_running_goes_first(registry):
    for owner in "aaab":
        submitted(registry, owner)
    database = registry.database
    first = [claim(database, next_in_turn(database), LEASE, "here") for _ in range(3)]
    assert sorted(one.job.owner for one in first) == ["a", "a", "b"]
    next(one for one in first if one.job.owner == "b").finish(Status.FAILED, "x", "", None, Reached())
    submitted(registry, "b")
    assert claim(database, next_in_turn(database), LEASE, "here").job.owner == "b"


def test_a_cancelled_job_has_no_turn(registry):
    job = registry.cancel(submitted(registry))
    assert next_in_turn(registry.database) is None
    assert claim(registry.database, job.id, LEASE, "here") is None


def test_a_running_job_is_not_had_again_even_long_after_its_lease(registry, clock):
    first = held(registry)
    clock.now += 100 * LEASE
    assert claim(registry.database, first.job.id, LEASE, "there") is None
    assert first.renew(LEASE, Reached()) is Wish.GO_ON


def test_a_run_that_came_farther_has_a_new_version_and_a_bare_renewal_has_not(registry):
    job = held(registry)
    assert job.renew(LEASE, Reached(0.5, 1.0, steps=7)) is Wish.GO_ON
    moved = registry.get(job.job.id)
    assert job.renew(LEASE, Reached(0.5, 1.0, steps=7)) is Wish.GO_ON
    again = registry.get(job.job.id)
    assert job.job.version < moved.version == again.version
    assert (moved.progress, moved.t, moved.reached.steps) == (0.5, 1.0, 7)


def test_what_a_run_is_doing_is_told_while_it_runs(registry):
    job = held(registry)
    assert registry.get(job.job.id).phase == ""
    job.renew(LEASE, Reached(0.25, 1.0, wall=2.0, phase="run 1: 16 intervals"))
    one = registry.get(job.job.id)
    job.renew(LEASE, Reached(0.25, 1.0, wall=3.0, phase="run 2: 16 intervals"))
    two = registry.get(job.job.id)
    assert (one.phase, two.phase, two.remaining) == ("run 1: 16 intervals", "run 2: 16 intervals", 9.0)
    assert two.version > one.version
    attributes = {"tolerance_met": "no", "error_r": 2e-3, "crossings": 1}
    job.finish(Status.SUCCESSFUL, "completed", "", None, Reached(1.0, phase="run 3"), attributes=attributes)
    done = registry.get(job.job.id)
    assert (done.phase, done.remaining, done.attributes) == ("", None, attributes)


def test_a_renewal_tells_that_the_owner_cancels(registry):
    job = held(registry)
    assert registry.cancel(job.job.id).status is Status.RUNNING
    assert job.renew(LEASE, Reached()) is Wish.CANCEL


def test_who_lost_the_job_writes_nothing(registry):
    first = held(registry)
    first.release()
    second = held(registry, first.job.id)
    assert second.job.epoch == 2
    assert first.renew(LEASE, Reached(0.9)) is None
    assert not first.checkpointed(Reached(steps=5))
    assert not first.finish(Status.SUCCESSFUL, "completed", "", Dataset("first", "ab", 3), Reached(1.0))
    first.release()
    assert registry.get(first.job.id) == second.job
    assert second.finish(Status.SUCCESSFUL, "completed", "", Dataset("second", "ab", 3), Reached(1.0))
    assert registry.get(first.job.id).dataset == Dataset("second", "ab", 3)


def test_an_end_of_which_nobody_heard_may_be_written_again(registry):
    job = held(registry)
    told = (Status.SUCCESSFUL, "completed", "", Dataset("x", "ab", 3), Reached(1.0))
    assert job.finish(*told)
    before = registry.get(job.job.id)
    assert job.finish(*told)
    assert registry.get(job.job.id) == before


def test_cancelling_an_ended_job_changes_nothing(registry):
    job = held(registry)
    job.finish(Status.SUCCESSFUL, "completed", "", None, Reached(1.0))
    before = registry.get(job.job.id)
    assert registry.cancel(job.job.id) == before


@pytest.mark.parametrize("status", [Status.SUCCESSFUL, Status.FAILED])
def test_a_job_cancelled_before_its_end_is_written_ends_as_dismissed(registry, status):
    job = held(registry)
    registry.cancel(job.job.id)
    told = (status, "x", "", Dataset("x", "ab", 3), Reached(1.0, steps=9))
    assert [job.finish(*told), job.finish(*told)] == [Status.DISMISSED] * 2
    done = registry.get(job.job.id)
    assert (done.status, done.outcome, done.dataset, done.reached.steps) == (Status.DISMISSED, "cancelled", None, 9)


def test_a_released_job_waits_again_without_a_lost_attempt(registry):
    job = held(registry)
    job.release()
    waiting = registry.get(job.job.id)
    assert (waiting.status, waiting.attempts, waiting.fruitless) == (Status.ACCEPTED, 0, 0)
    assert held(registry, job.job.id).job.epoch == 2


@pytest.mark.parametrize(("steps", "fruitless"), [(101, 0), (100, 2), (50, 2)])
def test_only_a_checkpoint_farther_than_any_before_bears_fruit(registry, steps, fruitless):
    first = held(registry)
    first.checkpointed(Reached(steps=100))
    assert registry.get(first.job.id).fruitless == 0
    for _ in range(2):  # as if taken back
        with registry.database.writing() as transaction:
            transaction.change(status=Status.ACCEPTED)
        last = held(registry, first.job.id)
    last.checkpointed(Reached(steps=steps))
    assert registry.get(first.job.id).fruitless == fruitless
