"""A backup is consistent while the service writes; what is restored is what was saved; a check finds every fault."""

from __future__ import annotations

import os
import shutil
import threading

import pytest

from hockle.cli import main
from service.jobs import Database, Dataset, NewJob, Reached, Registry, Status
from service.jobs.audit import Actor
from service.jobs.held import claim
from service.results.durable import sha256_of, stamp_of
from service.settings import Settings
from service.store.backup import back_up, restore
from service.store.check import check


@pytest.fixture
def settings(tmp_path):
    settings = Settings(data=tmp_path / "data")
    settings.make_directories()
    return settings


@pytest.fixture
def database(settings):
    database = Database(settings.database_url)
    yield database
    database.close()


@pytest.fixture
def ended(database, settings):
    """Ends a job with a dataset of its own."""

    def end() -> str:
        job = Registry(database).submit(NewJob({"t_end": 1.0}))
        file = settings.datasets / f"{job.id}.1.nc"
        file.write_text(job.id)
        held = claim(database, job.id, 9.0, "here")
        dataset = Dataset(file.name, sha256_of(file), len(job.id), stamp_of(file))
        held.finish(Status.SUCCESSFUL, "completed", "", dataset, Reached())
        return job.id

    return end


def everything(settings):
    database = Database(settings.database_url)
    try:
        return {job.id: (job.status, (settings.datasets / job.dataset.file).read_text() if job.dataset else None)
                for job in Registry(database).page(200).jobs}  # fmt: skip
    finally:
        database.close()


def test_what_is_restored_is_what_was_saved(database, settings, ended, tmp_path):
    ended(), ended(), Registry(database).submit(NewJob({}))
    assert list(back_up(database, settings, tmp_path / "saved")) == []
    fresh = Settings(data=tmp_path / "fresh")
    fresh.make_directories()
    assert list(restore(fresh, tmp_path / "saved")) == []
    assert everything(fresh) == everything(settings)
    again = Database(fresh.database_url)
    assert list(check(again, fresh)) == []
    again.close()


def test_a_backup_needs_no_log_beside_it(database, settings, ended, tmp_path):
    """A copy of registry.db alone held 0 of 30 jobs: the rows were in its log."""
    for _ in range(30):
        ended()
    shutil.copy(settings.data / "registry.db", tmp_path / "copied.db")
    list(back_up(database, settings, tmp_path / "saved"))
    assert sorted(path.name for path in (tmp_path / "saved").iterdir()) == ["datasets", "registry.db"]
    saved = Database(f"sqlite:///{tmp_path}/saved/registry.db")
    assert len(Registry(saved).page(200).jobs) == 30
    saved.close()


def test_a_backup_is_of_one_moment_however_much_is_written_meanwhile(database, settings, ended, tmp_path):
    stopped = threading.Event()

    def write() -> None:
        while not stopped.is_set():
            ended()

    writing = threading.Thread(target=write)
    writing.start()
    try:
        for number in range(3):
            faults = list(back_up(database, settings, tmp_path / f"saved-{number}"))
            fresh = Settings(data=tmp_path / f"fresh-{number}")
            fresh.make_directories()
            assert faults == list(restore(fresh, tmp_path / f"saved-{number}")) == []
            with_unfinished = everything(fresh).values()
            assert all(content is not None for status, content in with_unfinished if status == "successful")
    finally:
        stopped.set()
        writing.join()


def test_a_second_backup_copies_what_is_new_and_drops_what_was_deleted(database, settings, ended, tmp_path):
    first, second = ended(), ended()
    list(back_up(database, settings, tmp_path / "saved"))
    copied = tmp_path / "saved" / "datasets" / f"{second}.1.nc"
    before = stamp_of(copied)
    Registry(database).delete(first, Actor("alice"))
    third = ended()
    list(back_up(database, settings, tmp_path / "saved"))
    assert stamp_of(copied) == before
    assert {path.name for path in copied.parent.iterdir()} == {f"{second}.1.nc", f"{third}.1.nc"}


def test_nothing_is_restored_over_what_is_kept(database, settings, ended, tmp_path, capsys):
    ended()
    list(back_up(database, settings, tmp_path / "saved"))
    assert main(["store", "restore", str(tmp_path / "saved"), "--data", str(settings.data)]) == 1
    assert "is a registry already" in capsys.readouterr().err
    assert main(["store", "restore", str(tmp_path / "nowhere"), "--data", str(tmp_path / "fresh")]) == 1
    assert "holds no backup" in capsys.readouterr().err


def test_a_restore_that_was_interrupted_is_done_once_more(database, settings, ended, tmp_path, monkeypatch):
    ended(), ended()
    list(back_up(database, settings, tmp_path / "saved"))
    fresh = Settings(data=tmp_path / "fresh")
    fresh.make_directories()
    copies = []

    def interrupted(source, target):
        copies.append(target)
        if len(copies) == 2:
            raise KeyboardInterrupt
        return os.link(source, target)

    with monkeypatch.context() as context, pytest.raises(KeyboardInterrupt):
        context.setattr("shutil.copyfile", interrupted)
        list(restore(fresh, tmp_path / "saved"))
    for copied in fresh.datasets.iterdir():
        copied.unlink()
        copied.write_text("half")
    assert list(restore(fresh, tmp_path / "saved")) == []
    assert everything(fresh) == everything(settings)


def test_a_damaged_backup_is_told_when_it_is_restored(database, settings, ended, tmp_path):
    job_id = ended()
    list(back_up(database, settings, tmp_path / "saved"))
    (tmp_path / "saved" / "datasets" / f"{job_id}.1.nc").write_text("x" * len(job_id))
    fresh = Settings(data=tmp_path / "fresh")
    fresh.make_directories()
    [fault] = restore(fresh, tmp_path / "saved")
    assert fault.startswith(f"job {job_id}: its dataset {job_id}.1.nc is damaged")


def test_check_names_what_is_lost_and_repairs_what_is_left_over(database, settings, ended, capsys):
    good, missing, damaged, gone = ended(), ended(), ended(), ended()
    file = {job_id: settings.datasets / f"{job_id}.1.nc" for job_id in (good, missing, damaged, gone)}
    file[missing].unlink()
    stamp = file[damaged].stat()
    file[damaged].write_text("x" * len(damaged))
    os.utime(file[damaged], ns=(stamp.st_atime_ns, stamp.st_mtime_ns))  # it looks as before
    Registry(database).delete(gone, Actor("alice"))
    (settings.datasets / f"{good}.2.nc").write_text("of a lost attempt")
    (settings.datasets / f"{'0' * 26}.1.nc").write_text("of another registry")
    assert main(["store", "check", "--data", str(settings.data)]) == 1
    told = capsys.readouterr().out
    assert f"job {missing}: its dataset {missing}.1.nc is missing" in told
    assert f"job {damaged}: its dataset {damaged}.1.nc is damaged" in told
    assert f"{good}.2.nc was left over, and is removed" in told
    assert f"{'0' * 26}.1.nc is the dataset of no job" in told
    assert told.endswith("3 faults are left\n") and not file[gone].exists()
    assert Registry(database).get(damaged).dataset.fault and not Registry(database).get(good).dataset.fault


def test_prune_deletes_what_the_settings_keep_no_longer(database, settings, ended, monkeypatch, capsys):
    job_id = ended()
    monkeypatch.setenv("HOCKLE_KEEP_BYTES", "1")
    monkeypatch.setattr("service.store.retention.YOUNGEST", -1.0)
    command = ["store", "prune", "--data", str(settings.data)]
    assert main([*command, "--dry-run"]) == 0
    assert capsys.readouterr().out == f"{job_id}\n1 jobs would be deleted\n"
    assert (settings.datasets / f"{job_id}.1.nc").exists()
    assert main(command) == 0
    assert capsys.readouterr().out == f"{job_id}\n1 jobs are deleted\n"
    assert not (settings.datasets / f"{job_id}.1.nc").exists()


def test_a_registry_on_postgresql_is_saved_and_brought_back(tmp_path):
    from chaos.postgres import binaries, postgres

    if binaries() is None:
        pytest.skip("no PostgreSQL on this machine")
    with postgres(synced=False) as server:
        there = Settings(data=tmp_path / "data", database=server.create("one"))
        there.make_directories()
        database = Database(there.database_url)
        job = Registry(database).submit(NewJob({"a": 1}))
        Registry(database).cancel(job.id, Actor("alice"))
        list(back_up(database, there, tmp_path / "saved"))
        database.close()
        fresh = Settings(data=tmp_path / "fresh", database=server.create("two"))
        fresh.make_directories()
        assert list(restore(fresh, tmp_path / "saved")) == []
        assert everything(fresh) == everything(there)
        again = Database(fresh.database_url)
        new = Registry(again).submit(NewJob({}))
        assert Registry(again).cancel(new.id, Actor("alice")).status is Status.DISMISSED
        again.close()
        with pytest.raises(FileExistsError):
            list(restore(fresh, tmp_path / "saved"))
