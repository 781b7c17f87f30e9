"""Looks, many times a second, whether two processes of this machine compute the same job."""

from __future__ import annotations

import os
import threading
from contextlib import suppress
from pathlib import Path

from service.settings import Settings

EVERY = 0.05


class Watch:
    """Counts overlaps: two processes that each hold a lock, on files that are or were a job's lock file."""

    def __init__(self, settings: Settings) -> None:
        self._locks = str(settings.locks.absolute())
        self.looks, self.overlaps = 0, 0
        self._stopped = threading.Event()
        self._thread = threading.Thread(target=self._run)

    def __enter__(self) -> Watch:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._stopped.set()
        self._thread.join()

    def _run(self) -> None:
        while not self._stopped.wait(EVERY):
            holders = [job for pid in _holders() for job in self._held(pid)]
            self.looks += 1
            self.overlaps += len(holders) - len(set(holders))

    def _held(self, pid: int) -> set[str]:
        """The jobs whose lock a process holds."""
        held: set[str] = set()
        for descriptor in _descriptors(pid):
            with suppress(OSError):
                name = str(Path(f"/proc/{pid}/fd/{descriptor}").readlink()).removesuffix(" (deleted)")
                locked = "FLOCK" in Path(f"/proc/{pid}/fdinfo/{descriptor}").read_text()
                if locked and name.startswith(self._locks) and name.endswith(".lock"):
                    held.add(name)
        return held


def _holders() -> set[int]:
    """All processes of this machine that hold a lock of this kind, those that nobody looks after any more included."""
    lines = (line.split() for line in Path("/proc/locks").read_text().splitlines())
    return {int(words[4]) for words in lines if words[1] == "FLOCK"}


def _descriptors(pid: int) -> list[str]:
    with suppress(OSError):
        return os.listdir(f"/proc/{pid}/fd")  # noqa: PTH208  # names only
    return []
