"""Reading results by job id: the file with ranges and validators, and a part as JSON."""

from __future__ import annotations

import hashlib
from dataclasses import replace
from pathlib import Path

import pytest

from service.results import bucket
from service.results.formats import FORMATS
from service.settings import Settings


@pytest.fixture(params=["files", "objects"])
def settings(tmp_path: Path, tables: None, request: pytest.FixtureRequest) -> Settings:
    """Where datasets lie makes no difference to who reads them."""
    return Settings(data=tmp_path, objects=request.getfixturevalue("objects") if request.param == "objects" else "")


@pytest.fixture
def address(done: str) -> str:
    return f"/v1/jobs/{done}/dataset"


def test_the_file_comes_whole_with_its_hash_as_etag(client, address):
    answer = client.get(address)
    assert answer.status_code == 200
    assert answer.headers["etag"] == f'"{hashlib.sha256(answer.content).hexdigest()}"'
    assert answer.headers["content-type"] == "application/x-netcdf"
    assert answer.content[:4] == b"\x89HDF"


def test_head_tells_the_size_without_the_content(client, address):
    answer = client.head(address)
    assert (answer.status_code, answer.content) == (200, b"")
    assert int(answer.headers["content-length"]) == len(client.get(address).content)
    assert answer.headers["accept-ranges"] == "bytes"


@pytest.mark.parametrize(("told", "part"), [
    ("bytes=0-9", slice(0, 10)), ("bytes=100-", slice(100, None)), ("bytes=-50", slice(-50, None)),
])
def test_a_range_gives_exactly_those_bytes(client, address, told, part):
    answer = client.get(address, headers={"Range": told})
    assert answer.status_code == 206
    assert answer.content == client.get(address).content[part]


def test_a_range_that_begins_behind_the_end_is_a_problem(client, address):
    answer = client.get(address, headers={"Range": "bytes=99999999-"})
    assert answer.status_code == 416
    assert answer.headers["content-type"] == "application/problem+json"
    assert answer.headers["content-range"].startswith("bytes */")


@pytest.mark.parametrize("told", ["lines=1-2", "bytes=", "bytes=b-a", "bytes=9-3"])
def test_a_range_that_is_none_is_ignored(client, address, told):
    assert client.get(address, headers={"Range": told}).status_code == 200


def test_a_range_of_another_file_gives_the_whole(client, address):
    etag = client.head(address).headers["etag"]
    same = client.get(address, headers={"Range": "bytes=0-9", "If-Range": etag})
    other = client.get(address, headers={"Range": "bytes=0-9", "If-Range": '"other"'})
    assert (same.status_code, other.status_code) == (206, 200)


@pytest.mark.parametrize("method", ["GET", "HEAD"])
def test_a_client_that_has_the_file_is_not_sent_it_again(client, address, method):
    etag = client.head(address).headers["etag"]
    answer = client.request(method, address, headers={"If-None-Match": etag, "Range": "bytes=0-9"})
    assert (answer.status_code, answer.content, answer.headers["etag"]) == (304, b"", etag)


def test_a_part_is_given_as_json_with_units(client, done):
    answer = client.get(f"/v1/jobs/{done}/data", params={"variables": "Tw, r", "t_min": 0.02, "s_stride": 4})
    told = answer.json()
    assert told["variables"]["Tw"]["units"] == "turn"
    times = told["coordinates"]["time"]["values"]
    assert times == pytest.approx([0.02, 0.03, 0.04, 0.05])
    assert len(told["variables"]["r"]["values"]) == len(times)
    assert len(told["variables"]["r"]["values"][0]) == 3


@pytest.mark.parametrize(("query", "name"), [
    ("variables=Q", "unknown_variable"),
    ("variables=Tw&t_min=nan", "invalid_parameters"),
    ("variables=Tw&s_stride=0", "invalid_parameters"),
    ("variables=Tw&stride=2", "invalid_parameters"),
    ("", "invalid_parameters"),
])
def test_a_part_that_cannot_be_given_is_refused_by_name(client, done, query, name):
    answer = client.get(f"/v1/jobs/{done}/data?{query}")
    assert answer.status_code == 422
    assert answer.json()["type"].endswith(name)


@pytest.mark.parametrize(("address", "wrong", "meant"), [
    ("jobs/{}/data?variables=", "R", "r"), ("jobs/{}/data?variables=", "tw", "Tw"),
    ("jobs/{}/opendap.dods?", "omga", "omega"), ("scalars?jobs={}&variables=", "energy_bend", "energy_bending"),
])  # fmt: skip
def test_an_unknown_variable_is_told_what_it_may_have_been_meant_to_be(client, done, address, wrong, meant):
    answer = client.get("/v1/" + address.format(done) + wrong)
    assert (answer.status_code, answer.json()["type"]) == (422, "urn:hockle:problem:unknown_variable")
    assert answer.json()["detail"].endswith(f"got {wrong!r}: did you mean {meant}?")


def test_a_part_too_large_is_refused_before_it_is_read(client, done, monkeypatch):
    monkeypatch.setitem(FORMATS, "json", replace(FORMATS["json"], limit=3))
    answer = client.get(f"/v1/jobs/{done}/data?variables=r")
    assert (answer.status_code, answer.json()["type"]) == (422, "urn:hockle:problem:subset_too_large")
    assert "stride" in answer.json()["detail"]


@pytest.mark.parametrize("what", ["dataset", "data?variables=Tw"])
def test_a_job_that_has_not_ended_has_no_results_yet(client, case, what):
    address = client.post("/v1/jobs", json=case).headers["location"]
    answer = client.get(f"{address}/{what}")
    assert (answer.status_code, answer.json()["type"]) == (409, "urn:hockle:problem:not_finished")
    assert "retry-after" in answer.headers
    assert ("its dataset comes at its end" if what == "dataset" else "its first frames") in answer.json()["detail"]


@pytest.mark.parametrize("what", ["dataset", "data?variables=Tw"])
def test_a_cancelled_job_has_no_results_ever(client, case, what):
    address = client.post("/v1/jobs", json=case).headers["location"]
    client.delete(address)
    answer = client.get(f"{address}/{what}")
    assert (answer.status_code, answer.json()["type"]) == (404, "urn:hockle:problem:no_dataset")


@pytest.mark.parametrize("what", ["dataset", "data?variables=Tw"])
def test_a_dataset_that_somebody_removed_is_a_problem_not_a_crash(client, registry, done, what):
    client.app.state.parts.datasets.discard(registry.get(done).dataset.file)
    answer = client.get(f"/v1/jobs/{done}/{what}")
    assert (answer.status_code, answer.json()["type"]) == (404, "urn:hockle:problem:dataset_lost")


@pytest.mark.parametrize("what", ["dataset", "data?variables=Tw"])
@pytest.mark.parametrize("settings", ["objects"], indirect=True)
def test_an_object_store_that_does_not_answer_is_told_and_asked_again(client, done, monkeypatch, what):
    with monkeypatch.context() as away:
        away.setenv("AWS_ENDPOINT_URL", "http://127.0.0.1:9")
        bucket.client.cache_clear()
        answer = client.get(f"/v1/jobs/{done}/{what}")
    assert (answer.status_code, answer.json()["type"]) == (503, "urn:hockle:problem:store_unreachable")
    assert "retry-after" in answer.headers
    assert "127.0.0.1" not in answer.text
    bucket.client.cache_clear()
    assert client.get(f"/v1/jobs/{done}/{what}").status_code == 200
