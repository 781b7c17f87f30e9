"""One job, one process on this machine: a lock that the system frees when its holder dies."""

from __future__ import annotations

import fcntl
import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

WIDTH = 20


@dataclass(frozen=True)
class JobLock:
    """A held lock. `left` is the steps that its last holder had marked when it died, 0 if none did."""

    file: int
    left: int

    def mark(self, steps: int) -> None:
        """Tell the next holder how far this one came, should it die: some microseconds, no way to the disk.

        Where there is no room for it less is known of what was lost; no run ends for that.
        """
        with suppress(OSError):
            os.pwrite(self.file, b"%*d" % (WIDTH, steps), 0)


@contextmanager
def job_lock(path: Path) -> Iterator[JobLock | None]:
    """Hold the lock file `path` while the block runs; yields None if another process holds it.

    The file is removed at the end: by then the job has ended, or its row says who may take it.
    """
    file = os.open(path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o600)
    try:
        if not (_locked(file) and _is_same_file(path, file)):
            yield None
            return
        try:
            yield JobLock(file, int(os.pread(file, WIDTH, 0) or 0))
        finally:
            path.unlink(missing_ok=True)
    finally:
        os.close(file)


def _locked(file: int) -> bool:
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    return True


def _is_same_file(path: Path, file: int) -> bool:
    """Whether `path` is still the file that was opened: its last holder may have removed it since."""
    try:
        return os.path.samestat(path.stat(), os.fstat(file))
    except FileNotFoundError:
        return False
