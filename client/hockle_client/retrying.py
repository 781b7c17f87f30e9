"""When a request is made again."""

from __future__ import annotations

import random
import time

from hockle_client.problems import HockleError

FIRST, LONGEST = 0.1, 5.0
"""Seconds between tries: twice as many each time, about."""


class Retries:
    """The tries of one request: the last one ends with the error, at most `patience` seconds after the first."""

    def __init__(self, patience: float) -> None:
        self._patience = patience
        self.begin()

    def begin(self) -> None:
        """Count from here: the server has answered."""
        self._tries, self._deadline = 0, time.monotonic() + self._patience

    def after(self, error: HockleError) -> float:
        """How long to wait until the next try, in seconds. Raises `error` if there is none."""
        if not error.temporary:
            raise error
        wait = error.retry_after
        if wait is None:
            wait = min(LONGEST, FIRST * 2**self._tries) * random.uniform(0.5, 1.0)  # noqa: S311  (not a secret)
        if time.monotonic() + wait > self._deadline:
            raise error
        self._tries += 1
        return wait
