"""How a process shows those who look after it that it gets on: by a file that it touches again and again.

A process that is stopped, or whose work stands still, is still there; but its file is not touched any more.
"""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

EVERY = 1.0
"""Seconds between two beats, about."""
STILL = 20.0
"""Seconds without a beat after which a process stands still."""
STARTING = 120.0
"""Seconds that a process may take to its first beat."""
LOOK = 5.0
"""The most that counts of the time between two looks: who looks may have been stopped himself. More than lies between
two looks on a busy machine, else silence would be counted too slowly there."""


class Pulse:
    """The file of this process in `directory`, by its kind and its process id."""

    def __init__(self, directory: Path, kind: str) -> None:
        self._path = path_of(directory, kind, os.getpid())

    def beat(self) -> None:
        """Show that this process gets on. A disk that is full only delays the first beat."""
        with suppress(OSError):
            self._path.touch(mode=0o600)

    def end(self) -> None:
        """Leave no file."""
        self._path.unlink(missing_ok=True)


def path_of(directory: Path, kind: str, pid: int) -> Path:
    """The file of a process. Containers that share the directory may have the same process ids."""
    return directory / f"{kind}-{pid}"


def last_beat(directory: Path, kind: str, pid: int) -> int:
    """What changes with every beat of a process; 0 before the first one."""
    try:
        return path_of(directory, kind, pid).stat().st_mtime_ns
    except FileNotFoundError:
        return 0


class Listener:
    """Hears whether something gets on, by what changes with its every beat; nothing, as 0, is before the first one."""

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._beat: object = None
        self._began = False
        self._looked = clock()
        self._silent = 0.0

    def silent(self, beat: object) -> float:
        """Seconds of looking in which nothing changed."""
        now = self._clock()
        if beat == self._beat:
            self._silent += min(now - self._looked, LOOK)
        else:
            self._beat, self._silent = beat, 0.0
            self._began = self._began or bool(beat)
        self._looked = now
        return self._silent

    def stands_still(self, beat: object, longest: float = STILL) -> bool:
        """Whether it has been silent for too long."""
        return self.silent(beat) > (longest if self._began else max(longest, STARTING))
