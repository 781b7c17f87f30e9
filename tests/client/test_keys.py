"""Where keys are required: with a key the client does all; with a link others read one dataset, whatever they use."""

from __future__ import annotations

import shutil
import subprocess
import urllib.request

import netCDF4
import numpy as np
import pytest
import xarray as xr

from hockle.cli import main
from hockle_client import Client, Problem
from tests.hockle.conftest import serving


@pytest.fixture(scope="module")
def keyed(tmp_path_factory):
    """The address of a server that wants keys, and the key of an owner."""
    data = tmp_path_factory.mktemp("keyed")
    with pytest.MonkeyPatch.context() as patch:
        told: list[str] = []
        patch.setattr("builtins.print", lambda *what, **_: told.extend(map(str, what)))
        assert main(["keys", "create", "alice", "--data", str(data)]) == 0
    with serving(data, HOCKLE_REQUIRE_KEYS="1") as server:
        assert server.address
        yield server.address, told[0]


@pytest.fixture
def job(keyed, connect, quick):
    return connect(*keyed).submit(quick).wait()


def test_nothing_goes_without_the_key(keyed, connect, job, monkeypatch):
    monkeypatch.delenv("HOCKLE_KEY", raising=False)
    with pytest.raises(Problem) as refused:
        connect(keyed[0]).job(job.id)
    assert (refused.value.status, refused.value.name) == (401, "not_authenticated")
    monkeypatch.setenv("HOCKLE_KEY", keyed[1])
    monkeypatch.setenv("HOCKLE_SERVER", keyed[0])
    assert connect().job(job.id).status == "successful"


def test_the_key_is_in_no_message(keyed, connect, job):
    client = connect(*keyed)
    told = [repr(client), repr(vars(getattr(client, "inner", client))), repr(job.state)]
    with pytest.raises(Problem) as refused:
        client.job("0" * 26)
    assert not any(keyed[1] in text for text in [*told, str(refused.value), repr(refused.value.document)])


def test_an_opened_address_needs_a_link_where_a_key_is_required(keyed, job):
    with pytest.raises(OSError):
        xr.open_dataset(f"{keyed[0]}{job.state.dataset.href}#mode=bytes", engine="netcdf4")
    with job.dataset() as whole, xr.open_dataset(job.link().url + "#mode=bytes") as remote:
        xr.testing.assert_identical(remote.load(), whole.load())


def test_a_link_is_read_by_netcdf4_urllib_and_curl(job, tmp_path):
    url = job.link(seconds=60).url
    with netCDF4.Dataset(url + "#mode=bytes") as remote, urllib.request.urlopen(url) as answer:
        (tmp_path / "x.nc").write_bytes(answer.read())
        with netCDF4.Dataset(tmp_path / "x.nc") as fetched:
            assert np.array_equal(remote["Wr"][:], fetched["Wr"][:])
    if curl := shutil.which("curl"):
        subprocess.run([curl, "-sf", "-r", "0-99", "-o", str(tmp_path / "part"), url], check=True)
        assert (tmp_path / "part").read_bytes() == (tmp_path / "x.nc").read_bytes()[:100]


def test_a_link_is_read_by_another_owner_without_a_key(keyed, job):
    url = job.link(seconds=60).url
    with Client(keyed[0], "hk_0123456789ab_" + "x" * 43, patience=0) as nobody, pytest.raises(Problem):
        nobody.job(job.id)
    with xr.open_dataset(url + "#mode=bytes") as remote:
        assert remote.sizes["time"] == 4
