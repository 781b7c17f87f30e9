"""The tables: made and upgraded by migrations, alike on each database, refused if of another version."""

from __future__ import annotations

import shutil
import sqlite3
import threading

import pytest
from alembic.autogenerate import compare_metadata
from alembic.runtime.migration import MigrationContext
from sqlalchemy import create_engine, select, text

from service.jobs import Database, NewJob, Registry
from service.jobs.migrations import WrongSchema, migrate
from service.jobs.registry import insert_jobs
from service.jobs.sqlite import FilesReplaced, _patiently
from service.jobs.tables import metadata, owners

OLD_JOB = text("""
INSERT INTO jobs (id, owner, status, title, label, priority, case_json, case_sha256, progress, t, steps, steps_redone,
                  wall, outcome, message, cancel_requested, created, attempts, fruitless, checkpoint_steps, epoch,
                  version, worker, limit_wall, limit_memory, limit_disk, dataset_file, dataset_sha256, dataset_bytes)
VALUES (:id, 'alice', :status, '', '', 0, '{}', '', 0, 0, 0, 0, 0, '', '', false, 1, 0, 0, 0, 0, 1, '', 1, 64000000, 1,
        'f.nc', '', :size)
""")


def test_the_migrations_make_the_tables_that_the_code_knows(database):
    with database.engine.connect() as connection:
        context = MigrationContext.configure(connection, opts={"compare_type": True})
        assert compare_metadata(context, metadata) == []


def test_many_processes_may_open_a_new_database_at_once(url):
    opened: list[Database] = []
    threads = [threading.Thread(target=lambda: opened.append(Database(url))) for _ in range(6)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(opened) == 6
    for one in opened:
        one.close()


def test_opening_waits_for_another_process_that_makes_the_file(tmp_path):
    with sqlite3.connect(tmp_path / "registry.db", isolation_level=None, check_same_thread=False) as other:
        other.execute("BEGIN IMMEDIATE")
        threading.Timer(0.3, lambda: other.execute("COMMIT")).start()
        Database(f"sqlite:///{tmp_path}/registry.db").close()


def test_an_older_registry_is_upgraded_with_what_its_owners_have_counted(url):
    engine = create_engine(url)
    with engine.begin() as connection:
        migrate(connection, "0003")
        connection.execute(text("INSERT INTO owners (name, served) VALUES ('alice', 0)"))
        for name, status, size in (("a", "running", None), ("b", "successful", 30), ("c", "failed", 12)):
            connection.execute(OLD_JOB, {"id": name, "status": status, "size": size})
    engine.dispose()
    upgraded = Database(url)
    with upgraded.reading() as connection:
        assert connection.execute(select(owners.c.unfinished, owners.c.bytes)).one() == (1, 42)
    assert {job.id: job.pinned for job in Registry(upgraded).page(9).jobs} == dict.fromkeys("abc", False)
    upgraded.close()


def test_a_registry_of_a_newer_version_is_refused(database, url):
    with database.engine.begin() as connection:
        connection.execute(text("UPDATE alembic_version SET version_num = '9999'"))
    with pytest.raises(WrongSchema, match="newer hockle"):
        Database(url)


def test_an_installation_without_its_migrations_is_not_told_as_a_newer_registry(url, monkeypatch):
    monkeypatch.setattr("alembic.script.base.os.access", lambda *_: False)
    with pytest.raises(WrongSchema, match=r"cannot be read: .*migrations"):
        Database(url)


def test_a_registry_from_before_the_migrations_is_refused(url):
    engine = create_engine(url)
    with engine.begin() as connection:
        connection.execute(text("CREATE TABLE schema_version (version INTEGER)"))
    engine.dispose()
    with pytest.raises(WrongSchema, match="another data directory"):
        Database(url)


def test_what_fails_in_its_middle_changes_nothing(registry):
    with pytest.raises(ZeroDivisionError), registry.database.writing() as transaction:
        insert_jobs(transaction, [NewJob({})])
        raise ZeroDivisionError
    assert registry.page(1).jobs == []


def test_opening_waits_for_another_process_that_recovers_the_log():
    recovering = sqlite3.OperationalError("database is locked")
    recovering.sqlite_errorcode = sqlite3.SQLITE_BUSY_RECOVERY
    refusals = [recovering, recovering]

    def execute(_statement: str) -> None:
        if refusals:
            raise refusals.pop()

    _patiently(execute, "PRAGMA journal_mode=WAL")
    assert refusals == []


@pytest.mark.parametrize("ending", ["", "-wal", "-shm"])
@pytest.mark.parametrize("replaced", [False, True])
def test_a_file_that_is_removed_or_replaced_under_a_process_is_noticed_before_it_writes(tmp_path, ending, replaced):
    database = Database(f"sqlite:///{tmp_path}/registry.db")
    registry = Registry(database)
    job = registry.submit(NewJob({}))
    path, away = tmp_path / f"registry.db{ending}", tmp_path / "away"
    path.rename(away)
    if replaced:
        shutil.copyfile(away, path)
    with pytest.raises(FilesReplaced, match=f"registry.db{ending} was removed or replaced"):
        registry.submit(NewJob({}))
    away.rename(path)
    again = registry.submit(NewJob({}))
    database.close()
    opened = Database(f"sqlite:///{tmp_path}/registry.db")
    assert [one.id for one in Registry(opened).page(9).jobs] == sorted([job.id, again.id], reverse=True)
    opened.close()


def test_a_file_that_vanishes_while_a_process_writes_is_noticed_before_it_says_that_all_is_well(tmp_path):
    database = Database(f"sqlite:///{tmp_path}/registry.db")
    with pytest.raises(FilesReplaced), database.writing() as transaction:
        insert_jobs(transaction, [NewJob({})])
        (tmp_path / "registry.db-wal").unlink()
    database.close()


def test_no_connection_is_opened_to_another_database_than_the_first(tmp_path):
    database = Database(f"sqlite:///{tmp_path}/registry.db")
    (tmp_path / "registry.db").rename(tmp_path / "away")
    with pytest.raises(FilesReplaced), database.reading():
        pass
    assert not (tmp_path / "registry.db").exists()
    database.close()


def test_a_database_that_a_process_has_closed_may_change_its_files(tmp_path):
    database = Database(f"sqlite:///{tmp_path}/registry.db")
    database.close()
    assert not (tmp_path / "registry.db-wal").exists()
    with sqlite3.connect(tmp_path / "registry.db"):
        pass
    Registry(database).submit(NewJob({}))
    database.close()
