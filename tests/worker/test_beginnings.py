"""A job that begins with the run of another one gives what it gives alone, to the bit."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import netCDF4
import numpy as np
import pytest

from service.cases import apply_settings, load_case, parse_case
from service.cases.beginning import common_frame
from service.jobs import Database, Job, NewJob, Registry, Status
from service.results.durable import discard
from service.settings import Settings
from worker import beginnings, trials
from worker.run import run_next

SHORT = {"t_end": 1.0, "output.interval": 0.1, "numerics.intervals": 12, "numerics.method": "staggered"}
BOX = {"numerics.method": "box"}
TABLE = {"t": [0.0, 0.45, 0.6], "value": [0.0, 1.0, 3.0], "interpolation": "linear"}
OTHER = {"t": [0.0, 0.45, 0.7], "value": [0.0, 1.0, -2.0], "interpolation": "linear"}
LOAD = {"loads.point": [{"s": 0.5, "force": [TABLE, 0.0, 0.0]}]}
END = {"preset": "free", "switches": [{"at": 0.55, "omega3": 1.0}]}


@pytest.fixture(autouse=True)
def all_states(monkeypatch: pytest.MonkeyPatch) -> None:
    """Those of short runs too."""
    monkeypatch.setattr(beginnings, "WORTH", 0.0)
    monkeypatch.setattr(trials, "WORTH", 0.0)


@pytest.fixture
def settings(tmp_path: Path, tables: None) -> Settings:
    return settings_in(tmp_path)


def settings_in(directory: Path) -> Settings:
    settings = Settings(data=directory)
    settings.make_directories()
    return settings


@pytest.fixture
def database(settings: Settings):
    database = Database(settings.database_url)
    yield database
    database.close()


def case(name: str = "cantilever-vibration", **told: Any) -> dict[str, Any]:
    return parse_case(apply_settings(load_case(name), {**SHORT, **told})).document()


def variables(settings: Settings, job) -> dict[str, np.ndarray]:
    with netCDF4.Dataset(settings.datasets / job.dataset.file) as file:
        file.set_auto_mask(False)
        attributes = {name: file.getncattr(name) for name in ("steps", "newton_iterations", "failed_steps", "case")}
        return {name: file[name][:] for name in file.variables} | attributes


def assert_same(settings: Settings, follower: Job, alone: Job) -> None:
    """All that they gave, to the bit; and the numbers of steps."""
    assert_equal(variables(settings, follower), variables(settings, alone))


def assert_equal(shared: dict[str, Any], own: dict[str, Any]) -> None:
    assert shared.keys() == own.keys() and "Tw" in own
    for name, values in own.items():
        same = np.array_equal(shared[name], values, equal_nan=values.dtype.kind == "f") if isinstance(
            values, np.ndarray) else shared[name] == values  # fmt: skip
        assert same, name


@pytest.mark.parametrize(("first", "then", "frame"), [
    ({}, {"t_end": 1.5}, 9), ({"t_end": 1.5}, {}, 9), ({"t_end": 0.97}, {"t_end": 1.3}, 9),
    (BOX, {**BOX, "t_end": 1.5}, 9), ({**BOX, "t_end": 1.5}, BOX, 9),
    (LOAD, {"loads.point": [{"s": 0.5, "force": [OTHER, 0.0, 0.0]}]}, 4),
    ({**LOAD, **BOX}, {**BOX, "loads.point": [{"s": 0.5, "force": [OTHER, 0.0, 0.0]}]}, 4),
    ({"ends.end": END}, {"ends.end": {"preset": "free", "switches": [{"at": 0.55, "omega3": -1.0}]}}, 5),
    ({"ends.end": END}, {"ends.end": {"preset": "free", "switches": [{"at": 0.8, "omega3": -1.0}]}}, 5),
    ({"ends.end": END, **BOX}, {"ends.end": {"preset": "free"}, **BOX}, 5),
    ({"numerics.verify": True}, {"numerics.verify": True, "t_end": 1.4}, 9),
    ({}, {"output.fields": ["r", "kappa"], "t_end": 1.2}, 9),
    ({"contact": {}}, {"contact": {}, "t_end": 1.4}, 9),  # what its ends do later is what they have done
])  # fmt: skip
def test_it_is_the_same_as_alone(database, settings, first, then, frame):
    registry = Registry(database)
    first, then = case(**first), case(**then)
    assert common_frame(parse_case(first), parse_case(then)) == frame
    leader = registry.submit(NewJob(first))
    run_next(database, settings)
    follower = registry.submit(NewJob(then, begins_with=leader.id, begins_at=frame))
    alone = registry.submit(NewJob(then))
    begun = []
    with pytest.MonkeyPatch.context() as patch:
        from worker import attempt

        begin = attempt.begun_with

        def watched(*told):
            begun.append(begin(*told))
            return begun[-1]

        patch.setattr(attempt, "begun_with", watched)
        run_next(database, settings)
        run_next(database, settings)
    assert begun[0] is not None and begun[1] is None
    assert sum(segment.frames for segment in begun[0].segments) <= frame + 1
    assert_same(settings, *(registry.get(job.id) for job in (follower, alone)))
    taken_over = registry.get(follower.id).attributes["steps_taken_over"]
    assert 0 < taken_over < registry.get(follower.id).reached.steps == registry.get(alone.id).reached.steps
    assert "steps_taken_over" not in registry.get(alone.id).attributes


@pytest.mark.parametrize(("first", "then"), [
    ({}, {"loads.damping": 0.5}), ({}, {"numerics.intervals": 14}), ({}, {"output.interval": 0.2}),
    ({"output.fields": ["r"]}, {"t_end": 2.0}), ({}, {"output.topology": False}), ({}, {"rod.density": 1400.0}),
    ({}, {"analysis": "static"}), ({}, {"t_end": 0.1}),
    ({"contact": {}, "ends.end": END}, {"contact": {}, "ends.end": "free"}),
    ({"loads.point": [{"s": 0.5, "force": [{**TABLE, "interpolation": "pchip"}, 0.0, 0.0]}]},
     {"loads.point": [{"s": 0.5, "force": [{**OTHER, "interpolation": "pchip"}, 0.0, 0.0]}]}),
])  # fmt: skip
def test_what_differs_from_the_start_has_no_beginning_in_common(first, then):
    assert common_frame(parse_case(case(**first)), parse_case(case(**then))) == 0


TURNS = {"contact": {}, "ends.end": {"preset": "free", "omega3": 10.0}}


@pytest.mark.parametrize(("first", "then"), [
    ({"ends.end": "free"}, {"ends.end": END}),  # what turns about one axis has its own method
    (TURNS, {**TURNS, "t_end": 2.0}),  # with more turns strands would press harder
    ({"numerics": {"tolerance": 0.01}, **TURNS}, {"numerics": {"tolerance": 0.01}, **TURNS, "t_end": 2.0}),
])  # fmt: skip
def test_where_the_run_depends_on_what_comes_it_begins_by_itself(database, settings, caplog, first, then):
    registry = Registry(database)
    leader = registry.submit(NewJob(case(**first)))
    run_next(database, settings)
    follower = registry.submit(NewJob(case(**then), begins_with=leader.id, begins_at=9))
    run_next(database, settings)
    ended = registry.get(follower.id)
    assert (ended.status, ended.begins_with) == (Status.SUCCESSFUL, None)
    assert f"does not begin with {leader.id}" in caplog.text and "is another one" in caplog.text


@pytest.mark.parametrize("harm", ["state", "dataset", "deleted"])
def test_whatever_is_not_there_any_more_it_is_run_all_the_same(database, settings, harm):
    registry = Registry(database)
    leader = registry.submit(NewJob(case()))
    run_next(database, settings)
    states = sorted((settings.data / "beginnings" / leader.id).iterdir())
    assert [int(path.name) for path in states] == [2, 5, 7, 9]
    if harm == "state":
        for path in states:
            path.write_bytes(b"x" * 100)
    elif harm == "dataset":
        discard(settings.datasets / registry.get(leader.id).dataset.file)
    else:
        from service.jobs.audit import Actor

        registry.delete(leader.id, Actor("local"))
    follower = registry.submit(NewJob(case(t_end=1.5), begins_with=leader.id, begins_at=9))
    run_next(database, settings)
    ended = registry.get(follower.id)
    assert (ended.status, ended.begins_with) == (Status.SUCCESSFUL, None)


def test_what_is_soon_computed_again_is_kept_for_those_who_wait_alone(database, settings, monkeypatch):
    monkeypatch.setattr(beginnings, "WORTH", 1e9)
    registry = Registry(database)
    leader = registry.submit(NewJob(case()))
    waiting = registry.submit(NewJob(case(t_end=1.3), begins_with=leader.id, begins_at=3, waits=True))
    run_next(database, settings)
    assert [path.name for path in (settings.data / "beginnings" / leader.id).iterdir()] == ["00000003"]
    run_next(database, settings)
    assert registry.get(waiting.id).begins_with == leader.id
    late = registry.submit(NewJob(case(t_end=1.4), begins_with=leader.id, begins_at=2))
    run_next(database, settings)
    assert (registry.get(late.id).status, registry.get(late.id).begins_with) == (Status.SUCCESSFUL, None)


@pytest.mark.parametrize("end", ["run", "cancel"])
def test_who_waits_for_another_is_run_once_that_has_ended(database, settings, end):
    registry = Registry(database)
    leader = registry.submit(NewJob(case()))
    follower = registry.submit(NewJob(case(t_end=1.3), begins_with=leader.id, begins_at=3, waits=True, priority=9))
    if end == "cancel":
        registry.cancel(leader.id)
    else:
        run_next(database, settings)
        assert registry.get(leader.id).status is Status.SUCCESSFUL
        kept = {int(path.name) for path in (settings.data / "beginnings" / leader.id).iterdir()}
        assert 3 in kept
    run_next(database, settings)
    assert registry.get(follower.id).status is Status.SUCCESSFUL
    assert json.loads(json.dumps(registry.case(follower.id)))["t_end"] == 1.3
