"""How far a job is, on a terminal's line."""

from __future__ import annotations

import sys
import time

from hockle_client.documents import JobState


class Line:
    """One line on stderr, written over as the job goes on."""

    def __init__(self) -> None:
        self._since = time.monotonic()
        self._long = 0

    def show(self, job: JobState) -> None:
        """Say how far it is."""
        told = f"{job.title or job.id}: {job.status} {job.progress:4.0%}, t = {job.t:.2f} s, {self._left(job)}"
        print(f"\r{told:{self._long}}", end="\n" if job.ended else "", file=sys.stderr, flush=True)
        self._long = len(told)

    def _left(self, job: JobState) -> str:
        passed = time.monotonic() - self._since
        if job.ended or not 0.0 < job.progress < 1.0:
            return f"{passed:.0f} s"
        return f"{passed * (1.0 - job.progress) / job.progress:.0f} s left"


def show_many(ended: int, jobs: int) -> None:
    """Say on a line of its own how many jobs have ended."""
    print(f"\r{ended} of {jobs} jobs have ended", end="\n" if ended == jobs else "", file=sys.stderr, flush=True)
