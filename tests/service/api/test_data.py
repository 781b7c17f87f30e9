"""/v1/jobs/{id}/data in each format, read by who reads it, and while the job runs."""

from __future__ import annotations

import io
from dataclasses import replace

import netCDF4
import numpy as np
import pandas as pd
import pytest
import xarray as xr

from service.results.formats import FORMATS
from worker import shown, stopping
from worker.run import run_next


def part(client, job_id, format, variables="Tw,r,contacts", **query):
    answer = client.get(f"/v1/jobs/{job_id}/data", params={"variables": variables, "format": format, **query})
    assert answer.status_code == 200, answer.text
    assert answer.headers["content-type"].partition(";")[0] == FORMATS[format].media_type
    return answer.content


def test_csv_is_a_table_with_all_digits(client, done, whole):
    table = pd.read_csv(io.BytesIO(part(client, done, "csv", t_min=0.02)))
    assert list(table) == ["time", "s", "Tw", "r_e1", "r_e2", "r_e3", "contacts"]
    expected = whole[["Tw", "r"]].sel(time=slice(0.02, None))
    assert np.array_equal(table["r_e3"], expected.r.sel(lab="e3").values.ravel())
    assert np.array_equal(table["Tw"], np.repeat(expected.Tw.values, whole.sizes["s"]))


def test_what_has_no_number_is_empty_in_csv(client, done):
    lines = part(client, done, "csv", "min_gap").decode().splitlines()
    assert lines[0] == "time,min_gap" and lines[1] == "0.0,"


def test_arrow_is_read_by_polars_with_the_same_bits(client, done, whole):
    polars = pytest.importorskip("polars")
    table = polars.read_ipc_stream(io.BytesIO(part(client, done, "arrow")))
    assert table.columns == ["time", "s", "Tw", "r_e1", "r_e2", "r_e3", "contacts"]
    assert np.array_equal(table["r_e1"].to_numpy(), whole.r.sel(lab="e1").values.ravel())
    assert table["contacts"].dtype == polars.Int32


def test_arrow_tells_the_units_to_pyarrow(client, done):
    ipc = pytest.importorskip("pyarrow.ipc")
    schema = ipc.open_stream(part(client, done, "arrow")).schema
    assert schema.field("r_e1").metadata[b"units"] == b"m"
    assert schema.metadata[b"job"] == done.encode()


def test_netcdf_is_the_same_part_of_the_dataset(client, done, whole, tmp_path):
    (tmp_path / "part.nc").write_bytes(part(client, done, "netcdf", time_stride=2, s_stride=4))
    with xr.open_dataset(tmp_path / "part.nc") as told:
        expected = whole[["Tw", "r", "contacts"]].isel(time=slice(None, None, 2), s=slice(None, None, 4))
        xr.testing.assert_equal(told, expected)
        assert told.r.attrs["units"] == "m" and told.attrs["status"] == "successful"
        assert list(told.lab.values) == ["e1", "e2", "e3"]


@pytest.mark.parametrize(("accept", "format"), [
    ("text/csv", "csv"), ("application/x-netcdf", "netcdf"), ("application/netcdf", "netcdf"),
    ("text/html, application/vnd.apache.arrow.stream;q=0.9", "arrow"), ("*/*", "json"), ("image/png", "json"),
    ("text/csv;q=0.1, application/json", "json"), ("application/json;q=0.2, application/x-netcdf", "netcdf"),
    ("text/*", "csv"), ("text/csv;q=0", "json"), ("application/json;q=0, */*;q=0.1", "csv"), ("", "json"),
    ("*/*, text/csv", "csv"), ("text/*;q=0.9, text/csv;q=0.1, application/json;q=0.5", "json"),
    ("TEXT/CSV ; Q=1.", "csv"), ("text/csv;q=nan", "csv"),
    ("text/csv;header=present;q=0.3, application/netcdf;q=0.31", "netcdf"),
])
def test_the_accept_header_chooses_where_the_query_does_not(client, done, accept, format):
    address = f"/v1/jobs/{done}/data?variables=Tw"
    answer = client.get(address, headers={"Accept": accept})
    assert answer.headers["content-type"].partition(";")[0] == FORMATS[format].media_type
    assert client.get(address + "&format=json", headers={"Accept": accept}).json()["variables"]["Tw"]


@pytest.mark.parametrize("query", [
    "/v1/jobs/{done}/data?variables=Tw&variables=Wr", "/v1/jobs?status=failed&status=failed",
    "/v1/scalars?jobs={done}&jobs=other&variables=Tw",
])
def test_a_parameter_that_is_repeated_is_refused_and_not_passed_over(client, done, query):
    answer = client.get(query.format(done=done))
    assert answer.status_code == 422, answer.text
    [fault] = answer.json()["errors"]
    assert fault["parameter"] in query and len(fault["value"]) == 2 and "must come once" in fault["rule"]


def test_a_table_counts_what_it_repeats(client, done, monkeypatch):
    monkeypatch.setitem(FORMATS, "csv", replace(FORMATS["csv"], limit=6 * 9 * 4 - 1))
    monkeypatch.setitem(FORMATS, "json", replace(FORMATS["json"], limit=6 * 9 * 3 + 6))
    address = f"/v1/jobs/{done}/data?variables=r,Tw"
    assert client.get(address).status_code == 200
    answer = client.get(address + "&format=csv")
    assert (answer.status_code, answer.json()["type"]) == (422, "urn:hockle:problem:subset_too_large")


def test_a_running_job_shows_its_frames_with_the_bits_of_the_dataset(client, registry, settings, case, monkeypatch):
    monkeypatch.setattr(shown, "FRESH", 0.0)
    monkeypatch.setattr(shown, "SHARE", np.inf)
    job_id = client.post("/v1/jobs", json=case).json()["id"]
    address = f"/v1/jobs/{job_id}/data?variables=r,Tw,contacts&time_stride=2"
    seen = []

    def look() -> None:
        answer = client.get(address)
        if answer.status_code == 200:
            assert (answer.headers["job-status"], answer.headers["cache-control"]) == ("running", "no-store")
            seen.append(answer.json())

    assert client.get(address).json()["type"] == "urn:hockle:problem:not_finished"
    monkeypatch.setattr(stopping, "check", look)
    run_next(registry.database, settings)
    final = client.get(address)
    assert final.headers["job-status"] == "successful"
    final = final.json()
    lengths = [len(part["coordinates"]["time"]["values"]) for part in seen]
    assert lengths == sorted(lengths) and lengths[-1] >= 2
    for part in seen:
        many = len(part["coordinates"]["time"]["values"])
        for name, told in part["variables"].items():
            assert told["values"] == final["variables"][name]["values"][:many]
        assert part["coordinates"]["s"] == final["coordinates"]["s"]


def test_a_job_that_was_handed_back_shows_its_frames_and_goes_on_from_them(
    client, registry, settings, case, monkeypatch
):
    monkeypatch.setattr(shown, "FRESH", 0.0)
    monkeypatch.setattr(shown, "SHARE", np.inf)
    job_id = client.post("/v1/jobs", json=case).json()["id"]
    address = f"/v1/jobs/{job_id}/data?variables=Tw"

    def stop_after_some() -> None:
        if registry.get(job_id).status == "running" and client.get(address).status_code == 200:
            raise stopping.Stopping

    with monkeypatch.context() as stopped:
        stopped.setattr(stopping, "check", stop_after_some)
        run_next(registry.database, settings)
    answer = client.get(address)
    assert answer.headers["job-status"] == "accepted"
    many = len(answer.json()["variables"]["Tw"]["values"])
    run_next(registry.database, settings)
    final = client.get(address).json()["variables"]["Tw"]["values"]
    assert 0 < many < len(final) and final[:many] == answer.json()["variables"]["Tw"]["values"]


def test_scalars_of_many_jobs_are_a_table_too(client, done, case):
    waiting = client.post("/v1/jobs", json={**case, "t_end": 0.04}).json()["id"]
    query = {"jobs": f"{done},{waiting}", "variables": "Tw,energy_bending", "format": "csv"}
    table = pd.read_csv(io.BytesIO(client.get("/v1/scalars", params=query).content))
    assert list(table) == ["id", "label", "status", "outcome", "t", "Tw", "energy_bending"]
    assert list(table["status"]) == ["successful", "accepted"]
    told = client.get("/v1/scalars", params=query | {"format": "json"}).json()["jobs"][0]["values"]
    assert table["energy_bending"][0] == told["energy_bending"] and np.isnan(table["Tw"][1])
    netcdf = client.get("/v1/scalars", params=query | {"format": "netcdf"}).content
    with netCDF4.Dataset("x", memory=netcdf) as file:
        assert list(file["id"][:]) == [done, waiting] and file["energy_bending"].dimensions == ("job",)
