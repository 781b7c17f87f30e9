"""Tasks on two processes that are used again and again; one that hangs or dies is told from one that ends.

CPU time is read from /proc, which says what the scheduler has counted, as `time.process_time` does. RLIMIT_CPU goes by
timer ticks instead: beside other work a process limited to 25 s was ended after 21.5 s, and in processes that had run
for minutes, runs of a second or less were called hangs.
"""

from __future__ import annotations

import os
import resource
from collections.abc import Callable, Iterable, Iterator
from multiprocessing import get_context
from multiprocessing.connection import Connection, wait
from multiprocessing.context import SpawnProcess
from pathlib import Path
from time import monotonic

from stress.ending import Ending, Result, Task

PROCESSES = 2
GRACE = 20.0
"""CPU seconds beyond its budget after which a run that does not stop by itself hangs: it looks at every step."""
LOOK = 5.0
"""Seconds between looks at processes that say nothing."""
WALL = 10.0
"""Wall-clock seconds to a CPU second, and as many minutes more, after which a run that uses no CPU hangs."""

TICKS = os.sysconf("SC_CLK_TCK")

READY = "ready"

Work = Callable[[Task], Result]


def _serve(work: Work, line: Connection) -> None:
    """Do the tasks that come along the line."""
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    line.send(READY)
    while True:
        line.send(work(line.recv()))


class Child:
    """One process and the task that it is at."""

    def __init__(self, work: Work, grace: float) -> None:
        self._work, self._grace = work, grace
        self.task: Task | None = None
        self._deadline = self._limit = 0.0
        self._start()

    def _start(self) -> None:
        context = get_context("spawn")
        self.line, child_line = context.Pipe()
        self._process: SpawnProcess = context.Process(target=_serve, args=(self._work, child_line), daemon=True)
        self._process.start()
        child_line.close()
        self.line.recv()  # what it takes to start is not the task's

    def give(self, task: Task) -> None:
        """Have a task done."""
        allowed = task.cpu + self._grace
        self.task, self._limit = task, self._used() + allowed
        self._deadline = monotonic() + WALL * (60.0 + allowed)
        self.line.send(task)

    def take(self) -> Result | None:
        """The result of the task, if there is one: a process that died or hangs is ended and started anew."""
        assert self.task is not None
        task = self.task
        if self.line.poll():
            try:
                result: Result = self.line.recv()
            except (EOFError, ConnectionError):
                self._process.join()
                detail = f"the process ended with {self._process.exitcode}"
                result = Result(task.group, task.at, Ending.CRASH, detail=detail)
                self._start()
        elif self._used() > self._limit:
            result = self._hangs(task, f"more than {task.cpu:g} CPU s")
        elif monotonic() > self._deadline:
            result = self._hangs(task, "without using the CPU")
        else:
            return None
        self.task = None
        return result

    def _used(self) -> float:
        """CPU seconds that the process has used."""
        fields = Path(f"/proc/{self._process.pid}/stat").read_text().rpartition(")")[2].split()
        return (int(fields[11]) + int(fields[12])) / TICKS  # utime, stime

    def _hangs(self, task: Task, detail: str) -> Result:
        self.close()
        self._start()
        return Result(task.group, task.at, Ending.HANG, detail=detail, cpu=task.cpu)

    def close(self) -> None:
        """End the process."""
        self._process.kill()
        self._process.join()


def results(work: Work, tasks: Iterable[Task], grace: float = GRACE) -> Iterator[tuple[Task, Result]]:
    """Every task with its result, as they come. `work` must be a function of a module."""
    children = [Child(work, grace) for _ in range(PROCESSES)]
    waiting = iter(tasks)
    try:
        for child in children:
            _next(child, waiting)
        while any(child.task for child in children):
            wait([child.line for child in children if child.task], timeout=LOOK)
            for child in (child for child in children if child.task):
                task, result = child.task, child.take()
                if task is not None and result is not None:
                    _next(child, waiting)
                    yield task, result
    finally:
        for child in children:
            child.close()


def _next(child: Child, waiting: Iterator[Task]) -> None:
    task = next(waiting, None)
    if task is not None:
        child.give(task)
