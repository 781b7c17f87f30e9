"""A sweep through the client, in both of its kinds: handed in, waited for, read as one."""

from __future__ import annotations

import secrets

import numpy as np
import pandas as pd
import polars as pl
import pytest

from hockle_client import Problem, Range

SHORT = {"t_end": 0.05, "output.interval": 0.01, "numerics.intervals": 8, "loads.gravity": [0.0, 0.0, 0.0]}


@pytest.fixture
def settings() -> dict:
    """Of a case that nobody has run before."""
    return {**SHORT, "description": secrets.token_hex()}


def test_a_grid_is_one_table_and_one_dataset(client, settings, capsys):
    damping = np.linspace(0.0, 1.0, 3)
    sweep = client.sweep("cantilever-vibration", {"loads.damping": damping, "loads.gravity.0": [0, -1]}, set=settings,
                         label="grid")  # fmt: skip
    assert sweep.state.members == 6 and sweep.state.label == "grid"
    assert sweep.wait(progress=True).status == "successful"
    assert "6 of 6 jobs have ended" in capsys.readouterr().err
    table = sweep.table("energy_bending", "Tw")
    assert list(table.index) == list(range(6)) and list(table["loads.damping"]) == list(np.repeat(damping, 2))
    whole = sweep.dataset("energy_bending", "r", s_stride=4)
    assert whole.r.dims == ("member", "time", "s", "lab")
    assert np.array_equal(whole.energy_bending.isel(time=-1), table["energy_bending"])
    assert sweep.csv("Tw").startswith("member,loads.damping,loads.gravity.0,id,label,status,outcome,t,Tw\n0,0.0,0.0,")
    grid = whole.set_index(member=["loads.damping", "loads.gravity.0"]).unstack("member")
    assert grid.r.sizes["loads.damping"] == 3 and grid.r.sizes["loads.gravity.0"] == 2
    member = list(sweep.members(status="successful"))[4]
    job = client.job(member.job)
    assert np.array_equal(job.data("r", s_stride=4).r, whole.r.isel(member=4))
    assert client.ensemble(sweep.id).state == sweep.refresh().state
    assert sweep.id in [one.id for one in client.ensembles()]


@pytest.mark.parametrize("table", [pd.DataFrame, pl.DataFrame])
def test_the_rows_of_a_table_are_members(client, settings, table):
    damping, intervals = [0.5, 0.25], [8, 10]
    rows = table({"loads.damping": damping, "numerics.intervals": intervals})
    sweep = client.sweep("cantilever-vibration", members=rows, set=settings)
    assert [member.values for member in sweep.members()] == [
        {"loads.damping": one, "numerics.intervals": many} for one, many in zip(damping, intervals, strict=True)]
    assert client.sweep("cantilever-vibration", {"t_end": [0.02]}, members=table(), set=settings).state.members == 1


@pytest.mark.parametrize("values", [range(8, 12, 2), pd.Series([8, 10]), pl.Series([8, 10]), np.array([8, 10])])
def test_values_may_be_of_any_kind_of_list(client, settings, values):
    sweep = client.sweep("cantilever-vibration", {"numerics.intervals": values}, set=settings)
    assert [member.values["numerics.intervals"] for member in sweep.members()] == [8, 10]


def test_events_tell_of_all_members_to_the_end(client, settings):
    sweep = client.sweep("cantilever-vibration", members=[{"t_end": 0.04}, {"t_end": 0.05}], set=settings)
    events = list(sweep.events())
    last = {event.data["number"]: event.data["status"] for event in events if event.kind == "member"}
    assert last == {0: "successful", 1: "successful"}
    assert events[-1].kind == "progress" and events[-1].data["status"] == "successful"


def test_a_sample_tells_what_matters(client, settings):
    ranges = {"strong": {"path": "loads.gravity.0", "low": 1.0, "high": 9.0}, "loads.damping": Range(0.1, 0.11, "log")}
    sweep = client.sweep("cantilever-vibration", ranges, sample="saltelli", size=8, seed=1, set=settings).wait()
    told = sweep.sensitivity("energy_potential")["energy_potential"]
    assert told["strong"].total > 0.5 > 0.01 > told["loads.damping"].total


def test_it_is_cancelled_as_one(client, settings):
    slow = {**settings, "t_end": 5.0, "output.interval": 0.1, "numerics.dt_max": 0.0005}
    sweep = client.sweep("cantilever-vibration", {"loads.damping": [0.1, 0.2, 0.3, 0.4, 0.5]}, set=slow)
    assert sweep.cancel().wait(timeout=60.0).status == "dismissed"
    assert sweep.state.counts["dismissed"] == 5


def test_a_member_that_cannot_be_run_is_named(client, settings):
    with pytest.raises(Problem) as refused:
        client.sweep("cantilever-vibration", {"loads.damping": [0.1, -0.2]}, set=settings)
    assert "member 1 (loads.damping = -0.2)" in refused.value.errors[0].rule
    with pytest.raises(Problem) as refused:
        client.ensemble("nothing")
    assert refused.value.name == "unknown_ensemble"
