"""The last values of many jobs, in one answer."""

from __future__ import annotations

import pytest

from service.cases import apply_settings
from worker.run import run_next


def problem(answer):
    return answer.status_code, answer.json()["type"].removeprefix("urn:hockle:problem:")


def test_each_job_has_a_record_in_the_order_asked_for(client, registry, settings, case, done):
    again = apply_settings(case, {"loads.gravity": [0.0, 0.0, -1.0]})
    other = client.post("/v1/jobs", json={"case": again, "label": "other"}).json()["id"]
    run_next(registry.database, settings)
    told = client.get("/v1/scalars", params={"jobs": f"{other},{done}", "variables": "Tw, energy_bending"}).json()
    assert [(one["id"], one["label"], one["status"], one["outcome"]) for one in told["jobs"]] == [
        (other, "other", "successful", "completed"), (done, "", "successful", "completed")]
    for one in told["jobs"]:
        whole = client.get(f"/v1/jobs/{one['id']}/data?variables=Tw,energy_bending").json()["variables"]
        assert one["values"] == {name: told["values"][-1] for name, told in whole.items()}


def test_what_a_job_does_not_have_is_null(client, case, done):
    waiting = client.post("/v1/jobs", json=apply_settings(case, {"t_end": 0.04})).json()["id"]
    told = client.get("/v1/scalars", params={"jobs": f"{waiting},{done}", "variables": "Tw,Tw_error"}).json()["jobs"]
    assert told[0]["values"] == {"Tw": None, "Tw_error": None}
    assert told[1]["values"]["Tw"] is not None and told[1]["values"]["Tw_error"] is None


@pytest.mark.parametrize(("variables", "jobs", "expected"), [
    ("Q", "", (422, "unknown_variable")), ("r", "", (422, "unknown_variable")),
    ("Tw", ",nobody", (404, "unknown_job")), ("Tw", ",0" * 200, (422, "too_many_jobs")),
])
def test_what_cannot_be_given_is_refused_by_name(client, done, variables, jobs, expected):
    assert problem(client.get("/v1/scalars", params={"jobs": done + jobs, "variables": variables})) == expected
