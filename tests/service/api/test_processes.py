"""OGC API Processes on the same jobs: from the landing page to the results by its links alone."""

from __future__ import annotations

import pytest

from worker.run import run_next


def execute(client, case, process="simulate"):
    return client.post(f"/ogc/processes/{process}/execution", json={"inputs": {"case": case}})


def test_the_landing_page_leads_everywhere(client):
    for link in client.get("/ogc").json()["links"]:
        assert client.get(link["href"]).status_code == 200


def test_what_is_kept_of_the_standard_is_told(client):
    told = client.get("/ogc/conformance").json()["conformsTo"]
    assert "http://www.opengis.net/spec/ogcapi-processes-1/1.0/conf/core" in told


def test_the_one_process_is_described(client):
    [summary] = client.get("/ogc/processes").json()["processes"]
    told = client.get(summary["links"][0]["href"]).json()
    assert told["id"] == "simulate" and summary["jobControlOptions"] == ["async-execute", "dismiss"]
    assert set(told["inputs"]) == {"case"} and set(told["outputs"]) == {"dataset"}


def test_a_case_goes_from_its_execution_to_its_dataset(client, case, registry, settings):
    accepted = execute(client, case)
    assert accepted.status_code == 201 and accepted.json()["status"] == "accepted"
    address = accepted.headers["location"]
    waiting = client.get(f"{address}/results")
    assert waiting.status_code == 404 and waiting.json()["type"].endswith("/result-not-ready")
    run_next(registry.database, settings)
    told = client.get(address).json()
    assert (told["jobID"], told["status"], told["progress"]) == (accepted.json()["jobID"], "successful", 100)
    results = next(link["href"] for link in told["links"] if link["rel"].endswith("/results"))
    dataset = client.get(results).json()["dataset"]
    assert client.get(dataset["href"]).headers["content-type"] == dataset["type"]


def test_it_is_the_same_job_for_both_faces(client, case):
    job_id = execute(client, {"case": "elastica", "set": {"t_end": 1.0}, "label": "ogc"}).json()["jobID"]
    assert client.get(f"/v1/jobs/{job_id}").json()["label"] == "ogc"
    assert [job["jobID"] for job in client.get("/ogc/jobs").json()["jobs"]] == [job_id]


def test_a_case_that_has_run_is_not_run_again_unless_that_is_asked(client, case, registry, settings):
    job_id = execute(client, case).json()["jobID"]
    run_next(registry.database, settings)
    assert execute(client, case).json()["jobID"] == job_id
    assert execute(client, {"case": case, "reuse": False}).json()["jobID"] != job_id


def test_a_dismissed_job_stays_dismissed(client, case):
    address = execute(client, case).headers["location"]
    assert client.delete(address).json()["status"] == "dismissed"
    assert client.get(address).json()["status"] == "dismissed"
    assert client.get(f"{address}/results").status_code == 404


def test_the_list_of_jobs_leads_on(client, case):
    made = {execute(client, case).json()["jobID"] for _ in range(3)}
    seen, address = [], "/ogc/jobs?limit=2"
    while address:
        page = client.get(address).json()
        seen += [job["jobID"] for job in page["jobs"]]
        address = next((link["href"] for link in page["links"] if link["rel"] == "next"), None)
    assert seen == sorted(made, reverse=True)


@pytest.mark.parametrize(("body", "pointer"), [
    ({}, "/inputs/case"), ({"inputs": []}, "/inputs/case"), ({"inputs": {"case": "elastica"}}, "/inputs/case"),
    ({"inputs": {"case": {}}}, "/inputs/case/rod"), ({"inputs": {"case": {"case": "x"}}}, "/inputs/case/case"),
])  # fmt: skip
def test_a_faulty_execution_is_refused_with_a_pointer_into_its_body(client, body, pointer):
    answer = client.post("/ogc/processes/simulate/execution", json=body)
    assert answer.status_code == 422
    assert pointer in [error["pointer"] for error in answer.json()["errors"]]


def test_there_is_no_other_process(client, case):
    for answer in (client.get("/ogc/processes/echo"), execute(client, case, "echo")):
        assert answer.status_code == 404 and answer.json()["type"].endswith("/no-such-process")
