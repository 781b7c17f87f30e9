"""Datasets opened where they are, by the programs that know how: Zarr and OPeNDAP."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr


def problem(answer):
    return answer.status_code, answer.json()["type"].removeprefix("urn:hockle:problem:")


@pytest.mark.filterwarnings("ignore::zarr.errors.UnstableSpecificationWarning")
def test_xarray_opens_a_zarr_store_lazily_with_the_same_values(address, done, whole, monkeypatch):
    pytest.importorskip("zarr")
    from service.results import query

    read = []
    before = query.DatasetSource.read
    monkeypatch.setattr(query.DatasetSource, "read", lambda self, variable, ranges: (
        read.append(variable.name), before(self, variable, ranges))[1])
    with xr.open_zarr(f"{address}/v1/jobs/{done}/zarr") as remote:
        assert set(remote.data_vars) == set(whole.data_vars) and remote.attrs["case"] == whole.attrs["case"]
        assert read == []
        assert np.array_equal(remote.r.isel(time=-1), whole.r.isel(time=-1)) and set(read) == {"r"}
        xr.testing.assert_equal(remote.load(), whole)
        assert remote.r.attrs["units"] == "m" and list(remote.lab.values) == ["e1", "e2", "e3"]


@pytest.mark.filterwarnings("ignore::zarr.errors.UnstableSpecificationWarning")
def test_a_link_opens_the_zarr_store_too_until_it_is_revoked(address, client, done, whole):
    pytest.importorskip("zarr")
    link = client.post(f"/v1/jobs/{done}/links", json={}).json()
    with xr.open_zarr(f"{address}{link['zarr']}") as remote:
        xr.testing.assert_equal(remote.load(), whole)
    assert problem(client.get(f"{link['zarr']}/r/c/9/0/0")) == (404, "no_such_key")
    client.delete(f"/v1/jobs/{done}/links/{link['id']}")
    assert problem(client.get(f"{link['zarr']}/zarr.json")) == (404, "link_not_good")


@pytest.mark.filterwarnings("ignore::zarr.errors.UnstableSpecificationWarning")
def test_chunks_are_of_some_frames_and_the_last_one_is_filled_up(address, done, whole, monkeypatch):
    zarr = pytest.importorskip("zarr")
    from service.results import zarr as ours

    monkeypatch.setattr(ours, "CHUNK_BYTES", 4 * 8 * 3 * whole.sizes["s"])
    r = zarr.open_group(f"{address}/v1/jobs/{done}/zarr", mode="r")["r"]
    assert r.chunks == (4, whole.sizes["s"], 3) and r.shape == whole.r.shape
    assert np.array_equal(r[:], whole.r) and np.array_equal(r[5], whole.r[5])


@pytest.mark.parametrize("key", ["", ".zgroup", "r", "r/c/9/0/0", "r/c/0/1/0", "r/c/0", "nothing/zarr.json", "r/c/x"])
def test_a_key_that_is_not_there_is_not_found(client, done, key):
    assert client.get(f"/v1/jobs/{done}/zarr/{key}").status_code == 404


@pytest.mark.parametrize("what", ["zarr/zarr.json", "opendap.dds", "opendap.das", "opendap.dods"])
def test_a_job_without_a_dataset_says_so(client, case, what):
    address = client.post("/v1/jobs", json=case).headers["location"]
    assert problem(client.get(f"{address}/{what}")) == (409, "not_finished")
    assert problem(client.get(f"/v1/jobs/nobody/{what}")) == (404, "unknown_job")


def test_xarray_opens_it_by_opendap_with_the_same_values(address, done, whole):
    with xr.open_dataset(f"{address}/v1/jobs/{done}/opendap") as remote:
        assert set(remote.data_vars) == set(whole.data_vars)
        assert np.array_equal(remote.r.isel(time=slice(1, None, 2), s=-1), whole.r.isel(time=slice(1, None, 2), s=-1))
        for name in ("Tw", "contacts", "orientation", "min_gap"):
            assert np.array_equal(remote[name], whole[name], equal_nan=True) and remote[name].dtype == whole[name].dtype
        assert remote.r.attrs == {name: whole.r.attrs[name] for name in ("units", "long_name")}
        assert remote.attrs["case"] == whole.attrs["case"] and remote.attrs["outcome"] == "completed"
        assert np.array_equal(remote.time, whole.time)


def test_pydap_reads_a_part(address, done, whole):
    client = pytest.importorskip("pydap.client")
    remote = client.open_url(f"{address}/v1/jobs/{done}/opendap", protocol="dap2")
    assert np.array_equal(np.asarray(remote["r"][1:3, 2:5, 0:2]), whole.r[1:3, 2:5, 0:2])


@pytest.mark.parametrize(("constraint", "expected"), [
    ("Q", (422, "unknown_variable")), ("r[0]", (422, "bad_constraint")), ("Tw[0:1:99]", (422, "bad_constraint")),
    ("Tw[2:1:1]", (422, "bad_constraint")), ("Tw[0:0:1]", (422, "bad_constraint")), ("r;x", (422, "bad_constraint")),
])
def test_a_constraint_that_asks_for_nothing_is_refused(client, done, constraint, expected):
    assert problem(client.get(f"/v1/jobs/{done}/opendap.dods?{constraint}")) == expected


def test_too_much_at_once_is_refused_before_it_is_read(client, done, monkeypatch):
    from service.results import opendap

    monkeypatch.setattr(opendap, "LIMIT", 5)
    assert problem(client.get(f"/v1/jobs/{done}/opendap.dods?Tw")) == (422, "subset_too_large")
    assert client.get(f"/v1/jobs/{done}/opendap.dods?Tw[0:2:4]").status_code == 200


def test_h5py_reads_the_file(client, done, whole, tmp_path):
    h5py = pytest.importorskip("h5py")
    (tmp_path / "x.nc").write_bytes(client.get(f"/v1/jobs/{done}/dataset").content)
    with h5py.File(tmp_path / "x.nc") as file:
        assert np.array_equal(file["r"][:], whole.r) and file["r"].attrs["units"] in ("m", b"m")
