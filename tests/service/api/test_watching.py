"""What an operator sees of the registry."""

from __future__ import annotations

import pytest
from prometheus_client.parser import text_string_to_metric_families

from service.jobs import Drift, Reached, Status
from service.jobs.held import claim
from service.jobs.measures import measure


def metrics(client) -> dict[str, float]:
    answer = client.get("/metrics")
    assert answer.status_code == 200 and answer.headers["content-type"].startswith("text/plain")
    families = text_string_to_metric_families(answer.text)
    samples = [sample for family in families for sample in family.samples]
    return {"".join([one.name, *(one.labels[name] for name in sorted(one.labels))]): one.value for one in samples}


def test_the_metrics_are_those_of_the_registry(client, registry, case):
    ids = [client.post("/v1/jobs", json=case).json()["id"] for _ in range(4)]
    held = claim(registry.database, ids[0], 9.0, "here")
    held.finish(Status.FAILED, "step_too_small", "soften it", None, Reached(0.5, 1.0, 100, 7))
    claim(registry.database, ids[1], 9.0, "here").renew(9.0, Reached(0.5, 1.0, 50, 3))
    client.delete(f"/v1/jobs/{ids[2]}")
    told = metrics(client)
    counts = [told[f"hockle_jobs{status}"] for status in ("accepted", "running", "failed", "dismissed", "successful")]
    assert counts == [1, 1, 1, 1, 0]
    assert told["hockle_jobs_ended_totalstep_too_smallfailed"] == told["hockle_jobs_ended_totalcancelleddismissed"] == 1
    assert (told["hockle_steps_total"], told["hockle_steps_redone_total"]) == (160, 10)


def test_steps_taken_do_not_fall_when_a_run_goes_back_to_its_checkpoint(client, registry, case):
    held = claim(registry.database, client.post("/v1/jobs", json=case).json()["id"], 9.0, "here")
    held.renew(9.0, Reached(0.5, 1.0, 50, 0))
    before = metrics(client)["hockle_steps_total"]
    held.renew(9.0, Reached(0.5, 1.0, 30, 20))
    assert metrics(client)["hockle_steps_total"] == before == 50


def test_ages_are_those_of_the_oldest_job_and_the_most_silent_worker(client, registry, case):
    first, second = (client.post("/v1/jobs", json=case).json()["id"] for _ in range(2))
    created, started = registry.get(second).created, claim(registry.database, first, 9.0, "here").job.started
    told = measure(registry.database, 9.0, created + 100.0)
    assert told.queue_age == pytest.approx(100.0)
    assert told.lease_age == pytest.approx(created + 100.0 - started)


def test_drift_is_told_by_method(client, registry, case):
    ids = [client.post("/v1/jobs", json={"case": case, "reuse": False}).json()["id"] for _ in range(4)]
    drifts = [Drift("box", 2e-5, 3e-4), Drift("box", 2e-3, None), Drift("staggered", 1e-14, 1e-9), None]
    for job_id, drift in zip(ids, drifts, strict=True):
        held = claim(registry.database, job_id, 9.0, "here")
        held.finish(Status.SUCCESSFUL, "completed", "", None, Reached(), drift)
    told = metrics(client)
    name = "hockle_drift_topology_turns"
    counts = [told[f"{name}_bucket{bound}box"] for bound in ("1e-05", "0.0001", "0.001", "0.01", "+Inf")]
    assert counts == [0, 1, 1, 2, 2]
    assert (told[f"{name}_countbox"], told[f"{name}_sumbox"]) == (2, pytest.approx(2.02e-3))
    assert told["hockle_drift_energy_ratio_countbox"] == told[f"{name}_countstaggered"] == 1


def test_an_empty_registry_has_no_ages(client):
    told = metrics(client)
    assert told["hockle_queue_age_seconds"] == told["hockle_lease_age_seconds"] == told["hockle_steps_total"] == 0


def test_the_trail_is_told_page_by_page(client, case):
    ids = [client.post("/v1/jobs", json=case).json()["id"] for _ in range(3)]
    client.delete(f"/v1/jobs/{ids[0]}")
    deeds, address = [], "/v1/audit?limit=2"
    while address:
        page = client.get(address).json()
        deeds += [(deed["owner"], deed["action"], deed["subject"]) for deed in page["deeds"]]
        address = page["next"]
    assert deeds == [("local", "job_cancelled", ids[0])] + [("local", "job_submitted", one) for one in reversed(ids)]
