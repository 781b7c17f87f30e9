"""Datasets read by the programs that other labs have: ncdump, R, Octave and curl. Who lacks one skips it."""

from __future__ import annotations

import os
import shutil
import subprocess

import numpy as np
import pytest

NCDUMP = ["ncdump", "-p", "9,17", "-v", "Tw", "{}"]
R = ["Rscript", "-e", "library(ncdf4); f <- nc_open('{}'); cat('values', sprintf('%.17g', ncvar_get(f, 'Tw')));"
     "cat(' units', ncatt_get(f, 'Tw', 'units')$value, dim(ncvar_get(f, 'r')))"]  # fmt: skip
OCTAVE = ["octave", "--no-gui", "--quiet", "--eval",
          "pkg load netcdf; printf('values'); printf(' %.17g', ncread('{0}', 'Tw'));"
          "printf(' units %s', ncreadatt('{0}', 'Tw', 'units')); printf(' %d', size(ncread('{0}', 'r')))"]  # fmt: skip


def run(command: list[str], source: str) -> str:
    """What a program prints; it is skipped, by its name, where it or its NetCDF is not installed."""
    if shutil.which(command[0]) is None:
        pytest.skip(f"{command[0]} is not installed")
    environment = os.environ | {"LC_ALL": "C.UTF-8"}
    told = subprocess.run([part.replace("{}", source).replace("{0}", source) for part in command], text=True,
                          capture_output=True, check=False, timeout=120, env=environment)  # fmt: skip
    if "there is no package" in told.stderr or "could not be found" in told.stderr:
        pytest.skip(f"{command[0]} has no package that reads NetCDF")
    assert told.returncode == 0, told.stderr
    return told.stdout


@pytest.fixture(params=["file", "OPeNDAP", "link"])
def source(request, client, address, done, tmp_path) -> str:
    """A dataset as a file, where it is, and by a link (whose `#mode=bytes` the library of Debian 12 does not know)."""
    if request.param == "OPeNDAP":
        return f"{address}/v1/jobs/{done}/opendap"
    link = client.post(f"/v1/jobs/{done}/links", json={}).json()
    if request.param == "link":
        return address + link["opendap"]
    (tmp_path / "run.nc").write_bytes(client.get(link["href"]).content)
    return str(tmp_path / "run.nc")


def test_ncdump_reads_it(source, whole):
    told = run(NCDUMP, source)
    assert 'Tw:units = "turn"' in told and "double r(time, s, lab)" in told.replace("  ", " ")
    values = told.partition(" Tw =")[2].partition(";")[0].split(",")
    assert np.array_equal([float(one) for one in values], whole.Tw)


@pytest.mark.parametrize("program", [R, OCTAVE], ids=["R", "Octave"])
def test_r_and_octave_read_it(source, whole, program):
    values, _, more = run(program, source).partition("values")[2].partition("units")
    assert np.array_equal([float(one) for one in values.split()], whole.Tw)
    assert more.split() == ["turn", *map(str, reversed(whole.r.shape))]  # their first index runs fastest


def test_curl_gets_a_table_and_a_range_of_bytes(address, client, done):
    table = run(["curl", "-sSf", "-H", "Accept: text/csv", "{}"], f"{address}/v1/jobs/{done}/data?variables=Tw")
    assert table.startswith("time,Tw\n0.0,")
    assert run(["curl", "-sSf", "-r", "1-3", "{}"], f"{address}/v1/jobs/{done}/dataset") == "HDF"
