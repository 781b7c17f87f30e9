"""A job to a tolerance that begins with the run of another gives what it gives alone, to the bit."""

from __future__ import annotations

import json
import signal
from collections.abc import Callable
from functools import cache, partial
from pathlib import Path
from shutil import copy, copytree, rmtree
from typing import Any, NamedTuple

import pytest

from service.jobs import Database, Job, NewJob, Registry, Status
from service.jobs.audit import Actor
from service.jobs.reconciler import beats, take_back
from service.settings import Settings
from solver import Simulation
from tests.worker.killed import killed_after
from tests.worker.test_beginnings import (
    OTHER,
    TABLE,
    all_states,
    assert_equal,
    case,
    database,
    settings_in,
    variables,
)
from worker import trials
from worker.run import run_next

__all__ = ["all_states", "database"]

FINE = {"numerics": {"tolerance": 3e-4}}


def tolerated(name: str = "cantilever-vibration", **told: Any) -> dict[str, Any]:
    return case(name, **{"numerics": {"tolerance": 1e-2}, "output.interval": 0.02, **told})


@pytest.fixture(scope="module")
def led(tmp_path_factory: pytest.TempPathFactory, empty_registry: Path) -> Callable[[], tuple[Path, str]]:
    """Run a job with which others may begin, once for all tests: its directory and its id."""

    @cache
    def run() -> tuple[Path, str]:
        settings = settings_in(tmp_path_factory.mktemp("led"))
        copy(empty_registry, settings.data)
        database = Database(settings.database_url)
        job, _ = run_counted(Registry(database), settings, tolerated())
        database.close()
        return settings.data, job.id

    return run


@pytest.fixture
def settings(request: pytest.FixtureRequest, tmp_path: Path, tables: None, led) -> Settings:
    """Those of a directory of the test's own, in which there is the `leader` if the test has one."""
    if "leader" in request.fixturenames:
        copytree(led()[0], tmp_path, dirs_exist_ok=True)
    return settings_in(tmp_path)


@pytest.fixture
def registry(database) -> Registry:
    return Registry(database)


@pytest.fixture
def leader(registry, led) -> Job:
    """A job that has been run to t = 1."""
    return registry.get(led()[1])


@pytest.fixture
def ran(registry, settings):
    """Hand in a case, run it, and give the job, with how many steps were computed for it."""
    return partial(run_counted, registry, settings)


def run_counted(registry: Registry, settings: Settings, case: dict[str, Any], **told: Any) -> tuple[Job, int]:
    job, steps = registry.submit(NewJob(case, **told)), 0
    take = Simulation._take

    def counted(simulation, *told):
        nonlocal steps
        steps += 1
        take(simulation, *told)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Simulation, "_take", counted)
        run_next(registry.database, settings)
    ended = registry.get(job.id)
    assert ended.status is Status.SUCCESSFUL, ended.message
    return ended, steps


class Alone(NamedTuple):
    """A job that began with no other, what it gave, and how many steps were computed for it."""

    job: Job
    gave: dict[str, Any]
    computed: int


@pytest.fixture(scope="module")
def run_alone(tmp_path_factory: pytest.TempPathFactory, empty_registry: Path) -> Callable[[dict[str, Any]], Alone]:
    """Run a case where there is no other job; each case once for all tests."""
    known: dict[str, Alone] = {}

    def run(case: dict[str, Any]) -> Alone:
        key = json.dumps(case, sort_keys=True)
        if key not in known:
            settings = settings_in(tmp_path_factory.mktemp("alone"))
            copy(empty_registry, settings.data)
            database = Database(settings.database_url)
            job, computed = run_counted(Registry(database), settings, case)
            database.close()
            known[key] = Alone(job, variables(settings, job), computed)
        return known[key]

    return run


def taken_over(job: Job) -> int:
    return int(job.attributes.get("steps_taken_over", 0))


def load(table: dict[str, Any]) -> dict[str, Any]:
    return {"loads.point": [{"s": 0.5, "force": [table, 0.0, 0.0]}]}


def switched(omega3: float, at: float = 0.55) -> dict[str, Any]:
    return {"t_end": 0.64, "ends.end": {"preset": "free", "switches": [{"at": at, "omega3": omega3}]},
            "numerics": {"tolerance": 5e-2}}  # fmt: skip


@pytest.mark.parametrize(("first", "then", "frame"), [
    ({}, {"t_end": 1.5}, 49), ({"t_end": 1.5}, {}, 49), (FINE, {**FINE, "t_end": 1.5}, 49),
    (load(TABLE), load(OTHER), 24), (switched(1.0), switched(-1.0), 27),
    (switched(1.0), switched(1.0, at=0.58), 27),
    ({"output.fields": ["r"]}, {"t_end": 1.3}, 49),  # rows hold all
    ({"contact": {}}, {"contact": {}, "t_end": 1.4}, 49),
])  # fmt: skip
def test_it_is_the_same_as_alone_for_fewer_steps(ran, run_alone, settings, first, then, frame):
    leader, _ = ran(tolerated(**first))
    follower, computed = ran(tolerated(**then), begins_with=leader.id, begins_at=frame)
    alone, gave, whole = run_alone(tolerated(**then))
    assert_equal(variables(settings, follower), gave)
    assert follower.begins_with == leader.id
    assert follower.reached.steps == alone.reached.steps == whole == computed + taken_over(follower)
    assert taken_over(alone) == 0 < taken_over(follower)


def test_who_begins_with_one_that_began_with_another_takes_over_from_it(leader, ran, run_alone, settings):
    second, _ = ran(tolerated(t_end=1.5), begins_with=leader.id, begins_at=49)
    third, computed = ran(tolerated(t_end=2.0), begins_with=second.id, begins_at=74)
    _, gave, whole = run_alone(tolerated(t_end=2.0))
    assert_equal(variables(settings, third), gave)
    assert taken_over(third) > taken_over(second) > 0
    assert computed < 0.5 * whole


@pytest.mark.parametrize(("first", "then"), [(28.0, 30.0), (29.0, 30.0)])
def test_what_ends_its_first_attempt_because_strands_press_is_the_same_too(ran, run_alone, settings, first, then):
    """The twisted cable touches itself after 28 s."""
    leader, _ = ran(tolerated("goyal-2003", **{"t_end": first, "output.interval": 0.5}))
    told = {"begins_with": leader.id, "begins_at": int(first / 0.5) - 1}
    follower, computed = ran(tolerated("goyal-2003", **{"t_end": then, "output.interval": 0.5}), **told)
    _, gave, whole = run_alone(tolerated("goyal-2003", **{"t_end": then, "output.interval": 0.5}))
    assert_equal(variables(settings, follower), gave)
    assert computed == whole - taken_over(follower) < 0.7 * whole


def test_what_another_tolerance_computed_is_not_taken_over(leader, ran):
    follower, _ = ran(tolerated(t_end=1.5, **FINE), begins_with=leader.id, begins_at=49)
    assert (follower.begins_with, taken_over(follower)) == (None, 0)


@pytest.mark.parametrize("harm", ["states", "rows", "one state", "deleted", "emptied"])
def test_whatever_is_not_there_any_more_it_gives_the_same(leader, ran, run_alone, registry, settings, harm):
    kept = settings.data / "beginnings" / leader.id
    attempts = sorted(kept.iterdir())
    assert len(attempts) > 2
    assert all([path.name for path in sorted(attempt.iterdir())]
               == ["00000010", "00000025", "00000035", "00000045", "rows"] for attempt in attempts)  # fmt: skip
    for attempt in attempts:
        for path in attempt.iterdir():
            if harm == "emptied":
                path.unlink()
            elif path.name == {"rows": "rows", "one state": "00000045"}.get(harm, path.name) and harm != "deleted":
                path.write_bytes(path.read_bytes()[:-9] if path.name == "rows" else b"x" * 100)
    if harm == "deleted":
        registry.delete(leader.id, Actor("local"))
    follower, computed = ran(tolerated(t_end=1.5), begins_with=leader.id, begins_at=49)
    _, gave, whole = run_alone(tolerated(t_end=1.5))
    assert_equal(variables(settings, follower), gave)
    if harm == "one state":
        assert 0 < computed < whole and follower.begins_with == leader.id
    else:
        assert computed == whole and follower.begins_with is None


def test_one_attempt_whose_states_are_lost_is_run_whole_and_the_others_begin_later(leader, ran, run_alone, settings):
    kept = sorted((settings.data / "beginnings" / leader.id).iterdir())
    for path in kept[0].iterdir():
        path.unlink()
    follower, computed = ran(tolerated(t_end=1.5), begins_with=leader.id, begins_at=49)
    _, gave, whole = run_alone(tolerated(t_end=1.5))
    assert_equal(variables(settings, follower), gave)
    assert 0 < computed < whole and follower.begins_with == leader.id


def test_short_attempts_keep_states_for_those_alone_who_wait(ran, registry, settings, monkeypatch):
    monkeypatch.setattr(trials, "WORTH", 1e9)
    leader = registry.submit(NewJob(tolerated()))
    waiting = registry.submit(NewJob(tolerated(t_end=1.3), begins_with=leader.id, begins_at=24, waits=True))
    run_next(registry.database, settings)
    kept = settings.data / "beginnings" / leader.id
    assert {path.name for path in kept.glob("*/*")} == {"00000020", "rows"}
    run_next(registry.database, settings)
    assert taken_over(registry.get(waiting.id)) > 0
    ran(tolerated(t_end=0.9))
    assert [path.name for path in kept.parent.iterdir()] == [leader.id]
    late, _ = ran(tolerated(t_end=1.4), begins_with=leader.id, begins_at=19)
    assert (late.begins_with, taken_over(late)) == (None, 0)


def killed(registry: Registry, settings: Settings, steps: int) -> None:
    assert killed_after(steps, settings.data, 1e-9) == -signal.SIGKILL
    for beat in beats(registry.database):
        take_back(registry.database, beat, 3)


@pytest.mark.parametrize(("whose", "steps"), [
    ("leader", 1), ("leader", 20), ("leader", 50), ("leader", 60),
    ("follower", 1), ("follower", 8), ("follower", 16), ("follower", 30),
])  # fmt: skip
def test_a_job_that_is_killed_on_its_way_goes_on_and_gives_the_same(ran, run_alone, registry, settings, whose, steps):
    leader = registry.submit(NewJob(tolerated()))
    follower = registry.submit(NewJob(tolerated(t_end=1.5), begins_with=leader.id, begins_at=49, waits=True))
    if whose == "follower":
        run_next(registry.database, settings)
    killed(registry, settings, steps)
    while run_next(registry.database, settings):
        pass
    ended = registry.get(follower.id)
    alone = run_alone(tolerated(t_end=1.5))
    assert (registry.get(leader.id if whose == "leader" else follower.id).attempts, ended.begins_with) == (2, leader.id)
    assert_equal(variables(settings, ended), alone.gave)
    assert taken_over(ended) > 0.5 * ended.reached.steps


def test_a_job_goes_on_from_its_checkpoint_though_who_it_began_with_is_gone(leader, ran, run_alone, registry, settings):
    follower = registry.submit(NewJob(tolerated(t_end=1.5), begins_with=leader.id, begins_at=49))
    killed(registry, settings, 6)
    registry.delete(leader.id, Actor("local"))
    rmtree(settings.data / "beginnings" / leader.id)
    run_next(registry.database, settings)
    ended = registry.get(follower.id)
    alone = run_alone(tolerated(t_end=1.5))
    assert_equal(variables(settings, ended), alone.gave)
    assert ended.begins_with == leader.id and 0 < taken_over(ended) < 0.5 * ended.reached.steps
