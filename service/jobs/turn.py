"""Whose turn it is to write next: SQLite itself keeps no queue."""

from __future__ import annotations

import fcntl
import os
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress

LONGEST = 0.2
"""Seconds for which a turn is waited for: whoever has it may have been stopped."""
LOOK = 0.001


@contextmanager
def turn(path: str) -> Iterator[None]:
    """Be the only one, of all threads and processes, who waits for the database's lock.

    Who has just written and would write again waits here while another one waits there, and so lets it go first. It
    is a courtesy, not a lock: no turn after LONGEST, or no file, and one goes on without. The file `path` is locked
    by flock, which ends with its holder, however that ends.
    """
    file = _open(path)
    try:
        if file is not None:
            _take(file)
        yield
    finally:
        if file is not None:
            with suppress(OSError):
                fcntl.flock(file, fcntl.LOCK_UN)  # closing leaves it to a child forked in the meantime
            os.close(file)


def _open(path: str) -> int | None:
    try:
        return os.open(path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o600)
    except OSError:  # a full disk, too many open files: the database will say so
        return None


def _take(file: int) -> None:
    deadline = time.monotonic() + LONGEST
    while time.monotonic() < deadline:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            time.sleep(LOOK)
        except OSError:
            return
        else:
            return
