"""How often an owner may ask: a bucket of tokens that fills steadily."""

from __future__ import annotations

import time
from collections import OrderedDict
from collections.abc import Callable
from dataclasses import dataclass

MOST_OWNERS = 10_000


@dataclass(frozen=True)
class Grant:
    """What is left of an owner's requests: `remaining` now, all of `burst` again after `reset` (s).

    `window`: how long an empty bucket takes to fill (s). `wait` (s) is 0 where the request is allowed, else how long
    to wait for the next one.
    """

    burst: int
    window: float
    remaining: int
    reset: float
    wait: float


class RateLimit:
    """At most `rate` requests a second for each owner over time, and `burst` at once.

    It counts within this process only.
    """

    def __init__(self, rate: float, burst: int, clock: Callable[[], float] = time.monotonic) -> None:
        self._rate, self._burst, self._clock = rate, burst, clock
        self._buckets: OrderedDict[str, tuple[float, float]] = OrderedDict()

    def ask(self, owner: str) -> Grant:
        """Take one token of `owner`'s, if there is one."""
        now = self._clock()
        tokens, since = self._buckets.pop(owner, (float(self._burst), now))
        tokens = min(float(self._burst), tokens + (now - since) * self._rate)
        allowed = tokens >= 1.0
        left = tokens - 1.0 if allowed else tokens
        self._buckets[owner] = left, now
        if len(self._buckets) > MOST_OWNERS:
            self._buckets.popitem(last=False)
        wait = 0.0 if allowed else (1.0 - left) / self._rate
        return Grant(self._burst, self._burst / self._rate, int(left), (self._burst - left) / self._rate, wait)
