"""An owner may ask so often, and no other owner's requests count."""

from __future__ import annotations

import pytest

from service.access.limits import MOST_OWNERS, RateLimit


class Clock:
    now = 0.0

    def __call__(self) -> float:
        return self.now


@pytest.fixture
def clock():
    return Clock()


def test_a_burst_is_allowed_and_then_one_must_wait(clock):
    limit = RateLimit(2.0, 4, clock)
    assert [limit.ask("a").remaining for _ in range(4)] == [3, 2, 1, 0]
    refused = limit.ask("a")
    assert (refused.wait, refused.remaining, refused.reset) == (0.5, 0, 2.0)


def test_tokens_come_back_steadily_and_never_above_the_burst(clock):
    limit = RateLimit(2.0, 4, clock)
    for _ in range(4):
        limit.ask("a")
    clock.now = 0.5
    assert limit.ask("a").wait == 0.0
    assert limit.ask("a").wait > 0.0
    clock.now = 1000.0
    assert limit.ask("a").remaining == 3


def test_over_a_long_time_no_more_than_the_rate_is_allowed(clock):
    limit, allowed = RateLimit(5.0, 10, clock), 0
    for tick in range(10_000):
        clock.now = tick * 0.01
        allowed += limit.ask("a").wait == 0.0
    assert allowed == pytest.approx(10 + 5 * 100, abs=1)


def test_owners_do_not_share(clock):
    limit = RateLimit(1.0, 1, clock)
    limit.ask("a")
    assert limit.ask("a").wait > 0.0 and limit.ask("b").wait == 0.0


def test_it_does_not_grow_without_bound(clock):
    limit = RateLimit(1.0, 1, clock)
    for number in range(MOST_OWNERS + 50):
        limit.ask(str(number))
    assert len(limit._buckets) == MOST_OWNERS
