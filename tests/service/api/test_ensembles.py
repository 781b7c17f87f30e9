"""Ensembles over HTTP: accepted as one, followed as one, read as one."""

from __future__ import annotations

import io
import json
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from service.jobs import Status
from service.results.formats import FORMATS
from tests.service.api.conftest import dataset_of
from worker.run import run_next

DAMPING = [0.0, 0.5, 1.0]


def problem(answer):
    return answer.status_code, answer.json()["type"].removeprefix("urn:hockle:problem:")


@pytest.fixture
def grid(case):
    """Six members: a grid of two parameters."""
    return {"case": case, "parameters": {
        "damping": {"path": "loads.damping", "values": DAMPING},
        "gravity": {"path": "loads.gravity.0", "values": [0, -1]},
    }}  # fmt: skip


@pytest.fixture
def case(case):
    return case | {"loads": {"gravity": [0.0, 0.0, 0.0]}}


@pytest.fixture
def run_all(registry, settings):
    def run():
        while run_next(registry.database, settings):
            pass

    return run


@pytest.fixture
def done(client, grid, run_all):
    address = client.post("/v1/ensembles", json=grid).headers["location"]
    run_all()
    return address


def test_all_members_of_a_grid_are_accepted_at_once(client, grid):
    answer = client.post("/v1/ensembles", json=grid | {"label": "first", "title": "A grid"})
    assert answer.status_code == 202 and answer.headers["retry-after"]
    told = answer.json()
    assert (told["members"], told["jobs"], told["status"], told["progress"]) == (6, 6, "accepted", 0.0)
    assert told["counts"] == {"accepted": 6, "running": 0, "successful": 0, "failed": 0, "dismissed": 0}
    assert told == client.get(answer.headers["location"]).json()
    members = client.get(told["links"]["members"]).json()["members"]
    assert [one["values"] for one in members] == [{"damping": c, "gravity": g} for c in DAMPING for g in (0, -1)]
    for one in members:
        case = client.get(one["links"]["job"] + "/case").json()
        assert case["loads"] == {"gravity": [one["values"]["gravity"], 0.0, 0.0], "distributed": [], "point": [],
                                 "obstacles": [], "damping": one["values"]["damping"]}  # fmt: skip
        assert client.get(one["links"]["job"]).json()["label"] == "first"


def test_a_list_says_what_each_member_has(client, case):
    body = {"case": case, "members": [{"loads.damping": 0.1, "t_end": 0.04}, {"loads.damping": 0.2, "t_end": 0.05}]}
    told = client.post("/v1/ensembles", json=body).json()
    assert told["design"] == {"method": "list", "parameters": {"loads.damping": {"path": "loads.damping"},
                                                               "t_end": {"path": "t_end"}}}
    assert [one["values"] for one in client.get(told["links"]["members"]).json()["members"]] == body["members"]


@pytest.mark.parametrize(("method", "members"), [("latin_hypercube", 8), ("sobol", 8), ("saltelli", 32)])
def test_a_sample_fills_its_ranges_and_is_the_same_again(client, case, method, members):
    def values(seed):
        body = {"case": case, "sample": {"method": method, "size": 8, "seed": seed}, "parameters": {
            "damping": {"path": "loads.damping", "low": 0.01, "high": 1.0, "scale": "log"},
            "g": {"path": "loads.gravity.0", "low": -1, "high": 1}}}  # fmt: skip
        told = client.post("/v1/ensembles", json=body).json()
        assert told["members"] == members
        return [one["values"] for one in client.get(told["links"]["members"]).json()["members"]]

    first, again, other = values(1), values(1), values(2)
    assert first == again != other
    logs = np.log10([one["damping"] for one in first])
    assert logs.min() >= -2.0 and logs.max() <= 0.0 and logs.min() < -1.5 and logs.max() > -0.5
    if method == "latin_hypercube":
        assert sorted(np.floor((logs + 2.0) * 4).astype(int)) == list(range(8))


def test_equal_members_are_one_job_and_what_has_run_is_not_run_again(client, case, registry, settings, run_all):
    body = {"case": case, "parameters": {"loads.damping": [0.1, 0.1, 0.2, 0.1]}}
    told = client.post("/v1/ensembles", json=body).json()
    assert (told["members"], told["jobs"], told["counts"]["accepted"]) == (4, 2, 4)
    run_all()
    again = client.post("/v1/ensembles", json=body | {"parameters": {"loads.damping": [0.2, 0.3]}}).json()
    assert (again["counts"]["successful"], again["counts"]["accepted"]) == (1, 1)
    whole = client.post("/v1/ensembles", json=body | {"reuse": False}).json()
    assert whole["counts"]["accepted"] == 4


def test_an_idempotency_key_gives_the_same_ensemble(client, grid):
    def submit(body):
        return client.post("/v1/ensembles", json=body, headers={"Idempotency-Key": "mine"})

    assert submit(grid).json()["id"] == submit(grid).json()["id"]
    assert problem(submit(grid | {"label": "x"})) == (422, "idempotency_key_reused")
    assert len(client.get("/v1/jobs").json()["jobs"]) == 6


def test_a_quota_refuses_all_or_none(client, grid, monkeypatch):
    submissions = client.app.state.parts.submissions
    monkeypatch.setattr(submissions, "terms", replace(submissions.terms, unfinished=5))
    assert problem(client.post("/v1/ensembles", json=grid)) == (429, "quota_reached")
    assert client.get("/v1/jobs").json()["jobs"] == [] and client.get("/v1/ensembles").json()["ensembles"] == []


RANGE = {"low": 0, "high": 1}


@pytest.mark.parametrize(("change", "pointer", "rule"), [
    ({"parameters": {}}, "/parameters", "is required"),
    ({"parameters": {"a": {"path": "loads.damping"}}}, "/parameters/a/values", "is required for a grid"),
    ({"parameters": {"a": RANGE}}, "/parameters/a/low", "needs a sample"),
    ({"parameters": {"a": RANGE | {"values": [1]}}}, "/parameters/a/low", "needs a sample"),
    ({"parameters": {"a": {"low": 1, "high": 0}}}, "/parameters/a/high", "must be > low"),
    ({"parameters": {"a": {"low": 1}}}, "/parameters/a/high", "both ends"),
    ({"parameters": {"a": RANGE | {"scale": "log"}}}, "/parameters/a/low", "must be > 0"),
    ({"parameters": {"loads.damping": [1] * 101, "t_end": [1] * 100}}, "/parameters", "at most 10,000 members"),
    ({"parameters": {"Tw": {"path": "loads.damping", "values": [1]}}}, "/parameters", "must not be named"),
    ({"parameters": {"a b": {"path": "loads.damping", "values": [1]}}}, "/parameters", "a letter first"),
    ({"parameters": {"a\n": {"path": "loads.damping", "values": [1]}}}, "/parameters", "a letter first"),
    ({"parameters": {"a": {"path": "t_end", "values": [1]}, "t_end": [2]}}, "/parameters", "once more: a is set"),
    ({"parameters": {}, "members": [{"loads.damping": 1, "loads": {}}]}, "/members", "once more: loads.damping is"),
    ({"parameters": {"loads.dampin": [1]}}, "/parameters", "member 0 (loads.dampin = 1): /loads/dampin"),
    ({"parameters": {"loads.damping": [1, -1]}}, "/parameters", "member 1 (loads.damping = -1): /loads/"),
    ({"sample": {"method": "sobol", "size": 7}, "parameters": {"a": RANGE}}, "/sample/size", "power of two"),
    ({"sample": {"method": "sobol", "size": 8}, "parameters": {"a": [1]}}, "/parameters/a/values", "low to high"),
    ({"sample": {"method": "guess", "size": 8}, "parameters": {"a": RANGE}}, "/sample/method", ""),
    ({"parameters": {}, "members": [{"t_end": 1}, {"u": 2}]}, "/members/1", "must name what the first one does"),
    ({"parameters": {"x": {"path": "t_end"}}, "members": [{"t_end": 1}]}, "/parameters/x", "named by each"),
    ({"case": "goyal"}, "/case", "must be one of"), ({"webhook": "https://a.b"}, "/webhook", ""),
])
def test_what_cannot_be_run_is_refused_where_it_stands(client, grid, change, pointer, rule):
    answer = client.post("/v1/ensembles", json=grid | change)
    assert problem(answer) == (422, "invalid_case"), answer.text
    [fault, *_] = answer.json()["errors"]
    assert fault["pointer"] == pointer and rule in fault["rule"]
    assert client.get("/v1/jobs").json()["jobs"] == []


def test_cancelling_ends_all_that_have_not_ended(client, grid, registry, settings):
    address = client.post("/v1/ensembles", json=grid).headers["location"]
    run_next(registry.database, settings)
    told = client.post(f"{address}/cancel").json()
    assert (told["counts"]["successful"], told["counts"]["dismissed"], told["status"]) == (1, 5, "dismissed")
    assert told["finished"] and told["progress"] == 1.0 and told["outcomes"] == {"completed": 1, "cancelled": 5}
    assert "retry-after" not in client.get(address).headers
    assert run_next(registry.database, settings) is False
    one = client.get(f"{address}/members?status=successful").json()["members"]
    assert [member["number"] for member in one] == [0]


def test_members_and_ensembles_come_in_pages(client, grid):
    ids = [client.post("/v1/ensembles", json=grid).json()["id"] for _ in range(3)]
    page = client.get("/v1/ensembles?limit=2").json()
    assert [one["id"] for one in page["ensembles"]] == ids[:0:-1]
    assert [one["id"] for one in client.get(page["next"]).json()["ensembles"]] == ids[:1]
    page = client.get(f"/v1/ensembles/{ids[0]}/members?limit=4").json()
    rest = client.get(page["next"]).json()
    assert [one["number"] for one in page["members"] + rest["members"]] == list(range(6)) and rest["next"] is None


@pytest.mark.parametrize("what", ["", "/members", "/events", "/scalars?variables=Tw", "/data?variables=Tw",
                                  "/sensitivity?variables=Tw"])
def test_an_unknown_ensemble_is_not_there(client, what):
    assert problem(client.get(f"/v1/ensembles/nobody{what}")) == (404, "unknown_ensemble")


def test_its_numbers_come_at_once_with_the_parameters(client, done, run_all):
    told = client.get(f"{done}/scalars?variables=energy_bending,Tw").json()["members"]
    assert [one["parameters"]["damping"] for one in told] == [c for c in DAMPING for _ in range(2)]
    for one in told:
        own = client.get(f"/v1/jobs/{one['job']}/data?variables=energy_bending").json()
        assert one["values"]["energy_bending"] == own["variables"]["energy_bending"]["values"][-1]
        assert (one["status"], one["outcome"]) == ("successful", "completed")
    table = pd.read_csv(io.BytesIO(client.get(f"{done}/scalars?variables=energy_bending&format=csv").content))
    assert list(table)[:3] == ["member", "damping", "gravity"] and len(table) == 6
    assert list(table["energy_bending"]) == [one["values"]["energy_bending"] for one in told]


def test_members_of_which_none_has_frames_are_no_dataset(client, grid):
    told = client.post("/v1/ensembles", json=grid).json()
    answer = client.get(told["links"]["data"] + "?variables=Tw&format=netcdf")
    assert (answer.status_code, answer.json()["type"]) == (409, "urn:hockle:problem:not_finished")
    assert told["id"] in answer.json()["detail"] and answer.headers["retry-after"]


def test_one_dataset_has_the_parameters_as_coordinates(client, done):
    together = dataset_of(client.get(f"{done}/data?variables=r,Tw&format=netcdf&time_stride=2").content)
    assert together.r.dims == ("member", "time", "s", "lab") and together.sizes["member"] == 6
    assert {"damping", "gravity"} <= set(together.coords)
    for one in client.get(f"{done}/members").json()["members"]:
        alone = dataset_of(client.get(f"/v1/jobs/{one['job']}/data?variables=r,Tw&format=netcdf&time_stride=2").content)
        member = together.isel(member=one["number"])
        assert float(member.damping) == one["values"]["damping"]
        assert np.array_equal(member.r, alone.r) and np.array_equal(member.Tw, alone.Tw)


def test_members_of_other_lengths_and_those_without_frames_are_filled_with_nan(client, case, registry, settings):
    body = {"case": case, "parameters": {"t_end": [0.03, 0.05]}}
    address = client.post("/v1/ensembles", json=body).headers["location"]
    run_next(registry.database, settings)
    both = dataset_of(client.get(f"{address}/data?variables=Tw,contacts&format=netcdf").content)
    assert both.sizes["time"] == 4 and both.Tw.isnull().sum(dim="time").values.tolist() == [0, 4]
    run_next(registry.database, settings)
    both = dataset_of(client.get(f"{address}/data?variables=Tw&format=netcdf").content)
    assert both.sizes["time"] == 6 and both.Tw.isnull().sum(dim="time").values.tolist() == [2, 0]


def test_a_table_of_members_counts_what_it_repeats(client, done, monkeypatch):
    monkeypatch.setitem(FORMATS, "csv", replace(FORMATS["csv"], limit=6 * 6 * 9 * 4 - 1))
    address = f"{done}/data?variables=r,Tw"
    assert problem(client.get(f"{address}&format=csv")) == (422, "subset_too_large")
    table = client.get(f"{address}&format=csv&t_min=0.01").text.splitlines()
    assert len(table) == 1 + 6 * 5 * 9 and table[0] == "member,damping,gravity,time,s,r_e1,r_e2,r_e3,Tw"


def test_what_holds_another_value_may_be_set_before_it(client, case):
    loads = [{"gravity": [0.0, 0.0, 0.0]}, {"damping": 0.5}]
    body = {"case": case, "parameters": {"loads": loads, "loads.damping": [0.1, 0.2]}}
    members = client.get(client.post("/v1/ensembles", json=body).headers["location"] + "/members").json()["members"]
    cases = [client.get(f"/v1/jobs/{one['job']}/case").json() for one in members]
    assert [one["loads"]["damping"] for one in cases] == [0.1, 0.2, 0.1, 0.2]


def test_too_much_at_once_is_refused(client, done, monkeypatch):
    monkeypatch.setitem(FORMATS, "json", replace(FORMATS["json"], limit=6 * 6 * 9 * 3 - 1))
    assert problem(client.get(f"{done}/data?variables=r")) == (422, "subset_too_large")
    assert client.get(f"{done}/data?variables=r&s_stride=2").status_code == 200


def test_a_member_that_was_deleted_has_nothing_more(client, done):
    [first, *_] = client.get(f"{done}/members").json()["members"]
    assert client.delete(first["links"]["job"]).status_code == 200
    told = client.get(f"{done}/scalars?variables=energy_bending").json()["members"]
    assert told[0]["values"]["energy_bending"] is None and told[1]["values"]["energy_bending"] is not None
    both = dataset_of(client.get(f"{done}/data?variables=energy_bending&format=netcdf").content)
    assert both.energy_bending.isnull().all("time").values.tolist() == [True] + [False] * 5


def events(client, address, **headers):
    answer = client.get(f"{address}/events", headers=headers)
    told = []
    for block in filter(None, answer.text.split("\n\n")):
        fields = dict(line.split(": ", 1) for line in block.splitlines())
        told.append((int(fields["id"]), fields["event"], json.loads(fields["data"])))
    return answer.status_code, told


def test_the_jobs_of_one_ensemble_are_listed_page_by_page(client, grid, case):
    client.post("/v1/jobs", json=case)
    ensemble = client.post("/v1/ensembles", json=grid).json()
    members = {member["job"] for member in client.get(ensemble["links"]["members"]).json()["members"]}
    address, listed = f"/v1/jobs?limit=2&ensemble={ensemble['id']}", []
    while address:
        page = client.get(address).json()
        listed += [job["id"] for job in page["jobs"]]
        address = page["next"]
    assert listed == sorted(members, reverse=True)
    assert client.get("/v1/jobs?ensemble=" + "0" * 26).json()["jobs"] == []
    refused = client.get("/v1/jobs?ensemble=first").json()
    assert refused["errors"][0]["parameter"] == "ensemble"


def test_one_stream_tells_of_all_members(client, done):
    status, told = events(client, done)
    assert status == 200
    assert [data["number"] for _, kind, data in told if kind == "member"] == list(range(6))
    number, kind, data = told[-1]
    assert (kind, data["status"], data["counts"]["successful"]) == ("progress", "successful", 6)
    assert events(client, done, **{"Last-Event-ID": str(number)})[0] == 204


def test_the_stream_follows_as_it_happens(client, grid, registry, settings):
    address = client.post("/v1/ensembles", json=grid).headers["location"]
    with ThreadPoolExecutor() as reader:
        reading = reader.submit(events, client, address)
        for _ in range(6):
            run_next(registry.database, settings)
        _, told = reading.result()
    last = {data["number"]: data["status"] for _, kind, data in told if kind == "member"}
    assert last == dict.fromkeys(range(6), "successful") and told[-1][2]["status"] == "successful"
    assert [number for number, _, _ in told] == sorted(number for number, _, _ in told)


def test_sobol_indices_tell_which_parameter_matters(client, case, registry, run_all):
    body = {"case": case, "sample": {"method": "saltelli", "size": 16}, "parameters": {
        "strong": {"path": "loads.gravity.0", "low": 1.0, "high": 10.0},
        "weak": {"path": "loads.damping", "low": 0.1, "high": 0.11}}}  # fmt: skip
    told = client.post("/v1/ensembles", json=body).json()
    address = told["links"]["sensitivity"] + "?variables=energy_potential"
    assert problem(client.get(address)) == (409, "values_missing")
    run_all()
    indices = client.get(address).json()["indices"]["energy_potential"]
    assert list(indices) == ["strong", "weak"]
    told = indices["strong"]
    assert abs(told["total"] - 1.0) <= told["total_confidence"] and indices["weak"]["total"] < 0.01
    other = client.post("/v1/ensembles", json={"case": case, "parameters": {"loads.damping": [1]}}).json()
    assert problem(client.get(f"/v1/ensembles/{other['id']}/sensitivity?variables=Tw")) == (422, "no_saltelli_sample")


def test_statuses_are_those_of_jobs(client, grid):
    assert set(client.post("/v1/ensembles", json=grid).json()["counts"]) == {str(status) for status in Status}


@pytest.mark.parametrize("design", [
    {"members": [{"loads.damping": float(i)} for i in range(1000)]},
    {"parameters": {"loads.damping": list(range(1000))}},
    {"parameters": {"loads.damping": list(range(50)), "t_end": [0.04, 0.05] * 10}},
    {"parameters": {"loads.damping": {"low": 0.0, "high": 1.0}}, "sample": {"method": "latin_hypercube", "size": 1000}},
])  # fmt: skip
def test_cases_that_are_too_large_in_all_are_refused_before_they_are_made(client, case, monkeypatch, design):
    table = {"s": [i * 1e-5 for i in range(5000)], "value": [0.0] * 5000}
    large = case | {"loads": {"distributed": [{"force": [table, 0.0, 0.0]}] * 3}}
    monkeypatch.setattr("service.api.designs.parse_case", lambda _: pytest.fail("it was made"))
    answer = client.post("/v1/ensembles", json={"case": large, **design})
    assert problem(answer) == (422, "invalid_case")
    assert "must make cases of at most 100,000,000 bytes in all" in answer.json()["detail"]


def test_a_table_that_members_differ_in_counts_too(client, case, monkeypatch):
    tables = [[{"s": [0.0, 1.0], "value": [float(i)] * n} for n in (2, 20_000)] for i in range(4)]
    monkeypatch.setattr("service.api.designs.parse_case", lambda _: pytest.fail("it was made"))
    parameters = {f"p{i}": {"path": f"loads.distributed.{i}", "values": told} for i, told in enumerate(tables)}
    parameters["damping"] = {"path": "loads.damping", "values": list(range(200))}
    answer = client.post("/v1/ensembles", json={"case": case, "parameters": parameters})
    assert "bytes in all" in answer.json()["detail"]
