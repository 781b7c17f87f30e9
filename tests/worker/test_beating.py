"""A child of the pool tells the registry that its parent stands still, long before the supervisor replaces both."""

from __future__ import annotations

import os

import pytest

from service.jobs.processes import Roll
from service.pulse import path_of
from worker import beating


@pytest.fixture(autouse=True)
def quick(monkeypatch):
    monkeypatch.setattr(beating, "EVERY", 0.01)
    monkeypatch.setattr(beating, "STILL", 1.0)


def test_a_parent_that_stands_still_is_named_and_runs_no_job_until_it_gets_on(registry, settings, until):
    parent = path_of(settings.pulses, "worker", 1)
    child = beating.Child(registry.database, settings.pulses, 1)
    roll = Roll()

    def heard() -> tuple[int, bool]:
        roll.call(registry.database)
        return roll.workers, any(name.endswith(f":{os.getpid()} parent") for name in roll.silent)

    def gets_on() -> bool:
        parent.touch()
        return heard() == (1, False)

    child.start()
    try:
        until(gets_on, "it is there")
        until(lambda: heard() == (0, True), "its parent is said to stand still")
        until(gets_on, "its parent gets on again")
    finally:
        child.end()
    assert heard() == (0, False)
