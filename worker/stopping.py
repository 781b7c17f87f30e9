"""A worker that is told to stop (SIGTERM) while it has a job hands it back between two steps. One whose pool is told to
stop finishes its job, and takes no other."""

from __future__ import annotations

import mmap
import signal
import sys
from collections.abc import Iterator
from contextlib import contextmanager

_asked = False
_pool_ends = mmap.mmap(-1, 1)
"""Memory that the processes of a pool share with the one that forked them."""


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


def end_pool() -> None:
    """Have the processes that this one has forked take no more jobs."""
    _pool_ends[0] = True


def pool_ends() -> bool:
    """Whether this process, one of a pool, is to take no more jobs."""
    return bool(_pool_ends[0])


def check() -> None:
    """Raise Stopping if this process has been told to stop."""
    if _asked:
        raise Stopping("this worker was told to stop")


def _note(*_: object) -> None:
    global _asked
    _asked = True
