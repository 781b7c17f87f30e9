"""A job's progress, as a bar."""

from __future__ import annotations

import sys
from collections.abc import Iterable
from typing import Any

from rich.console import Console
from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeElapsedColumn


def show(jobs: Iterable[dict[str, Any]]) -> dict[str, Any]:
    """Show a job as it is followed to its end; gives what was said of it last."""
    columns = (TextColumn("{task.description}"), BarColumn(), TaskProgressColumn(),
               TextColumn("t = {task.fields[t]:.2f} s"), TimeElapsedColumn())
    job: dict[str, Any] = {}
    with Progress(*columns, console=Console(file=sys.stderr)) as bar:
        task = bar.add_task("accepted", total=1.0, t=0.0)
        for job in jobs:
            bar.update(task, completed=job["progress"], t=job["t"], description=job["status"])
    return job
