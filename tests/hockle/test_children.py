"""A child that dies, or stands still, is started again; one that dies again and again after longer pauses."""

from __future__ import annotations

import os
import signal
import sys
import tempfile
from pathlib import Path

import pytest

from hockle.broker import short_directory
from hockle.children import LONGEST_PAUSE, Child, pause_after
from service.pulse import Listener

SLEEPS = [sys.executable, "-c", "import time; time.sleep(600)"]


@pytest.fixture
def child(tmp_path: Path):
    made = Child("one", SLEEPS, tmp_path / "log", beat=lambda pid: pid)
    made.start()
    yield made
    if made.process is not None:
        made.process.kill()
    made.make_stop()


def test_a_child_that_gets_on_is_left_alone(child):
    before = child.process.pid
    assert child.look_after() == ""
    assert child.process.pid == before


def test_a_child_that_is_stopped_is_ended_and_started_again(child, monkeypatch, is_alive):
    before = child.process.pid
    os.kill(before, signal.SIGSTOP)
    with monkeypatch.context() as silent:
        silent.setattr(Listener, "stands_still", lambda *_: True)
        assert child.look_after() == "stood still and is started again"
    assert not is_alive(before)
    assert child.look_after() == ""
    assert child.process.pid != before


def test_a_child_that_dies_again_and_again_is_started_after_longer_pauses(child, monkeypatch):
    now = 0.0
    monkeypatch.setattr("hockle.children.time.monotonic", lambda: now)
    pauses = []
    for _ in range(7):
        child.process.kill()
        child.process.wait()
        assert "died" in child.look_after()
        began = now
        while child.process is None:
            now += 0.125
            child.look_after()
        pauses.append(now - began)
    assert pauses[0] <= 0.125
    assert pauses[1:] == [1.0, 2.0, 4.0, 8.0, 16.0, 30.0]


def test_pauses_are_bounded():
    assert pause_after(0) == 0.0
    assert pause_after(50) == LONGEST_PAUSE


def test_the_directory_of_a_broker_that_was_killed_is_removed_by_the_next_one(tmp_path):
    killed = short_directory(tmp_path)  # entered, and never left again
    left = killed.__enter__()
    assert left.is_dir()
    with short_directory(tmp_path) as made:
        assert not left.exists()
        assert made.is_dir()
    assert not made.exists()


def test_what_is_no_directory_of_a_broker_is_not_removed(tmp_path):
    mine = Path(tempfile.mkdtemp(dir=tmp_path))
    (tmp_path / "socket-directory").write_text(str(mine))
    with short_directory(tmp_path):
        assert mine.is_dir()
