"""Datasets in an object store: one for each job that has one, whenever a worker is killed or the store is away."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from service.jobs import Job, Registry, Status
from service.results import Datasets, StoreUnreachable, open_dataset
from service.settings import Settings
from worker import attempt, run

ROOT = Path(__file__).parents[2]
KILLED = """
import os, signal, sys
from pathlib import Path
from service.jobs import Database
from service.settings import Settings
from worker import run

run._finish = lambda *_: os.kill(os.getpid(), signal.SIGKILL)
settings = Settings(Path(sys.argv[1]), objects=sys.argv[2], lease=1000.0)
run.run_next(Database(settings.database_url), settings)
"""


@pytest.fixture
def settings(tmp_path: Path, tables: None, objects: str) -> Settings:
    made = Settings(data=tmp_path, objects=objects, lease=1000.0)
    made.make_directories()
    return made


def ended(job: Job, registry: Registry, settings: Settings) -> Job:
    run.run_next(registry.database, settings)
    return registry.get(job.id)


def killed_before_its_commit(settings: Settings) -> None:
    """A worker takes the job and is killed between the upload and the commit of the row."""
    told = [sys.executable, "-c", KILLED, str(settings.data), settings.objects]
    assert subprocess.run(told, cwd=ROOT).returncode == -9


def files(settings: Settings) -> list[Path]:
    return [path for folder in (settings.datasets, settings.work, settings.locks) for path in folder.iterdir()]


def away(*_: object) -> None:
    raise StoreUnreachable("nobody answers")


def test_a_job_ends_with_an_object_whose_hash_its_row_tells(job, registry, settings, held_objects):
    done = ended(job, registry, settings)
    assert (done.status, held_objects(), files(settings)) == (Status.SUCCESSFUL, [done.dataset.file], [])
    found = Datasets(settings.datasets, settings.copies, settings.objects)
    with open_dataset(found.file(done.dataset.file, done.dataset.bytes, done.dataset.sha256)) as dataset:
        assert dataset.attrs["outcome"] == "completed"


def test_a_worker_killed_between_upload_and_commit_publishes_nothing_twice(job, registry, settings, held_objects,
                                                                           take_back_all):
    killed_before_its_commit(settings)
    assert held_objects() == [f"{job.id}.1.nc"]
    take_back_all()
    done = ended(job, registry, settings)
    assert (done.status, done.dataset.file) == (Status.SUCCESSFUL, f"{job.id}.3.nc")
    assert (held_objects(), files(settings)) == ([done.dataset.file], [])


def test_what_was_uploaded_for_a_job_that_then_was_cancelled_is_removed(job, registry, settings, held_objects,
                                                                        take_back_all):
    killed_before_its_commit(settings)
    registry.cancel(job.id)
    take_back_all()
    assert ended(job, registry, settings).status is Status.DISMISSED
    assert (held_objects(), files(settings)) == ([], [])


def test_what_cannot_be_removed_now_is_removed_later(job, registry, settings, held_objects, monkeypatch, take_back_all):
    killed_before_its_commit(settings)
    registry.cancel(job.id)
    take_back_all()
    with monkeypatch.context() as unreachable:
        unreachable.setattr(Datasets, "discard", away)
        run.run_next(registry.database, settings)
    assert held_objects() == [f"{job.id}.1.nc"]
    run.run_next(registry.database, settings)
    assert (held_objects(), files(settings)) == ([], [])


def test_a_store_that_is_away_for_a_while_costs_nothing(job, registry, settings, held_objects, monkeypatch):
    monkeypatch.setattr(attempt, "LOOK_AGAIN", 0.01)
    publish, tries = Datasets.publish, []

    def comes_back(self, path):
        tries.append(path)
        if len(tries) < 5:
            away()
        publish(self, path)

    monkeypatch.setattr(Datasets, "publish", comes_back)
    done = ended(job, registry, settings)
    assert (done.status, done.reached.steps_redone, held_objects()) == (Status.SUCCESSFUL, 0, [done.dataset.file])


def test_a_store_that_stays_away_has_a_name(job, registry, settings, held_objects, monkeypatch):
    monkeypatch.setattr(attempt, "ROOM_WITHIN", 0.0)
    monkeypatch.setattr(Datasets, "publish", away)
    done = ended(job, registry, settings)
    assert (done.status, done.outcome, done.dataset) == (Status.FAILED, "dataset_not_written", None)
    assert "object store" in done.message and "nobody answers" not in done.message
    assert (held_objects(), files(settings)) == ([], [])


def test_a_job_cancelled_while_the_store_is_away_leaves_nothing(job, registry, settings, held_objects, monkeypatch):
    monkeypatch.setattr(attempt, "LOOK_AGAIN", 0.01)

    def cancelled(*_: object) -> None:
        registry.cancel(job.id)
        away()

    monkeypatch.setattr(Datasets, "publish", cancelled)
    assert ended(job, registry, settings).status is Status.DISMISSED
    assert (held_objects(), files(settings)) == ([], [])
