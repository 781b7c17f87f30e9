"""DELETE of an ended job frees its files; then it is gone, and the answer says who and when. A pin keeps it."""

from __future__ import annotations

import os

import pytest

from service.access import KeyStore, Scope
from service.api.app import create_app
from service.jobs.audit import trail
from service.store.verification import MISSING
from worker.run import run_next


@pytest.fixture
def file(done, registry, settings):
    """The dataset of the job that is done."""
    return settings.datasets / registry.get(done).dataset.file


def test_delete_frees_the_files_of_an_ended_job_and_then_it_is_gone(client, done, file, settings):
    assert client.delete(f"/v1/jobs/{done}").status_code == 200
    assert not file.exists()
    assert list(settings.work.iterdir()) == []
    for path in ("", "/dataset", "/data?variables=Tw", "/case", "/events", "/links", "/pin"):
        answer = client.request("PUT" if path == "/pin" else "GET", f"/v1/jobs/{done}{path}")
        told = answer.json()
        assert (answer.status_code, told["type"]) == (410, "urn:hockle:problem:job_deleted"), path
        assert told["deleted_by"] == "local" and told["deleted"] in told["detail"]
    assert client.delete(f"/v1/jobs/{done}").status_code == 410
    assert client.get("/v1/jobs").json()["jobs"] == []
    assert client.get(f"/ogc/jobs/{done}").status_code == 410


def test_deleting_is_in_the_audit_trail_and_in_the_metrics(client, done, registry):
    size = registry.get(done).dataset.bytes
    assert f'hockle_dataset_bytes{{owner="local"}} {float(size)}' in client.get("/metrics").text
    client.delete(f"/v1/jobs/{done}")
    assert [(deed.action, deed.subject) for deed in trail(registry.database, 1)] == [("job_deleted", done)]
    told = client.get("/metrics").text
    assert 'hockle_dataset_bytes{owner="local"} 0.0' in told and "hockle_jobs_deleted_total 1.0" in told
    assert 'hockle_jobs_ended_total{outcome="completed",status="successful"} 1.0' in told


def test_cancelling_deletes_nothing_however_late_it_comes(client, done, file):
    assert client.post(f"/v1/jobs/{done}/cancel").json()["status"] == "successful"
    assert file.exists()


def test_delete_of_a_job_that_waits_cancels_it(client, case):
    job_id = client.post("/v1/jobs", json=case).json()["id"]
    assert client.delete(f"/v1/jobs/{job_id}").json()["status"] == "dismissed"
    assert client.get(f"/v1/jobs/{job_id}").status_code == 200


def test_a_pinned_job_is_not_deleted_until_it_is_unpinned(client, done, file):
    assert client.put(f"/v1/jobs/{done}/pin").json()["pinned"] is True
    answer = client.delete(f"/v1/jobs/{done}")
    assert (answer.status_code, answer.json()["type"]) == (409, "urn:hockle:problem:pinned")
    assert file.exists()
    assert client.delete(f"/v1/jobs/{done}/pin").json()["pinned"] is False
    assert client.delete(f"/v1/jobs/{done}").status_code == 200


def test_a_link_to_a_deleted_dataset_opens_nothing(client, done):
    href = client.post(f"/v1/jobs/{done}/links", json={}).json()["href"]
    client.delete(f"/v1/jobs/{done}")
    assert client.get(href).status_code == 404


def test_what_is_anothers_is_not_there_deleted_or_not(settings, registry, done):
    from fastapi.testclient import TestClient

    key = KeyStore(registry.database).create("bob", frozenset({Scope.READ, Scope.SUBMIT}), 60.0).text
    bob = {"Authorization": f"Bearer {key}"}
    with TestClient(create_app(settings, keyed=True), base_url="http://127.0.0.1:8000") as client:
        assert client.delete(f"/v1/jobs/{done}", headers=bob).status_code == 404
        assert client.put(f"/v1/jobs/{done}/pin", headers=bob).status_code == 404
        assert registry.get(done).status == "successful"


def test_the_same_idempotency_key_tells_that_its_job_was_deleted(client, registry, settings, case):
    key = {"Idempotency-Key": "k"}
    job_id = client.post("/v1/jobs", json=case, headers=key).json()["id"]
    run_next(registry.database, settings)
    client.delete(f"/v1/jobs/{job_id}")
    assert client.post("/v1/jobs", json=case, headers=key).status_code == 410
    assert client.post("/v1/jobs", json=case).json()["id"] != job_id


def damage(file):
    with file.open("r+b") as opened:
        opened.seek(1000)
        opened.write(b"\0" * 64)


def test_a_damaged_dataset_is_not_served_and_the_job_says_so(client, done, file):
    damage(file)
    for path in ("dataset", "data?variables=Tw"):
        answer = client.get(f"/v1/jobs/{done}/{path}")
        assert (answer.status_code, answer.json()["type"]) == (404, "urn:hockle:problem:dataset_lost")
    assert client.get(f"/v1/jobs/{done}").json()["dataset"]["fault"].startswith("damaged: its sha256 is")
    assert "hockle_datasets_lost 1.0" in client.get("/metrics").text
    scalars = client.get(f"/v1/scalars?jobs={done}&variables=Tw").json()["jobs"]  # the registry has them itself
    assert scalars[0]["values"]["Tw"] is not None


def test_a_missing_dataset_is_told_and_one_that_is_back_is_served(client, done, file, tmp_path):
    content = file.read_bytes()
    file.unlink()
    assert client.get(f"/v1/jobs/{done}/dataset").json()["type"] == "urn:hockle:problem:dataset_lost"
    assert client.get(f"/v1/jobs/{done}").json()["dataset"]["fault"] == MISSING
    file.write_bytes(content)
    assert client.get(f"/v1/jobs/{done}/dataset").content == content
    assert client.get(f"/v1/jobs/{done}").json()["dataset"]["fault"] == ""


def test_a_dataset_that_looks_as_it_did_is_not_read_whole_again(client, done, file, monkeypatch):
    monkeypatch.setattr("service.results.published.sha256_of", lambda path: pytest.fail(f"{path} was read"))
    assert client.get(f"/v1/jobs/{done}/dataset").status_code == 200
    monkeypatch.undo()
    os.utime(file)
    assert client.get(f"/v1/jobs/{done}/dataset").status_code == 200


@pytest.mark.parametrize("lose", [lambda file: file.unlink(), damage, lambda file: os.truncate(file, 100)])
def test_a_job_whose_dataset_is_missing_or_damaged_is_not_given_again(client, done, file, case, lose):
    assert client.post("/v1/jobs", json=case).json()["id"] == done
    lose(file)
    assert client.post("/v1/jobs", json=case).json()["id"] != done
