"""The registry: what owners put into it and read from it."""

from __future__ import annotations

import json

import pytest
from sqlalchemy import select, text
from sqlalchemy.event import listen

from service.jobs import ENDED, Job, Limits, NewJob, Registry, Selection, Status, UnknownJob, new_id
from service.jobs.held import claim
from service.jobs.lifecycle import TRANSITIONS, allowed_before
from service.jobs.tables import events


def submitted(registry: Registry) -> Job:
    return registry.submit(NewJob({"b": 1, "a": [1.5, None]}, "a case"))


def test_ended_states_are_those_that_lead_nowhere():
    assert {Status.SUCCESSFUL, Status.FAILED, Status.DISMISSED} == ENDED
    assert all(before not in ENDED for before, _ in TRANSITIONS)
    assert allowed_before(Status.SUCCESSFUL) == [Status.RUNNING]


def test_identifiers_sort_by_time_and_differ():
    ids = [new_id() for _ in range(1000)]
    assert len(set(ids)) == 1000
    assert all(len(i) == 26 and i.isalnum() and i.islower() for i in ids)
    assert [i[:9] for i in ids] == sorted(i[:9] for i in ids)


def test_a_submitted_job_waits_with_all_that_was_told(registry):
    limits = Limits(wall=60.0, memory=10**9, disk=10**8)
    new = NewJob({"a": 1}, "a case", owner="lab", label="sweep 1", priority=3, limits=limits)
    job = registry.submit(new)
    assert (job.status, job.progress, job.attempts, job.version) == (Status.ACCEPTED, 0.0, 0, 1)
    assert (job.owner, job.label, job.priority, job.limits) == ("lab", "sweep 1", 3, limits)
    assert registry.get(job.id) == job


def test_a_limit_that_nothing_could_keep_is_refused():
    with pytest.raises(ValueError, match="memory must be >= 64000000, got 1"):
        Limits(memory=1)


def test_equal_cases_share_a_hash_whatever_the_order_of_their_fields():
    assert NewJob({"a": 1, "b": 2}).case_sha256 == NewJob({"b": 2, "a": 1}).case_sha256
    assert NewJob({"a": 1}).case_sha256 != NewJob({"a": 2}).case_sha256


def test_an_unknown_id_is_told_so(registry):
    with pytest.raises(UnknownJob):
        registry.get("nobody")
    with pytest.raises(UnknownJob):
        registry.cancel("nobody")


def test_a_waiting_job_is_dismissed_at_once(registry):
    job = registry.cancel(submitted(registry).id)
    assert (job.status, job.outcome) == (Status.DISMISSED, "cancelled")
    assert registry.cancel(job.id) == job


def test_each_change_of_state_is_an_event_told_by_the_version(registry):
    job = submitted(registry)
    held = claim(registry.database, job.id, 10.0, "here")
    registry.cancel(job.id)
    held.finish(Status.DISMISSED, "cancelled", "", None, held.job.reached)
    with registry.database.reading() as connection:
        found = connection.execute(select(events).where(events.c.job_id == job.id).order_by(events.c.seq)).all()
    assert [event.kind for event in found] == ["accepted", "started", "cancel_requested", "ended"]
    assert json.loads(found[-1].data)["status"] == "dismissed"
    assert found[-1].seq == registry.get(job.id).version


def test_pages_go_from_the_newest_to_the_oldest_without_gap_or_repeat(registry):
    made = sorted((submitted(registry).id for _ in range(7)), reverse=True)
    registry.cancel(made[3])
    seen, after = [], None
    while True:
        page = registry.page(3, Selection(after))
        seen += [job.id for job in page.jobs]
        if page.next is None:
            break
        after = page.next
    assert seen == made
    assert [job.id for job in registry.page(3, Selection(status=Status.DISMISSED)).jobs] == [made[3]]


@pytest.mark.parametrize("url", ["sqlite"], indirect=True)
def test_a_status_read_is_a_point_read_by_the_primary_key(registry):
    with registry.database.reading() as connection:
        plan = connection.execute(text("EXPLAIN QUERY PLAN SELECT status FROM jobs WHERE id = 'x'")).all()
    assert "SEARCH jobs USING INDEX" in str(plan)


SELECTIONS = [Selection(), Selection("z" * 26), Selection(owner="local"), Selection(status=Status.SUCCESSFUL),
              Selection(status=Status.ACCEPTED, owner="local"), Selection(label="x"), Selection(since=1.0),
              Selection(ensemble="x")]  # fmt: skip


@pytest.mark.parametrize("url", ["sqlite"], indirect=True)
@pytest.mark.parametrize("selection", SELECTIONS, ids=str)
def test_no_page_sorts_all_jobs_for_the_few_that_it_holds(registry, selection):
    asked = []
    with registry.database.reading() as connection:
        listen(connection.engine, "before_cursor_execute", lambda *told: asked.append(told[2:4]))
        registry.page(10, selection)
        [(statement, parameters)] = asked
        plan = [row[-1] for row in connection.exec_driver_sql(f"EXPLAIN QUERY PLAN {statement}", parameters)]
    assert not any("TEMP B-TREE" in step or "SCAN" in step for step in plan), plan


@pytest.mark.parametrize("ask", [Registry.get, Registry.case, Registry.cancel])
def test_an_id_with_a_nul_is_of_no_job(registry, ask):
    with pytest.raises(UnknownJob):
        ask(registry, "a\0b")
