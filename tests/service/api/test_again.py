"""A job once more, with a change: from its start, beyond its end, or otherwise from a time on."""

from __future__ import annotations

import asyncio
from contextlib import suppress

import netCDF4
import numpy as np
import pytest

from service.api.submitting import requested
from service.cases import apply_settings, load_case
from worker import beginnings, trials
from worker.run import run_next


def problem(answer):
    return answer.status_code, answer.json()["type"].removeprefix("urn:hockle:problem:")


@pytest.fixture(autouse=True)
def all_states(monkeypatch):
    """Those of short runs too."""
    monkeypatch.setattr(beginnings, "WORTH", 0.0)
    monkeypatch.setattr(trials, "WORTH", 0.0)


@pytest.fixture
def case():
    short = {"t_end": 1.0, "output.interval": 0.1, "numerics.intervals": 10, "numerics.method": "staggered",
             "ends.end": {"preset": "free", "switches": [{"at": 0.85, "omega3": 0.5}]}}  # fmt: skip
    return apply_settings(load_case("cantilever-vibration"), short)


@pytest.fixture
def run(client, registry, settings):
    """Hand in a body, run it, and give the job with the variables of its dataset."""

    def go(body):
        answer = client.post("/v1/jobs", json=body)
        assert answer.status_code == 202, answer.text
        while run_next(registry.database, settings):
            pass
        job = client.get(answer.headers["location"]).json()
        with netCDF4.Dataset("x", memory=client.get(job["links"]["dataset"]).content) as file:
            file.set_auto_mask(False)
            return job, {name: file[name][:] for name in file.variables}

    return go


def same(one, other):
    return one.keys() == other.keys() and all(
        np.array_equal(one[name], values, equal_nan=values.dtype.kind == "f") for name, values in other.items()
    )


def test_one_value_is_changed(client, run, case, done):
    job, _ = run({"job": done, "set": {"loads.damping": 0.3}})
    assert job["begins_with"] is None  # it differs from the start
    assert client.get(job["links"]["case"]).json() == client.get(f"/v1/jobs/{done}/case").json() | {
        "loads": {**client.get(f"/v1/jobs/{done}/case").json()["loads"], "damping": 0.3}}


def test_a_finished_job_goes_on_beyond_its_end_as_if_asked_for_at_once(client, run, case, done):
    longer, values = run({"job": done, "set": {"t_end": 1.6}, "label": "longer"})
    assert (longer["begins_with"], longer["t"], longer["label"]) == (done, 1.6, "longer")
    alone, expected = run({"case": case, "set": {"t_end": 1.6}, "reuse": False})
    assert alone["begins_with"] is None and alone["case_sha256"] == longer["case_sha256"]
    assert same(values, expected) and len(values["time"]) == 17


@pytest.mark.parametrize(("change", "later", "why"), [
    ({"numerics": {"method": "box", "intervals": 10}}, {}, ""), ({"numerics": {"tolerance": 0.01}}, {}, ""),
    ({"contact": {}}, {}, ""), ({"t_end": 1.6}, {}, ""),
    ({}, {"output.topology": False}, "its output has other frames, or variables"),
    ({"contact": {}}, {"ends.end": "free"}, "law of contact"),
])  # fmt: skip
def test_what_cannot_go_on_says_so_when_it_is_handed_in(client, case, change, later, why):
    first = client.post("/v1/jobs", json={"case": {**case, **change}}).json()
    longer = client.post("/v1/jobs", json={"job": first["id"], "set": {"t_end": 1.7} | later}).json()
    assert longer["begins_with"] == (None if why else first["id"])
    assert longer["message"].startswith("computed from its start: " if why else "") and why in longer["message"]


def test_what_can_only_be_known_as_it_runs_is_said_then(client, registry, settings, run, case):
    """With more turns strands would press harder: the law is another one."""
    turning = {"contact": {}, "ends": {**case["ends"], "end": {"preset": "free", "omega3": 10.0}}}
    first, _ = run({"case": {**case, **turning}})
    answer = client.post("/v1/jobs", json={"job": first["id"], "set": {"t_end": 2.0}})
    told = answer.json()
    assert (told["begins_with"], told["message"]) == (first["id"], "")
    run_next(registry.database, settings)
    ended = client.get(answer.headers["location"]).json()
    assert (ended["status"], ended["begins_with"]) == ("successful", None)


@pytest.mark.parametrize("change", [{"set": {"t_end": 1.6}}, {"fork": {"at": 0.75, "end": {"omega3": -1.0}}}])
def test_a_job_to_a_tolerance_goes_on_as_if_asked_for_at_once(run, case, change):
    case = {**case, "numerics": {"tolerance": 0.01}}
    first, _ = run({"case": case})
    then, values = run({"job": first["id"], **change})
    fork = {"ends.end.switches": [{"at": 0.75, "omega3": -1.0}]}
    alone, expected = run({"case": apply_settings(case, change.get("set", fork)), "reuse": False})
    assert (then["begins_with"], alone["begins_with"]) == (first["id"], None)
    assert then["case_sha256"] == alone["case_sha256"]
    assert same(values, expected) and "kappa_error" in values
    assert then["attributes"]["steps_taken_over"] > 0 and "steps_taken_over" not in alone["attributes"]


def test_a_fork_moves_the_ends_otherwise_from_its_time_on(client, run, case, done):
    fork, values = run({"job": done, "fork": {"at": 0.75, "end": {"omega3": -1.0}}})
    told = client.get(fork["links"]["case"]).json()["ends"]["end"]["switches"]
    assert told == [{"at": 0.75, "omega3": -1.0}] and fork["begins_with"] == done
    changed = apply_settings(case, {"ends.end.switches": [{"at": 0.75, "omega3": -1.0}]})
    _, expected = run({"case": changed, "reuse": False})
    assert same(values, expected)


@pytest.mark.parametrize(("change", "expected"), [
    ({"job": "0" * 26}, (404, "unknown_job")), ({"job": "x"}, (422, "invalid_case")),
    ({"case": "elastica"}, (422, "invalid_case")), ({"fork": {"at": 0.5}}, (422, "invalid_case")),
    ({"fork": {"at": -1, "end": {"omega3": 0}}}, (422, "invalid_case")),
    ({"fork": {"at": 0.5, "end": {"omega9": 0}}}, (422, "invalid_case")),
    ({"set": {"t_end": -1}}, (422, "invalid_case")),
    ({"fork": {"at": 1.0, "end": {"omega3": 0}}}, (422, "invalid_case")),  # its end
])  # fmt: skip
def test_what_cannot_be_done_is_refused(client, done, change, expected):
    assert problem(client.post("/v1/jobs", json={"job": done} | change)) == expected
    assert problem(client.post("/v1/jobs", json={"case": "elastica", "fork": {"at": 1, "end": {"omega3": 0}}})) == (
        422, "invalid_case")


@pytest.mark.parametrize("numerics", [None, {"tolerance": 0.05}])
def test_members_that_differ_late_begin_as_one_does(client, registry, settings, case, numerics):
    case = case if numerics is None else {**case, "numerics": numerics}
    body = {"case": case, "parameters": {"t_end": [0.7, 1.5, 1.0], "loads.damping": [0.1, 0.2]}}
    told = client.post("/v1/ensembles", json=body).json()
    members = client.get(told["links"]["members"]).json()["members"]
    longest = {one["values"]["loads.damping"]: one["job"] for one in members if one["values"]["t_end"] == 1.5}
    order = []
    while run_next(registry.database, settings):
        ended = client.get("/v1/jobs?status=successful").json()["jobs"]
        order += [one["id"] for one in ended if one["id"] not in order]
    assert order.index(longest[0.1]) == 0 and len(order) == 6
    for one in members:
        job = client.get(one["links"]["job"]).json()
        own = longest[one["values"]["loads.damping"]]
        assert job["begins_with"] == (None if own == one["job"] else own)
        alone = client.post("/v1/jobs", json={"case": client.get(job["links"]["case"]).json(), "reuse": False}).json()
        run_next(registry.database, settings)
        for name in ("r", "Tw", "energy_kinetic", "omega"):
            both = [client.get(f"/v1/jobs/{it}/data?variables={name}").json() for it in (job["id"], alone["id"])]
            assert both[0] == both[1], (one["values"], name)


def test_equal_members_and_those_that_have_run_are_begun_with_too(client, registry, settings, case):
    first = client.post("/v1/ensembles", json={"case": case, "parameters": {"t_end": [1.5]}}).json()
    run_next(registry.database, settings)
    body = {"case": case, "parameters": {"t_end": [1.5, 1.0, 1.5, 1.0]}}
    told = client.post("/v1/ensembles", json=body).json()
    members = client.get(told["links"]["members"]).json()["members"]
    [ran] = client.get(first["links"]["members"]).json()["members"]
    assert (told["jobs"], told["counts"]["successful"]) == (2, 2) and members[0]["job"] == ran["job"]
    assert client.get(members[1]["links"]["job"]).json()["begins_with"] == ran["job"]
    again = client.post("/v1/ensembles", json=body | {"reuse": False}).json()
    while run_next(registry.database, settings):
        pass
    for one in (told, again):
        assert client.get(one["links"]["self"]).json()["status"] == "successful"


@pytest.mark.parametrize("path", ["/v1/jobs", "/ogc/processes/simulate/execution"])
def test_the_case_of_a_job_is_read_beside_the_event_loop_however_small_the_body(client, case, monkeypatch, path):
    job_id, seen = client.post("/v1/jobs", json=case).json()["id"], []

    def looking(*told):
        with suppress(RuntimeError):
            seen.append(asyncio.get_running_loop())
        return requested(*told)

    monkeypatch.setattr("service.api.submitting.requested", looking)
    body = {"job": job_id, "set": {"t_end": 0.9}, "reuse": False}
    assert client.post(path, json=body if path == "/v1/jobs" else {"inputs": {"case": body}}).status_code in (201, 202)
    assert seen == []
