"""How far jobs are, on a terminal's line."""

from __future__ import annotations

import sys
import time

from hockle_client.documents import JobState


class Line:
    """One line on stderr, written over as jobs go on."""

    def __init__(self) -> None:
        self._since = time.monotonic()
        self._first: float | None = None
        """The part that was done when it was first looked at."""
        self._long = 0

    def show(self, job: JobState) -> None:
        """Say how far a job is."""
        text = f"{job.title or job.id}: {job.status} {job.progress:4.0%}, t = {job.t:.2f} s"
        self._write(text, job.progress, job.ended)

    def show_many(self, ended: int, jobs: int) -> None:
        """Say how many jobs have ended."""
        self._write(f"{ended} of {jobs} jobs have ended", ended / max(jobs, 1), ended == jobs)

    def _write(self, text: str, progress: float, ended: bool) -> None:
        text = f"{text}, {self._time(progress, ended)}"
        print(f"\r{text:{self._long}}", end="\n" if ended else "", file=sys.stderr, flush=True)
        self._long = len(text)

    def _time(self, progress: float, ended: bool) -> str:
        """The seconds that passed, or, where that can be known, those that are left."""
        passed = time.monotonic() - self._since
        self._first = progress if self._first is None else self._first
        if ended or progress <= self._first:
            return f"{passed:.0f} s"
        return f"{passed * (1.0 - progress) / (progress - self._first):.0f} s left"
