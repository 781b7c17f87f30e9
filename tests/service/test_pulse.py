"""Whether something gets on is heard by what changes, not by whether it is there."""

from __future__ import annotations

import os

import pytest

from service.pulse import STARTING, STILL, Listener, Pulse, last_beat


class Clock:
    now = 0.0

    def __call__(self) -> float:
        return self.now


@pytest.fixture
def clock() -> Clock:
    return Clock()


def looked(listener: Listener, clock: Clock, beat: object, seconds: float) -> bool:
    """Look at the same beat every second for so long; whether it stands still then."""
    still = False
    for _ in range(int(seconds)):
        clock.now += 1.0
        still = listener.stands_still(beat)
    return still


def test_what_changes_gets_on_and_what_does_not_stands_still(clock):
    listener = Listener(clock)
    for beat in range(1, 100):
        clock.now += 0.9 * STILL
        assert not listener.stands_still(beat)
    assert looked(listener, clock, beat, 1.2 * STILL)
    assert not listener.stands_still(beat + 1)


def test_what_is_starting_has_time(clock):
    listener = Listener(clock)
    assert not looked(listener, clock, 0, 0.9 * STARTING)
    assert looked(listener, clock, 0, 0.2 * STARTING)


def test_what_does_not_answer_any_more_is_not_starting(clock):
    listener = Listener(clock)
    assert not listener.stands_still(1.5)
    assert looked(listener, clock, None, 1.2 * STILL)


def test_time_in_which_nobody_looked_does_not_count(clock):
    """As when the one who looks was stopped, and all others with him."""
    listener = Listener(clock)
    assert not listener.stands_still(2)
    clock.now += 100 * STILL
    assert not listener.stands_still(2)


def test_a_pulse_changes_with_every_beat_and_leaves_nothing(tmp_path):
    pulse = Pulse(tmp_path, "api")
    assert last_beat(tmp_path, "api", os.getpid()) == 0
    pulse.beat()
    first = last_beat(tmp_path, "api", os.getpid())
    os.utime(tmp_path / f"api-{os.getpid()}", ns=(first - 10**9, first - 10**9))
    pulse.beat()
    assert last_beat(tmp_path, "api", os.getpid()) >= first > 0
    pulse.end()
    assert list(tmp_path.iterdir()) == []
