"""What is kept no longer: by age, by the bytes of an owner, by the room on the disk; never what is pinned."""

from __future__ import annotations

from collections import namedtuple

import pytest

from service.jobs import Database, Dataset, DeletedJob, NewJob, Reached, Registry, Status
from service.jobs.audit import Actor, trail
from service.jobs.held import claim
from service.jobs.reconciler import recount
from service.jobs.submission import QuotaReached, Submission, Terms, submit_all
from service.jobs.tables import owners
from service.results import Datasets
from service.settings import Settings
from service.store.keeper import Keeper
from service.store.removal import remove_files
from service.store.retention import YOUNGEST, overdue, retain

DAY = 86400.0
Room = namedtuple("Room", "free")


class Clock:
    now = 1e9

    def __call__(self) -> float:
        return self.now


@pytest.fixture
def clock():
    return Clock()


@pytest.fixture
def settings(tmp_path, tables):
    settings = Settings(data=tmp_path)
    settings.make_directories()
    return settings


@pytest.fixture
def database(settings, clock):
    database = Database(settings.database_url, clock)
    yield database
    database.close()


@pytest.fixture
def ended(database, settings, clock):
    """Ends a job of an owner with a dataset of some bytes, a second after the one before."""

    def end(owner: str, size: int, status: Status = Status.SUCCESSFUL) -> str:
        job = Registry(database).submit(NewJob({}, owner=owner))
        file = settings.datasets / f"{job.id}.1.nc"
        file.write_bytes(b"x" * size)
        clock.now += 1
        claim(database, job.id, 9.0, "here").finish(
            status, "completed", "", Dataset(file.name, "", size, "a stamp"), Reached())
        return job.id

    return end


def kept(settings, **rules):
    return Settings(data=settings.data, **rules)


def test_without_rules_everything_is_kept(database, settings, clock, ended):
    ended("alice", 10)
    assert overdue(database, settings, clock.now + 1e9) == []


def test_what_is_older_than_it_is_kept_goes(database, settings, clock, ended):
    old = ended("alice", 10)
    clock.now += 2 * DAY
    ended("alice", 10)
    clock.now += YOUNGEST + 1
    assert retain(database, kept(settings, keep_days=1.0), clock.now) == [old]
    with pytest.raises(DeletedJob) as gone:
        Registry(database).get(old)
    assert (gone.value.job.deleted, gone.value.job.deleted_by) == (clock.now, "retention")
    assert [(deed.owner, deed.action, deed.subject) for deed in trail(database, 1)] == [
        ("retention", "job_deleted", old)]


def test_of_an_owner_with_too_many_bytes_the_oldest_go_and_nobody_elses(database, settings, clock, ended):
    ended("bob", 19)
    first, second, _ = (ended("alice", 10) for _ in range(3))
    clock.now += YOUNGEST + 1
    assert overdue(database, kept(settings, keep_bytes=20), clock.now) == [first]
    assert overdue(database, kept(settings, keep_bytes=19), clock.now) == [first, second]


def test_where_the_disk_has_too_little_room_the_oldest_of_all_go(database, settings, clock, ended, monkeypatch):
    first, second, _ = ended("bob", 10), ended("alice", 10), ended("bob", 10)
    clock.now += YOUNGEST + 1
    monkeypatch.setattr("shutil.disk_usage", lambda _: Room(100))
    assert overdue(database, kept(settings, keep_free=115), clock.now) == [first, second]
    assert overdue(database, kept(settings, keep_free=100), clock.now) == []


def test_what_is_pinned_unfinished_or_has_just_ended_stays(database, settings, clock, ended):
    pinned = ended("alice", 10)
    Registry(database).pin(pinned, True, Actor("alice"))
    Registry(database).submit(NewJob({}, owner="alice"))
    rules = kept(settings, keep_days=1e-6, keep_bytes=1, keep_free=10**18)
    clock.now += DAY
    just = ended("alice", 10)
    assert overdue(database, rules, clock.now) == []
    clock.now += YOUNGEST + 1
    assert overdue(database, rules, clock.now) == [just]


def test_a_removal_that_was_interrupted_is_gone_on_with(database, settings, clock, ended, monkeypatch):
    job_id = ended("alice", 10)
    file = settings.datasets / f"{job_id}.1.nc"
    datasets = Datasets(settings.datasets, settings.copies)
    Registry(database).delete(job_id, Actor("alice"))
    with monkeypatch.context() as broken:
        broken.setattr(Datasets, "discard", lambda *_: (_ for _ in ()).throw(OSError("away")))
        remove_files(database, datasets)
    assert file.exists()
    Keeper(database, datasets, settings).once()
    assert not file.exists()


def test_the_bytes_of_an_owner_are_counted_and_set_right(database, settings, ended):
    from sqlalchemy import select, update

    def counted() -> int:
        with database.reading() as connection:
            return connection.scalar(select(owners.c.bytes))

    first, _ = ended("alice", 10), ended("alice", 5)
    assert counted() == 15
    Registry(database).delete(first, Actor("alice"))
    assert counted() == 5
    with database.writing() as transaction:
        transaction.connection.execute(update(owners).values(bytes=77))
    recount(database)
    assert counted() == 5


def test_who_has_all_the_bytes_that_an_owner_may_have_submits_nothing_until_some_are_deleted(database, ended):
    job_id = ended("alice", 10)

    def submit() -> object:
        with database.writing() as transaction:
            return submit_all(transaction, [Submission(NewJob({}, owner="alice"), Actor("alice"))], Terms(9, 10))[0]

    refusal = submit()
    assert isinstance(refusal, QuotaReached) and "alice has 10 bytes of datasets, and may have 10" in str(refusal)
    Registry(database).delete(job_id, Actor("alice"))
    assert submit().owner == "alice"


def test_the_keeper_notices_a_dataset_that_is_lost(database, settings, ended):
    job_id = ended("alice", 10)
    (settings.datasets / f"{job_id}.1.nc").unlink()
    Keeper(database, Datasets(settings.datasets, settings.copies), settings).once()
    assert Registry(database).get(job_id).dataset.fault == "missing"
