"""A link opens one dataset to whoever has it, until it expires or is revoked, and nothing else."""

from __future__ import annotations

import time
from dataclasses import replace

import pytest
from fastapi.testclient import TestClient

from service.access import KeyStore, Scope
from service.access.links import LinkStore
from service.api.app import create_app
from service.jobs import Database
from service.jobs.audit import trail
from worker.run import run_next

HOUR = 3600.0


@pytest.fixture
def keyed(settings):
    with TestClient(create_app(settings, keyed=True), base_url="http://127.0.0.1:8000") as client:
        yield client


@pytest.fixture
def key(keyed):
    def make(owner: str, *scopes: str) -> dict[str, str]:
        keys: KeyStore = keyed.app.state.parts.keys
        new = keys.create(owner, frozenset(map(Scope, scopes or ("read", "submit"))), HOUR)
        return {"Authorization": f"Bearer {new.text}"}

    return make


@pytest.fixture
def alice(key):
    return key("alice")


@pytest.fixture
def job(keyed, alice, case, settings) -> str:
    """The address of a job of alice's that has been run."""
    made = keyed.post("/v1/jobs", json=case, headers=alice)
    run_next(keyed.app.state.parts.registry.database, settings)
    return made.headers["location"]


def shared(client, job, headers, **told):
    answer = client.post(f"{job}/links", json=told, headers=headers)
    assert answer.status_code == 201, answer.text
    return answer.json()


def name_of(answer):
    return answer.json()["type"].removeprefix("urn:hockle:problem:")


def test_a_link_needs_no_key_and_gives_the_same_bytes(keyed, alice, job):
    link = shared(keyed, job, alice, seconds=60)
    with_key = keyed.get(f"{job}/dataset", headers=alice)
    without = keyed.get(link["href"])
    assert keyed.get(f"{link['zarr']}/zarr.json").json()["node_type"] == "group"
    assert keyed.get(f"{link['opendap']}.dds").text.startswith("Dataset {")
    assert (without.status_code, without.content) == (200, with_key.content)
    assert without.headers["etag"] == with_key.headers["etag"]
    part = keyed.get(link["href"], headers={"Range": "bytes=0-9"})
    assert (part.status_code, part.content) == (206, with_key.content[:10])
    assert int(keyed.head(link["href"]).headers["content-length"]) == len(with_key.content)


def test_a_link_opens_nothing_else(keyed, alice, job):
    token = shared(keyed, job, alice)["href"].rsplit("/", 1)[1].removesuffix(".nc")
    for path in (job, f"{job}/dataset", f"{job}/data?variables=Tw", "/v1/jobs"):
        assert keyed.get(path, headers={"Authorization": f"Bearer {token}"}).status_code == 401
    for path in (f"/v1/shared/{token}", "/v1/shared/", f"/v1/shared/{token}/../jobs", f"/v1/shared/{token[:-1]}.nc"):
        assert keyed.get(path).status_code in (401, 404)
    assert keyed.delete(f"/v1/shared/{token}.nc").status_code == 405


def test_an_expired_a_revoked_and_an_unknown_link_look_the_same(keyed, alice, job):
    expired = shared(keyed, job, alice, seconds=0.01)
    revoked = shared(keyed, job, alice)
    assert keyed.delete(f"{job}/links/{revoked['id']}", headers=alice).status_code == 204
    assert keyed.delete(f"{job}/links/{revoked['id']}", headers=alice).status_code == 204
    time.sleep(0.02)
    answers = [keyed.get(href) for href in (expired["href"], revoked["href"], "/v1/shared/" + "0" * 55 + ".nc",
                                            f"{expired['zarr']}/zarr.json", f"{expired['opendap']}.das")]  # fmt: skip
    assert {(answer.status_code, answer.text) for answer in answers} == {(404, answers[0].text)}
    assert name_of(answers[0]) == "link_not_good"


def test_links_are_listed_without_their_addresses_and_noted_in_the_trail(keyed, alice, job, settings):
    first, second = shared(keyed, job, alice), shared(keyed, job, alice, seconds=5)
    keyed.delete(f"{job}/links/{first['id']}", headers=alice)
    listed = keyed.get(f"{job}/links", headers=alice).json()["links"]
    assert [(one["id"], one["href"], one["revoked"] is None) for one in listed] == [
        (first["id"], None, False), (second["id"], None, True)]
    database = Database(settings.database_url)
    told = [(deed.owner, deed.action, deed.subject) for deed in trail(database, 3)]
    kept = LinkStore(database).of(job.rsplit("/", 1)[1])
    database.close()
    job_id = job.rsplit("/", 1)[1]
    assert told == [("alice", "link_revoked", job_id), *[("alice", "link_created", job_id)] * 2]
    assert not any(link.sha256 in first["href"] + second["href"] for link in kept)


def test_only_who_may_submit_shares_what_is_their_own(keyed, key, job):
    assert keyed.post(f"{job}/links", json={}, headers=key("alice", "read")).status_code == 403
    for headers in (key("bob"),):
        assert name_of(keyed.post(f"{job}/links", json={}, headers=headers)) == "unknown_job"
        assert name_of(keyed.get(f"{job}/links", headers=headers)) == "unknown_job"
        assert name_of(keyed.delete(f"{job}/links/{'0' * 12}", headers=headers)) == "unknown_job"


@pytest.mark.parametrize("seconds", [0, -1, 1e9, "60", None])
def test_a_time_that_is_none_is_refused(keyed, alice, job, seconds):
    answer = keyed.post(f"{job}/links", json={"seconds": seconds}, headers=alice)
    assert (answer.status_code, answer.json()["errors"][0]["pointer"]) == (422, "/seconds")


def test_a_job_that_has_not_ended_has_nothing_to_share(keyed, alice, case):
    job = keyed.post("/v1/jobs", json=case, headers=alice).headers["location"]
    assert name_of(keyed.post(f"{job}/links", json={}, headers=alice)) == "not_finished"
    assert name_of(keyed.delete(f"{job}/links/{'0' * 12}", headers=alice)) == "unknown_link"


def test_a_link_has_a_rate_of_its_own(settings, case):
    with TestClient(create_app(replace(settings, rate=0.2), keyed=False), base_url="http://127.0.0.1:8000") as client:
        job = client.post("/v1/jobs", json=case).headers["location"]
        run_next(client.app.state.parts.registry.database, settings)
        link = shared(client, job, {})
        assert [client.get(link["href"]).status_code for _ in range(3)] == [200, 200, 429]
        assert int(client.get(link["href"]).headers["retry-after"]) >= 1
        assert client.get(shared(client, job, {})["href"]).status_code == 200


def test_the_token_of_a_link_is_in_no_log(keyed, alice, job, caplog, capfd):
    caplog.set_level("DEBUG")
    link = shared(keyed, job, alice)
    for headers in ({}, {"Range": "bytes=0-9"}, {"Host": "evil.example"}):
        keyed.get(link["href"], headers=headers)
    token = link["href"].rsplit("/", 1)[1].removesuffix(".nc")
    ours = "".join(record.getMessage() for record in caplog.records if not record.name.startswith("httpx"))
    assert token not in ours and token not in "".join(capfd.readouterr())
