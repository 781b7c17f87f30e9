"""A job's progress, as a bar."""

from __future__ import annotations

import sys
from collections.abc import Iterable
from time import monotonic
from typing import Any

from rich.console import Console
from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeElapsedColumn


class Pace:
    """How long the rest of the work takes, if it goes on as it did since progress was first reported."""

    def __init__(self) -> None:
        self._first: tuple[float, float] | None = None

    def remaining(self, progress: float, now: float) -> float | None:
        """Seconds that are left at this progress (0 to 1) and time (s); None while it cannot be said."""
        if self._first is None or progress <= self._first[1]:  # what came before the first progress does not count
            self._first = now, progress
        since, before = self._first
        return (1.0 - progress) * (now - since) / (progress - before) if progress > before else None


def show(jobs: Iterable[dict[str, Any]]) -> dict[str, Any]:
    """Show a job as it is followed to its end; returns its last state.

    Where there is a `phase`, it is shown with the status.
    """
    columns = (TextColumn("{task.description}"), BarColumn(), TaskProgressColumn(),
               TextColumn("t = {task.fields[t]:.2f} s"), TimeElapsedColumn(), TextColumn("{task.fields[left]}"))
    job: dict[str, Any] = {}
    pace = Pace()
    with Progress(*columns, console=Console(file=sys.stderr)) as bar:
        task = bar.add_task("accepted", total=1.0, t=0.0, left="")
        for job in jobs:
            described = ": ".join(filter(None, (job["status"], job.get("phase", ""))))
            left = None if job["status"] == "accepted" else pace.remaining(job["progress"], monotonic())
            bar.update(task, completed=job["progress"], t=job["t"], description=described, left=_clock(left))
    return job


def _clock(left: float | None) -> str:
    """The remaining seconds as a clock shows them."""
    if left is None:
        return ""
    minutes, seconds = divmod(round(left), 60)
    return f"{minutes // 60}:{minutes % 60:02}:{seconds:02} left"
