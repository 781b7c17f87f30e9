"""A worker that is told to stop (SIGTERM) while it has a job hands it back between two steps."""

from __future__ import annotations

import signal
import sys
from collections.abc import Iterator
from contextlib import contextmanager

_asked = False


class Stopping(Exception):
    """This worker has been told to stop, or its job to give way."""


@contextmanager
def at_work() -> Iterator[None]:
    """While the block runs, SIGTERM is only noted, for `check`; at its end the process stops if one came."""
    global _asked
    _asked = False
    before = signal.signal(signal.SIGTERM, _note)  # the pool's own would end the process in the middle of a step
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)
        if _asked:
            sys.exit(0)


def check() -> None:
    """Raise Stopping if this process has been told to stop."""
    if _asked:
        raise Stopping("this worker was told to stop")


def _note(*_: object) -> None:
    global _asked
    _asked = True
