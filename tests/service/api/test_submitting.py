"""POST /v1/jobs: sent again, waited for, reused, estimated."""

from __future__ import annotations

import threading
from dataclasses import replace

import pytest
from fastapi.testclient import TestClient

from service.access import Scope
from service.api.app import create_app
from service.api.preferences import LONGEST_WAIT, wait_preferred
from worker.run import run_next


def problem(answer) -> tuple[int, str]:
    return answer.status_code, answer.json()["type"].removeprefix("urn:hockle:problem:")


def test_the_same_key_and_body_give_the_same_job_however_the_body_is_written(client, case):
    key = {"Idempotency-Key": "8e03978e-40d5-43dd-bc93-6894a57f9324"}
    first = client.post("/v1/jobs", json=case, headers=key)
    again = client.post("/v1/jobs", json=dict(reversed(case.items())), headers=key)
    assert (first.status_code, again.status_code) == (202, 202)
    assert again.json() == first.json() and len(client.get("/v1/jobs").json()["jobs"]) == 1


def test_the_same_key_with_another_body_is_refused(client, case):
    key = {"Idempotency-Key": "k"}
    client.post("/v1/jobs", json=case, headers=key)
    other = client.post("/v1/jobs", json=case | {"title": "another"}, headers=key)
    assert problem(other) == (422, "idempotency_key_reused")
    assert len(client.get("/v1/jobs").json()["jobs"]) == 1


def test_a_refused_body_does_not_use_up_its_key(client, case):
    key = {"Idempotency-Key": "k"}
    assert client.post("/v1/jobs", json=case | {"t_end": -1}, headers=key).status_code == 422
    assert client.post("/v1/jobs", json=case, headers=key).status_code == 202


def test_a_key_in_flight_is_a_conflict(client, case, registry):
    key = {"Idempotency-Key": "k"}
    answers = []
    first = threading.Thread(target=lambda: answers.append(client.post("/v1/jobs", json=case, headers=key)))
    in_flight = client.app.state.parts.submissions._in_flight
    with registry.database.writing():  # the first cannot be committed yet
        first.start()
        while ("local", "k") not in in_flight:
            pass
        second = client.post("/v1/jobs", json=case, headers=key)
    first.join()
    assert problem(second) == (409, "in_flight") and second.headers["retry-after"]
    assert answers[0].status_code == 202
    assert client.post("/v1/jobs", json=case, headers=key).json()["id"] == answers[0].json()["id"]


@pytest.mark.parametrize("key", ["", "x" * 256, "\x07"])
def test_a_faulty_key_is_refused_by_its_name(client, case, key):
    answer = client.post("/v1/jobs", json=case, headers={"Idempotency-Key": key})
    assert problem(answer) == (422, "invalid_parameters")
    assert answer.json()["errors"][0]["parameter"] == "Idempotency-Key"


def test_a_case_that_has_run_is_not_run_again(client, done, case):
    again = client.post("/v1/jobs", json=case)
    assert (again.status_code, again.json()["id"], again.json()["status"]) == (200, done, "successful")
    assert again.headers["location"] == f"/v1/jobs/{done}"


def test_unless_one_says_so(client, done, case):
    fresh = client.post("/v1/jobs", json={"case": case, "reuse": False})
    assert (fresh.status_code, fresh.json()["status"]) == (202, "accepted")


def test_another_case_is_run(client, done, case):
    assert client.post("/v1/jobs", json=case | {"t_end": 0.06}).status_code == 202


def test_who_prefers_to_wait_gets_the_ended_job(client, case, registry, settings):
    answers = []
    waiting = threading.Thread(
        target=lambda: answers.append(client.post("/v1/jobs", json=case, headers={"Prefer": "wait=50"}))
    )
    waiting.start()
    while not client.get("/v1/jobs").json()["jobs"]:
        pass
    run_next(registry.database, settings)  # in the main thread, which alone may catch signals
    waiting.join()
    assert (answers[0].status_code, answers[0].json()["status"]) == (200, "successful")
    assert answers[0].headers["preference-applied"] == "wait=50"


def test_who_has_waited_long_enough_gets_the_job_as_it_is(client, case):
    answer = client.post("/v1/jobs", json=case, headers={"Prefer": "wait=0"})
    assert (answer.status_code, answer.json()["status"]) == (202, "accepted")
    assert answer.headers["preference-applied"] == "wait=0"


@pytest.mark.parametrize(("prefer", "seconds"), [
    (None, None), ("", None), ("wait=5", 5), ("respond-async, wait=10", 10), ('Wait = "7"', 7), ("wait=5;x=1", 5),
    ("wait", None), ("wait=", None), ("wait=-1", None), ("wait=1.5", None), ("wait=x", None), ("wait=²", None),
    ("wait=" + "9" * 5000, LONGEST_WAIT), ("return=minimal", None),
])  # fmt: skip
def test_preferences_are_read_as_rfc_7240_says(prefer, seconds):
    assert wait_preferred(prefer) == seconds


def test_label_and_priority_are_kept_and_filtered_by(client, case):
    body = {"case": case, "label": "sweep 7", "priority": 3}
    job = client.post("/v1/jobs", json=body).json()
    client.post("/v1/jobs", json=case)
    assert (job["label"], job["priority"]) == ("sweep 7", 3)
    assert [one["id"] for one in client.get("/v1/jobs?label=sweep%207").json()["jobs"]] == [job["id"]]


def test_jobs_are_filtered_by_time_on_every_page(client, case):
    made = [client.post("/v1/jobs", json=case).json() for _ in range(4)]
    since, until = made[1]["created"], made[3]["created"]
    page = client.get("/v1/jobs", params={"since": since, "until": until, "limit": 1}).json()
    rest = client.get(page["next"]).json()
    assert [job["id"] for job in page["jobs"] + rest["jobs"]] == [made[2]["id"], made[1]["id"]]
    assert rest["next"] is None


@pytest.mark.parametrize("query", ["since=yesterday", "since=2026-01-01T00:00:00", "after=x", "label=" + "x" * 101])
def test_a_faulty_filter_is_refused_by_its_name(client, query):
    answer = client.get(f"/v1/jobs?{query}")
    assert problem(answer) == (422, "invalid_parameters")
    assert answer.json()["errors"][0]["parameter"] == query.partition("=")[0]


def test_the_case_of_a_job_can_be_submitted_again(client, case):
    job = client.post("/v1/jobs", json=case).json()
    again = client.post("/v1/jobs", json=client.get(job["links"]["case"]).json()).json()
    assert again["case_sha256"] == job["case_sha256"] and again["id"] != job["id"]


def test_what_would_cost_too_much_is_refused_before_it_is_written(settings, case):
    with TestClient(create_app(replace(settings, longest_run=1e-6)), base_url="http://127.0.0.1") as client:
        for where in ("/v1/validate", "/v1/jobs"):
            answer = client.post(where, json=case)
            assert problem(answer) == (422, "invalid_case")
            assert answer.json()["errors"][0]["pointer"] == "/t_end"
        assert client.get("/v1/jobs").json()["jobs"] == []


def test_a_job_may_ask_for_less_than_the_operator_allows(settings, case):
    with TestClient(create_app(replace(settings, limit_wall=60.0)), base_url="http://127.0.0.1") as client:
        asked = client.post("/v1/jobs", json={"case": case, "limits": {"memory": 10**9}}).json()
        silent = client.post("/v1/jobs", json=case).json()
    most = {"wall": 60.0, "memory": settings.limit_memory, "disk": settings.limit_disk}
    assert (asked["limits"], silent["limits"]) == (most | {"memory": 10**9}, most)


def test_what_a_client_asked_for_ends_its_job(client, registry, settings, case):
    job_id = client.post("/v1/jobs", json={"case": case, "limits": {"disk": 1}}).json()["id"]
    run_next(registry.database, settings)
    assert client.get(f"/v1/jobs/{job_id}").json()["outcome"] == "disk_limit_exceeded"


@pytest.mark.parametrize("where", ["/v1/validate", "/v1/jobs", "/ogc/processes/simulate/execution"])
def test_more_than_the_operator_allows_is_refused_by_its_name(client, settings, case, where):
    body = {"case": case, "limits": {"wall": settings.limit_wall + 1, "disk": settings.limit_disk}}
    before = "/inputs/case" if "ogc" in where else ""
    answer = client.post(where, json={"inputs": {"case": body}} if before else body)
    assert problem(answer) == (422, "invalid_case")
    (error,) = answer.json()["errors"]
    assert (error["pointer"], error["rule"][:9]) == (f"{before}/limits/wall", "must be <")


def test_a_webhook_needs_the_key_that_signs_it(client, case):
    body = {"case": case, "webhook": "https://hooks.example/1"}
    assert problem(client.post("/v1/jobs", json=body)) == (422, "webhook_needs_key")
    new = client.app.state.parts.keys.create("alice", frozenset({Scope.SUBMIT}), 60.0)
    assert client.post("/v1/jobs", json=body, headers={"Authorization": f"Bearer {new.text}"}).status_code == 202


def test_our_own_page_may_write(client, case):
    own = {"Origin": "http://127.0.0.1:8000"}
    assert client.post("/v1/jobs", json=case, headers=own).status_code == 202
