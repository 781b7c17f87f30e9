"""Who has a key sees his own, and may do what its scopes say."""

from __future__ import annotations

import threading
from dataclasses import replace

import httpx
import pytest
from fastapi.testclient import TestClient
from sqlalchemy import update

from service.access import Scope
from service.api.app import create_app
from service.api.listening import listen
from service.jobs import Database
from service.jobs.audit import trail
from service.jobs.tables import api_keys
from tests.service.api.conftest import HOUR, refused


@pytest.fixture
def keyed(settings):
    app = create_app(replace(settings, rate=1e6), keyed=True)
    with TestClient(app, base_url="http://127.0.0.1:8000", raise_server_exceptions=False) as client:
        yield client


def test_an_operator_who_may_submit_cancels_anothers_job(keyed, key, alices):
    looking = key("watcher", "read", "operate")
    refused(keyed.delete(f"/v1/jobs/{alices}", headers=looking), 403, "scope_missing")
    acting = key("op", "submit", "operate")
    assert keyed.delete(f"/v1/jobs/{alices}", headers=acting).json()["status"] == "dismissed"


def test_lists_hold_ones_own_jobs_only(keyed, key, case, alices):
    bobs = keyed.post("/v1/jobs", json=case, headers=key("bob")).json()["id"]
    for owner, job_id in (("alice", alices), ("bob", bobs)):
        listed = keyed.get("/v1/jobs", headers=key(owner)).json()["jobs"]
        assert [(job["id"], job["owner"]) for job in listed] == [(job_id, owner)]
        listed = keyed.get("/ogc/jobs", headers=key(owner)).json()["jobs"]
        assert [job["jobID"] for job in listed] == [job_id]


def test_asking_for_anothers_list_is_refused_but_to_an_operator(keyed, key, alices):
    refused(keyed.get("/v1/jobs?owner=alice", headers=key("bob")), 403, "scope_missing")
    listed = keyed.get("/v1/jobs?owner=alice", headers=key("op", "read", "operate")).json()["jobs"]
    assert [job["id"] for job in listed] == [alices]


def test_an_idempotency_key_or_a_finished_case_of_another_owner_is_nobodys_business(keyed, key, case):
    ids = {keyed.post("/v1/jobs", json=case, headers=key(owner) | {"Idempotency-Key": "1"}).json()["id"]
           for owner in ("alice", "bob")}  # fmt: skip
    assert len(ids) == 2


def test_a_key_counts_on_loopback_too(client, case):
    store = client.app.state.parts.keys
    new = store.create("alice", frozenset({Scope.READ, Scope.SUBMIT}), HOUR)
    with_key = {"Authorization": f"Bearer {new.text}"}
    assert client.post("/v1/jobs", json=case, headers=with_key).json()["owner"] == "alice"
    assert client.post("/v1/jobs", json=case).json()["owner"] == "local"
    assert client.get("/v1/jobs", headers={"Authorization": "Bearer wrong"}).status_code == 401


def test_too_many_requests_are_refused_with_the_time_to_wait(settings, case):
    with TestClient(create_app(replace(settings, rate=0.1), keyed=True), base_url="http://127.0.0.1") as client:
        new = client.app.state.parts.keys.create("alice", frozenset({Scope.READ}), HOUR)
        headers = {"Authorization": f"Bearer {new.text}"}
        first = client.get("/v1/jobs", headers=headers)
        assert (first.status_code, first.headers["ratelimit-policy"]) == (200, '"owner";q=1;w=10')
        assert first.headers["ratelimit"].startswith('"owner";r=0;t=')
        second = client.get("/v1/jobs", headers=headers)
        refused(second, 429, "too_many_requests")
        assert 1 <= int(second.headers["retry-after"]) <= 10


def test_an_owner_may_have_so_many_unfinished_jobs(settings, case):
    with TestClient(create_app(replace(settings, quota=2)), base_url="http://127.0.0.1") as client:
        made = [client.post("/v1/jobs", json=case).json()["id"] for _ in range(2)]
        too_many = client.post("/v1/jobs", json=case)
        refused(too_many, 429, "quota_reached")
        assert int(too_many.headers["retry-after"]) >= 1
        client.delete(f"/v1/jobs/{made[0]}")
        assert client.post("/v1/jobs", json=case).status_code == 202


def test_the_secret_of_a_key_is_in_no_log(keyed, key, alices, caplog, capfd):
    caplog.set_level("DEBUG")
    headers = key("alice")
    keyed.get("/v1/jobs", headers=headers)
    keyed.get("/v1/nothing", headers=headers)
    keyed.get("/v1/jobs", headers={"Authorization": headers["Authorization"] + "x"})
    secret = headers["Authorization"].split("_", 2)[2]  # itself it may hold "_"
    assert secret not in caplog.text and secret not in "".join(capfd.readouterr())


def test_the_trail_tells_who_did_what(keyed, key, case, alices, settings):
    bob = key("bob")
    bobs = keyed.post("/v1/jobs", json=case, headers=bob).json()["id"]
    keyed.delete(f"/v1/jobs/{bobs}", headers=bob)
    database = Database(settings.database_url)
    told = [(deed.owner, deed.action, deed.subject) for deed in trail(database, 2)]
    database.close()
    assert told == [("bob", "job_cancelled", bobs), ("bob", "job_submitted", bobs)]


@pytest.mark.parametrize("host", ["evil.example", "127.0.0.1.evil.example"])
def test_with_keys_a_host_is_an_address_or_a_name_of_ours(settings, host):
    with TestClient(create_app(replace(settings, hosts="Hockle.example, rods.example"), keyed=True)) as client:
        refused(client.get("/livez", headers={"Host": host}), 421, "foreign_host")
        for ours in ("hockle.example", "rods.example:8000", "10.0.0.7:8000", "[2001:db8::7]", "localhost"):
            assert client.get("/livez", headers={"Host": ours}).status_code == 200


@pytest.mark.parametrize("host", ["0.0.0.0", "10.0.0.7", "example.org", "::"])
def test_without_keys_only_loopback_is_served(host):
    with pytest.raises(ValueError, match="host must be a loopback address"):
        listen(host, 0)


def test_the_description_asks_for_a_key_where_one_is_required_and_tells_of_the_headers(keyed, client):
    for asked, optional in ((keyed, []), (client, [{}])):
        told = asked.get("/v1/openapi.json").json()
        operation = told["paths"]["/v1/jobs"]["post"]
        assert operation["security"] == [{"API key": []}, *optional]
        answers = operation["responses"]
        assert answers["401"]["headers"]["WWW-Authenticate"]["required"]
        assert answers["429"]["headers"]["Retry-After"]["required"]
        limited = {status for status, answer in answers.items() if "RateLimit" in answer.get("headers", {})}
        assert limited == set(answers) - {"401", "403", "421"}
        assert all(header["required"] is (not optional) for header in told["components"]["headers"].values())


def test_a_webhook_that_leads_inside_is_refused_where_it_is_handed_in(keyed, key, case):
    alice = key("alice")
    for path, body, pointer in (
        ("/v1/jobs", {"case": case, "webhook": "http://169.254.169.254/latest"}, "/webhook"),
        ("/ogc/processes/simulate/execution",
         {"inputs": {"case": {"case": case, "webhook": "http://localhost:1/"}}}, "/inputs/case/webhook"),
    ):  # fmt: skip
        answer = keyed.post(path, json=body, headers=alice)
        assert answer.status_code == 422
        [error] = answer.json()["errors"]
        assert (error["pointer"], error["rule"]) == (pointer, "must lead to the public internet")


def test_a_webhook_stands_in_the_job_from_its_submission_on(keyed, key, case):
    alice = key("alice")
    body = {"case": case, "webhook": "https://lab.example/done", "reuse": False}
    told = keyed.post("/v1/jobs", json=body, headers=alice).json()
    expected = {"url": "https://lab.example/done", "deliveries": 0, "last": "", "next_attempt": None}
    assert told["webhook"] == expected
    assert keyed.get(f"/v1/jobs/{told['id']}", headers=alice).json()["webhook"] == expected
    assert keyed.post("/v1/jobs", json=case, headers=alice).json()["webhook"] is None


@pytest.mark.parametrize("end", ["revoked", "expired"])
@pytest.mark.parametrize("of", ["jobs", "ensembles"])
def test_the_events_that_a_key_follows_end_with_it(keyed, key, store, case, until, monkeypatch, of, end):
    monkeypatch.setattr("service.api.admitted.LOOK", 0.01)
    mine, others = key("alice"), key("alice")
    body = case if of == "jobs" else {"case": case, "parameters": {"loads.damping": [0.1, 0.2]}}
    address = keyed.post(f"/v1/{of}", json=body, headers=mine).json()["links"]["events"]
    answers: dict[str, httpx.Response] = {}

    def listen(name: str, headers: dict[str, str]) -> None:
        answers[name] = keyed.get(address, headers=headers)

    threads = [threading.Thread(target=listen, args=told, daemon=True) for told in (("mine", mine), ("others", others))]
    for thread in threads:
        thread.start()
    prefix = mine["Authorization"].split("_")[1]
    until(lambda: prefix in keyed.app.state.parts.admitted._checks, "somebody listens")
    if end == "revoked":
        store.revoke(prefix)
    else:
        with keyed.app.state.parts.registry.database.writing() as transaction:
            gone = update(api_keys).where(api_keys.c.prefix == prefix).values(expires=transaction.now - 1.0)
            transaction.connection.execute(gone)
    until(lambda: "mine" in answers, "the stream of the key ends")
    assert answers["mine"].status_code == 200
    assert "others" not in answers  # who has a good key goes on
    keyed.request("POST", address.replace("/events", "/cancel"), headers=others)
    until(lambda: "others" in answers, "its stream ends with what it follows")
