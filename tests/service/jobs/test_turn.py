"""Writers take turns, and one that is stopped or gone holds nobody up."""

from __future__ import annotations

import fcntl
import os
import subprocess
import sys
import threading
import time

import pytest

from service.jobs import Database, NewJob, Registry

HOLDER = """
import fcntl, sys, time
file = open(sys.argv[1], "w")
fcntl.flock(file, fcntl.LOCK_EX)
print("taken", flush=True)
time.sleep(600)
"""


@pytest.fixture
def path(tmp_path):
    return tmp_path / "registry.db-turn"


@pytest.fixture
def database(tmp_path):
    database = Database(f"sqlite:///{tmp_path}/registry.db")
    yield database
    database.close()


def taken(path) -> bool:
    with path.open("w") as file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            return True
    return False


def wait_until_taken(path) -> None:
    deadline = time.monotonic() + 10.0
    while not taken(path):
        assert time.monotonic() < deadline, "nobody waits in turn"
        time.sleep(0.001)


def test_who_has_just_written_lets_the_one_who_waits_go_first(database, path):
    order: list[str] = []

    def other() -> None:
        with database.writing():
            order.append("other")

    for _ in range(10):
        with database.writing():
            order.append("first")
            thread = threading.Thread(target=other)
            thread.start()
            wait_until_taken(path)
        with database.writing():
            order.append("again")
        thread.join()
    assert order == ["first", "other", "again"] * 10


@pytest.fixture
def holder(database, path):
    """Another process, whose turn it is."""
    process = subprocess.Popen([sys.executable, "-c", HOLDER, str(path)], stdout=subprocess.PIPE)
    assert process.stdout is not None
    process.stdout.readline()
    yield process
    process.kill()
    process.wait()


def test_a_turn_that_is_never_over_is_not_waited_for_without_end(database, holder):
    job = Registry(database).submit(NewJob({}))
    assert Registry(database).get(job.id) == job


def test_a_turn_ends_with_the_process_that_had_it(holder, path):
    assert taken(path)
    holder.kill()
    holder.wait()
    assert not taken(path)


def test_a_turn_is_not_inherited_by_a_forked_child(database, path):
    read, write = os.pipe()
    with database.writing():
        waiting = threading.Thread(target=lambda: Registry(database).submit(NewJob({})))
        waiting.start()
        wait_until_taken(path)
        if (child := os.fork()) == 0:
            os.read(read, 1)
            os._exit(0)
    waiting.join()
    assert not taken(path)
    os.write(write, b"x")
    os.waitpid(child, 0)
    os.close(read)
    os.close(write)
