"""Looks, many times a second, whether two processes of this machine compute the same job."""

from __future__ import annotations

import os
from contextlib import AbstractContextManager, suppress
from pathlib import Path

from chaos.repeated import repeated
from service.settings import Settings

EVERY = 0.05


class Watch:
    """Counts overlaps: two processes that each hold a lock, on files that are or were a job's lock file."""

    def __init__(self, settings: Settings) -> None:
        self._locks = str(settings.locks.absolute())
        self.looks, self.overlaps = 0, 0

    def looking(self) -> AbstractContextManager[None]:
        """Within it, looks are taken."""
        return repeated(EVERY, self._look)

    def _look(self) -> None:
        holders = [job for pid in _holders() for job in self._locked_by(pid)]
        self.looks += 1
        self.overlaps += len(holders) - len(set(holders))

    def _locked_by(self, pid: int) -> set[str]:
        """The jobs whose lock a process holds."""
        jobs: set[str] = set()
        for descriptor in _descriptors(pid):
            with suppress(OSError):
                name = str(Path(f"/proc/{pid}/fd/{descriptor}").readlink()).removesuffix(" (deleted)")
                locked = "FLOCK" in Path(f"/proc/{pid}/fdinfo/{descriptor}").read_text()
                if locked and name.startswith(self._locks) and name.endswith(".lock"):
                    jobs.add(name)
        return jobs


def _holders() -> set[int]:
    """All processes of this machine that hold a lock of this kind, those that nobody looks after any more included."""
    lines = (line.split() for line in Path("/proc/locks").read_text().splitlines())
    return {int(words[4]) for words in lines if words[1] == "FLOCK"}


def _descriptors(pid: int) -> list[str]:
    with suppress(OSError):
        return os.listdir(f"/proc/{pid}/fd")  # noqa: PTH208  # names only
    return []
