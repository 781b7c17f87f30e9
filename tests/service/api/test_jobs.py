"""/v1/jobs: what a client is promised."""

from __future__ import annotations

import hashlib

from service.jobs import Dataset, Reached, Status
from service.jobs.held import claim


def test_a_submission_is_accepted_and_found_where_it_says(client, case):
    answer = client.post("/v1/jobs", json=case)
    assert answer.status_code == 202
    assert int(answer.headers["retry-after"]) >= 1
    job = client.get(answer.headers["location"]).json()
    assert job == answer.json()
    assert (job["status"], job["progress"], job["title"]) == ("accepted", 0.0, case["title"])


def test_a_shipped_case_is_submitted_by_name_with_settings(client, registry):
    settings = {"t_end": 3, "numerics.intervals": 50}
    answer = client.post("/v1/jobs", json={"case": "goyal-2003", "set": settings})
    assert answer.status_code == 202
    told = claim(registry.database, answer.json()["id"], 9.0, "here").case
    assert (told["t_end"], told["numerics"]["intervals"]) == (3, 50)


def test_the_stored_case_has_every_default_filled_in(client, registry, case):
    del case["numerics"]
    job_id = client.post("/v1/jobs", json=case).json()["id"]
    assert claim(registry.database, job_id, 9.0, "here").case["numerics"]["tolerance"] == 1e-3


def test_a_job_is_accepted_while_the_broker_is_dead(client, case, monkeypatch):
    monkeypatch.setattr("celery.Celery.send_task", _refuse)
    answer = client.post("/v1/jobs", json=case)
    assert answer.status_code == 202
    assert client.get(answer.headers["location"]).json()["status"] == "accepted"


def test_an_unchanged_job_is_answered_304_and_a_changed_one_is_not(client, registry, case):
    address = client.post("/v1/jobs", json=case).headers["location"]
    etag = client.get(address).headers["etag"]
    for tag in (etag, f"W/{etag}", f'"x", {etag}', "*"):
        unchanged = client.get(address, headers={"If-None-Match": tag})
        assert (unchanged.status_code, unchanged.content) == (304, b"")
    claim(registry.database, address.rsplit("/", 1)[1], 9.0, "here")
    changed = client.get(address, headers={"If-None-Match": etag})
    assert (changed.status_code, changed.json()["status"]) == (200, "running")
    assert changed.headers["etag"] != etag


def test_pages_lead_from_the_newest_job_to_the_oldest(client, case):
    made = {client.post("/v1/jobs", json=case).json()["id"] for _ in range(5)}
    seen, address = [], "/v1/jobs?limit=2"
    while address:
        page = client.get(address).json()
        seen += [job["id"] for job in page["jobs"]]
        address = page["next"]
    assert seen == sorted(made, reverse=True)


def test_a_list_is_filtered_by_status_on_every_page(client, registry, case):
    ids = [client.post("/v1/jobs", json=case).json()["id"] for _ in range(4)]
    for job_id in ids[:3]:
        registry.cancel(job_id)
    first = client.get("/v1/jobs?limit=2&status=dismissed").json()
    second = client.get(first["next"]).json()
    assert {job["id"] for job in first["jobs"] + second["jobs"]} == set(ids[:3])


def test_a_waiting_job_is_cancelled_at_once(client, case):
    address = client.post("/v1/jobs", json=case).headers["location"]
    assert client.delete(address).json()["status"] == "dismissed"
    assert client.get(address).json()["message"] == "cancelled before it started"


def test_a_running_job_is_marked_for_its_worker(client, registry, case):
    job_id = client.post("/v1/jobs", json=case).json()["id"]
    claim(registry.database, job_id, 9.0, "here")
    told = client.delete(f"/v1/jobs/{job_id}").json()
    assert (told["status"], told["cancel_requested"]) == ("running", True)


def test_cancelling_what_has_ended_changes_nothing(client, done):
    before = client.get(f"/v1/jobs/{done}").json()
    assert client.delete(f"/v1/jobs/{done}").json() == before


def test_a_finished_job_links_to_its_results(client, done):
    job = client.get(f"/v1/jobs/{done}").json()
    assert (job["status"], job["progress"], job["outcome"]) == ("successful", 1.0, "completed")
    for link in (job["links"]["dataset"], job["links"]["data"] + "?variables=Tw"):
        assert client.get(link).status_code == 200


def test_a_failed_job_says_why_and_still_gives_its_frames(client, registry, settings, case):
    job_id = client.post("/v1/jobs", json=case).json()["id"]
    held = claim(registry.database, job_id, 9.0, "here")
    (settings.datasets / "part.nc").write_bytes(b"frames so far")
    part = Dataset("part.nc", hashlib.sha256(b"frames so far").hexdigest(), 13)
    held.finish(Status.FAILED, "step_too_small", "soften it", part, Reached(1.0, 34.0))
    told = client.get(f"/v1/jobs/{job_id}").json()
    assert (told["outcome"], told["message"]) == ("step_too_small", "soften it")
    assert client.get(told["dataset"]["href"]).content == b"frames so far"


def _refuse(*_, **__):
    raise ConnectionRefusedError("no broker")
