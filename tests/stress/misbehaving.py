"""What a run must not do, where processes that do it can load it without the solver."""

from __future__ import annotations

import os

from stress.ending import Ending, Result, Task


def misbehave(task: Task) -> Result:
    """Do what the task's place says."""
    if task.at == ("spins",):
        while True:
            pass
    if task.at == ("dies",):
        os.abort()
    return Result(task.group, task.at, Ending.CORRECT)
