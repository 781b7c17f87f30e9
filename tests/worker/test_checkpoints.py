"""A killed job goes on from its newest whole checkpoint, and its dataset is that of an undisturbed run."""

from __future__ import annotations

import hashlib
import json
import os
import signal
import subprocess
import sys
from collections.abc import Mapping
from dataclasses import replace
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

from service.cases import apply_settings, load_case
from service.jobs import Database, Job, Limits, NewJob, Registry, Status
from service.jobs.reconciler import beats, take_back
from service.results import open_dataset
from service.settings import Settings
from tests.worker.killed import killed_after
from worker import run
from worker.checkpoints import Checkpoint, Checkpoints, packed, unpacked

ROOT = Path(__file__).parents[2]
CASE = apply_settings(
    load_case("cantilever-vibration"),
    {"t_end": 0.05, "output.interval": 0.01, "numerics.intervals": 8, "numerics.dt_max": 0.001},
)


@pytest.fixture
def case() -> dict[str, Any]:
    return CASE


def killed(settings: Settings, registry: Registry, steps: int, checkpoint: float = 1e-9) -> None:
    """A worker takes the job and is killed after some steps; then the job is taken back."""
    assert killed_after(steps, settings.data, checkpoint) == -signal.SIGKILL
    for beat in beats(registry.database):
        take_back(registry.database, beat, 3)


def run_on(settings: Settings, registry: Registry, job: Job) -> Job:
    run.run_next(registry.database, settings)
    return registry.get(job.id)


def content(settings: Settings, job: Job) -> xr.Dataset:
    with open_dataset(settings.datasets / job.dataset.file) as dataset:
        return dataset.load()


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory: pytest.TempPathFactory) -> xr.Dataset:
    settings = Settings(tmp_path_factory.mktemp("undisturbed"), lease=1000.0)
    settings.make_directories()
    registry = Registry(Database(settings.database_url))
    return content(settings, run_on(settings, registry, registry.submit(NewJob(CASE))))


def assert_same(one: xr.Dataset, other: xr.Dataset) -> None:
    for name in one.variables:
        assert np.array_equal(one[name].values, other[name].values, equal_nan=one[name].dtype.kind == "f"), name
    for name in ("case", "outcome", "message", "steps", "failed_steps", "newton_iterations"):
        assert one.attrs[name] == other.attrs[name], name


def test_a_job_killed_again_and_again_has_the_dataset_of_an_undisturbed_run(job, registry, settings, undisturbed):
    for steps in (5, 9, 4):
        killed(settings, registry, steps)
    done = run_on(settings, registry, job)
    assert (done.status, done.attempts) == (Status.SUCCESSFUL, 4)
    assert_same(content(settings, done), undisturbed)
    assert done.reached.steps == undisturbed.attrs["steps"]
    assert done.reached.steps_redone <= 3  # a checkpoint after every step: at most one was on its way each time
    assert list(settings.work.iterdir()) == []


def test_a_job_killed_while_it_is_refined_goes_on_and_has_its_error_bars(registry, settings):
    asked = {"t_end": 0.5, "numerics.tolerance": 1e-2, "numerics.verify": True}
    case = apply_settings(load_case("elastica"), asked)
    whole = content(settings, run_on(settings, registry, registry.submit(NewJob(case))))
    job = registry.submit(NewJob(case))
    killed(settings, registry, 20)
    done = run_on(settings, registry, job)
    assert (done.status, done.attempts) == (Status.SUCCESSFUL, 2)
    assert_same(content(settings, done), whole)
    assert whole.r_error.shape == whole.r.shape


def test_without_a_checkpoint_all_is_redone_and_told(job, registry, settings, undisturbed):
    killed(settings, registry, 7, checkpoint=1e9)
    done = run_on(settings, registry, job)
    assert_same(content(settings, done), undisturbed)
    assert done.reached.steps_redone >= 7  # the first call takes two steps


@pytest.mark.parametrize("left", [0, 20, -1])
def test_a_torn_checkpoint_is_passed_over(job, registry, settings, undisturbed, left):
    killed(settings, registry, 9)
    newest, older = sorted(settings.work.glob(f"{job.id}/checkpoint-*"), reverse=True)
    os.truncate(newest, left % newest.stat().st_size)
    (newest.parent / f"{newest.name}.part").write_bytes(b"killed while it was written")
    done = run_on(settings, registry, job)
    assert_same(content(settings, done), undisturbed)
    assert done.reached.steps_redone >= int(newest.name[11:23]) - int(older.name[11:23])


def test_a_checkpoint_with_a_damaged_segment_is_passed_over(job, registry, settings, undisturbed):
    killed(settings, registry, 9)
    segment = max(settings.work.glob(f"{job.id}/segment-*"))
    segment.write_bytes(segment.read_bytes()[:-5])
    assert_same(content(settings, run_on(settings, registry, job)), undisturbed)


def test_a_checkpoint_of_other_code_is_passed_over(job, registry, settings, undisturbed, monkeypatch):
    killed(settings, registry, 9)
    monkeypatch.setattr("worker.attempt.code_digest", lambda: "newer")
    done = run_on(settings, registry, job)
    assert done.reached.steps_redone >= 9
    assert_same(content(settings, done), undisturbed)


def test_a_run_whose_checkpoints_cannot_be_written_comes_to_its_end(job, registry, settings, undisturbed, monkeypatch):
    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Checkpoints, "save", full)
    done = run_on(replace(settings, checkpoint=1e-9), registry, job)
    assert_same(content(settings, done), undisturbed)


def test_a_job_that_writes_too_much_ends_by_name(registry, settings):
    job = registry.submit(NewJob(CASE, limits=Limits(disk=1000)))
    done = run_on(settings, registry, job)
    assert (done.status, done.outcome) == (Status.FAILED, "disk_limit_exceeded")
    assert [*settings.work.iterdir(), *settings.datasets.iterdir()] == []


GREEDY = """
import sys
from worker.memory import memory_limit
import numpy as np
with memory_limit(200_000_000):
    kept = np.ones(10_000_000)
    try:
        np.ones(100_000_000)
    except MemoryError:
        print("refused")
print(len(np.ones(50_000_000)))
"""


@pytest.mark.skipif(sys.platform != "linux", reason="the limit is Linux's")
def test_more_memory_than_the_limit_is_refused_and_the_limit_ends_with_the_job():
    told = subprocess.run([sys.executable, "-c", GREEDY], cwd=ROOT, capture_output=True, text=True)
    assert told.stdout.split() == ["refused", "50000000"], told.stderr


STATE = {
    "zeros": np.zeros((3, 5)), "some": np.array([0.0, -0.0, np.nan, np.inf, 5e-324, 1.0]), "none": np.zeros((0, 4)),
    "one": np.array(2.5), "flags": np.array([True, False, True]), "counts": np.array([7, 0, -1], np.int32),
    "last": np.arange(4.0), "number": 0.1, "nothing": None,
}  # fmt: skip


def assert_equal_states(told: Mapping[str, Any]) -> None:
    assert told.keys() == STATE.keys()
    for name, value in STATE.items():
        if isinstance(value, np.ndarray):
            assert (told[name].dtype, told[name].shape) == (value.dtype, value.shape), name
            assert told[name].tobytes() == value.tobytes() and told[name].flags.writeable, name
        else:
            assert told[name] == value, name


def test_a_checkpoint_gives_back_every_bit_and_leaves_zeros_out():
    assert_equal_states(unpacked(packed(Checkpoint(3, STATE, ()), "key"), "key").state)
    large, small = (len(packed(Checkpoint(3, {"a": make(10_000)}, ()), "key")) for make in (np.ones, np.zeros))
    assert large > 80_000 and small < 5_000


def test_a_checkpoint_of_before_zeros_were_left_out_is_read(tmp_path):
    arrays = {name: value for name, value in STATE.items() if isinstance(value, np.ndarray)}
    head = {"key": "key", "steps": 3, "numbers": {"number": 0.1, "nothing": None}, "segments": []}
    content = BytesIO()
    np.savez(content, head=np.frombuffer(json.dumps(head).encode(), np.uint8), **arrays)
    whole = hashlib.sha256(content.getvalue()).digest() + content.getvalue()
    (tmp_path / "checkpoint-000000000003.1").write_bytes(whole)
    found = Checkpoints(tmp_path, 2, "key").newest()
    assert found is not None and (found.steps, found.segments) == (3, ())
    assert_equal_states(found.state)


def test_two_checkpoints_are_kept_and_another_attempts_are_its_own(tmp_path):
    later = Checkpoints(tmp_path, 7, "key")
    later.save(Checkpoint(50, {}, ()))
    mine = Checkpoints(tmp_path, 3, "key")
    for steps in range(1, 5):
        mine.save(Checkpoint(steps, {"a": np.arange(3.0), "b": float("nan"), "c": None}, ()))
    left = sorted(path.name for path in tmp_path.iterdir())
    assert left == ["checkpoint-000000000004.3", "checkpoint-000000000050.7"]
    found = mine.newest()
    assert found is not None and found.steps == 50
