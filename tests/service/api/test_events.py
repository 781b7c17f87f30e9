"""The events of a job: in order, to the end, and on from where one left off."""

from __future__ import annotations

import asyncio
import json
import threading

import pytest
from sqlalchemy.exc import OperationalError

from service.access import Caller
from service.jobs import Reached, Status
from service.jobs.held import claim


def events(client, job_id, last=None):
    """The events of a job that has ended, or ends in another thread."""
    headers = {} if last is None else {"Last-Event-ID": str(last)}
    answer = client.get(f"/v1/jobs/{job_id}/events", headers=headers)
    assert answer.headers["content-type"].startswith("text/event-stream")
    found = []
    for block in answer.text.split("\n\n"):
        told = dict(line.split(": ", 1) for line in block.splitlines())
        if "event" in told:
            found.append((int(told["id"]), told["event"], json.loads(told["data"])))
    return found


@pytest.fixture
def job_id(client, case):
    return client.post("/v1/jobs", json=case).json()["id"]


def test_the_events_of_an_ended_job_are_told_and_end(client, done):
    told = events(client, done)
    assert [kind for _, kind, _ in told] == ["accepted", "started", "ended"]
    numbers = [number for number, _, _ in told]
    assert numbers == sorted(set(numbers))
    assert told[-1][2]["status"] == "successful" and "time" in told[-1][2]


def test_events_go_on_after_the_last_that_was_seen(client, done):
    told = events(client, done)
    assert events(client, done, told[0][0]) == told[1:]
    assert events(client, done, 0) == told


def test_after_the_last_event_there_is_nothing_to_come_back_for(client, done):
    last = events(client, done)[-1][0]
    answer = client.get(f"/v1/jobs/{done}/events", headers={"Last-Event-ID": str(last)})
    assert (answer.status_code, answer.content) == (204, b"")


def test_progress_is_told_with_the_whole_job(client, registry, job_id, until):
    held = claim(registry.database, job_id, 9.0, "here")
    seen = []
    listening = threading.Thread(target=lambda: seen.extend(events(client, job_id)))
    listening.start()
    feed = client.app.state.parts.feed
    until(lambda: feed._waiters, "somebody listens")
    held.renew(9.0, Reached(0.5, 0.02, 10))
    until(lambda: any(w.version >= held.job.version + 1 for w in list(feed._waiters)), "the progress was told")
    held.finish(Status.FAILED, "step_too_small", "soften it", None, Reached(0.5, 0.02, 10))
    listening.join()
    [progress] = [data for _, kind, data in seen if kind == "progress" and data["progress"]]
    assert (progress["progress"], progress["status"]) == (0.5, "running")
    assert seen[-1][1:] == ("ended", seen[-1][2]) and seen[-1][2]["status"] == "failed"


def test_a_job_of_nobody_has_no_events(client):
    assert client.get("/v1/jobs/nobody/events").status_code == 404


@pytest.mark.parametrize("last", ["x", "-1", "1.5", "+0.0", "1_0", str(2**70)])
def test_a_faulty_last_event_id_is_refused_by_its_name(client, done, last):
    answer = client.get(f"/v1/jobs/{done}/events", headers={"Last-Event-ID": last})
    assert answer.status_code == 422
    assert answer.json()["errors"][0]["parameter"] == "Last-Event-ID"


def test_who_leaves_is_not_waited_for(client, job_id, until):
    feed = client.app.state.parts.feed
    listening = threading.Thread(target=lambda: events(client, job_id))
    listening.start()
    until(lambda: feed._waiters, "somebody listens")
    client.delete(f"/v1/jobs/{job_id}")
    listening.join()
    until(lambda: not feed._waiters, "nobody is waited for")


def test_a_stream_ends_after_whole_events_where_the_database_cannot_be_read(client):
    async def breaks_off():
        yield "an event"
        raise OperationalError("SELECT", None, ConnectionError("the server has closed the connection"))

    async def seen():
        stream = client.app.state.parts.admitted.while_good(Caller("alice", frozenset()), breaks_off())
        return [event async for event in stream]

    assert asyncio.run(seen()) == ["an event"]
