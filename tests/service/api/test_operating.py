"""What an operator does with the queue, with a host and with a failed job."""

from __future__ import annotations

import platform

import pytest

from service.jobs import Reached, Status
from service.jobs.held import Wish, claim
from service.jobs.processes import Presence
from service.jobs.sharing import next_in_turn

HERE = platform.node()


@pytest.fixture
def running(client, registry, case):
    """A job that runs on this host, as a worker has it."""
    Presence(registry.database, "worker").beat()
    job_id = client.post("/v1/jobs", json=case).json()["id"]
    return claim(registry.database, job_id, 9.0, f"{HERE}:1")


def deeds(client) -> list[tuple[str, str]]:
    return [(deed["action"], deed["subject"]) for deed in client.get("/v1/audit?limit=3").json()["deeds"]]


def test_the_queue_is_told_with_its_hosts(client, running, case):
    client.post("/v1/jobs", json={"case": case, "reuse": False})
    told = client.get("/v1/queue").json()
    assert (told["waiting"], told["running"], told["paused"]) == (1, 1, None)
    assert told["hosts"] == [{"name": HERE, "workers": 1, "paused": None}]


def test_a_paused_queue_takes_jobs_that_wait_until_it_is_resumed(client, registry, running, case):
    paused = client.put("/v1/queue/pause").json()["paused"]
    assert (paused["drains"], paused["owner"]) == (False, "local")
    job_id = client.post("/v1/jobs", json={"case": case, "reuse": False}).json()["id"]
    assert next_in_turn(registry.database, host=HERE) is None
    assert running.renew(9.0, Reached()) is Wish.GO_ON
    assert client.delete("/v1/queue/pause").json()["paused"] is None
    assert next_in_turn(registry.database, host=HERE) == job_id
    assert [action for action, _ in deeds(client)] == ["queue_resumed", "job_submitted", "queue_paused"]


def test_a_drained_host_hands_back_what_it_runs(client, registry, running):
    told = client.put(f"/v1/hosts/{HERE}/pause?drain=true").json()
    assert told["paused"] is None and told["hosts"][0]["paused"]["drains"]
    assert running.renew(9.0, Reached()) is Wish.GIVE_WAY
    running.release()
    assert next_in_turn(registry.database, host=HERE) is None
    assert next_in_turn(registry.database, host="elsewhere") == running.job.id
    client.delete(f"/v1/hosts/{HERE}/pause")
    assert next_in_turn(registry.database, host=HERE) == running.job.id
    assert deeds(client)[:2] == [("host_resumed", HERE), ("host_drained", HERE)]


def test_a_host_that_nobody_knows_is_not_paused(client, running):
    answer = client.put("/v1/hosts/nowhere/pause")
    assert (answer.status_code, answer.json()["type"]) == (404, "urn:hockle:problem:unknown_host")
    assert HERE in answer.json()["detail"]


def test_a_failed_job_is_queued_again_as_a_new_one_and_stays_what_it_is(client, registry, running, case):
    running.finish(Status.FAILED, "worker_lost", "lost", None, Reached(0.5))
    answer = client.post(f"/v1/jobs/{running.job.id}/requeue")
    new = answer.json()
    assert (answer.status_code, new["status"]) == (202, "accepted")
    assert new["id"] != running.job.id and new["case_sha256"] == running.job.case_sha256
    assert registry.get(running.job.id).status is Status.FAILED
    assert deeds(client)[:2] == [("job_requeued", running.job.id), ("job_submitted", new["id"])]


def test_only_what_failed_is_queued_again(client, running):
    answer = client.post(f"/v1/jobs/{running.job.id}/requeue")
    assert (answer.status_code, answer.json()["type"]) == (409, "urn:hockle:problem:not_failed")
    assert client.post("/v1/jobs/nobody/requeue").status_code == 404
