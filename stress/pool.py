"""Tasks on two processes that are used again and again; one that hangs or dies is told from one that ends."""

from __future__ import annotations

import resource
from collections.abc import Callable, Iterable, Iterator
from math import ceil
from multiprocessing import get_context
from multiprocessing.connection import Connection, wait
from multiprocessing.context import SpawnProcess
from signal import SIGXCPU
from time import monotonic, process_time

from stress.ending import Ending, Result, Task

PROCESSES = 2
GRACE = 20.0
"""CPU seconds beyond its budget after which a run that does not stop by itself hangs: it looks at every step."""
WALL = 10.0
"""Wall-clock seconds to a CPU second, and as many minutes more, after which a run that uses no CPU hangs."""

Work = Callable[[Task], Result]


def _serve(work: Work, line: Connection) -> None:
    """Do the tasks that come along the line; the system ends the process (SIGXCPU) when one hangs."""
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    _, hard = resource.getrlimit(resource.RLIMIT_CPU)
    while (given := line.recv()) is not None:
        task, limit = given
        resource.setrlimit(resource.RLIMIT_CPU, (ceil(process_time() + limit), hard))
        line.send(work(task))


class Child:
    """One process and the task that it is at."""

    def __init__(self, work: Work, grace: float) -> None:
        self._work, self._grace = work, grace
        self.task: Task | None = None
        self._deadline = 0.0
        self._start()

    def _start(self) -> None:
        context = get_context("spawn")
        self.line, theirs = context.Pipe()
        self._process: SpawnProcess = context.Process(target=_serve, args=(self._work, theirs), daemon=True)
        self._process.start()
        theirs.close()

    def give(self, task: Task) -> None:
        """Have a task done."""
        limit = task.cpu + self._grace
        self.task, self._deadline = task, monotonic() + WALL * (60.0 + limit)
        self.line.send((task, limit))

    def take(self) -> Result | None:
        """The result of the task, if there is one: a process that died or hangs is ended and started anew."""
        assert self.task is not None
        task = self.task
        if self.line.poll():
            try:
                result: Result = self.line.recv()
            except (EOFError, ConnectionError):
                self._process.join()
                result = self._lost(task)
                self._start()
        elif monotonic() > self._deadline:
            self._process.kill()
            self._process.join()
            result = Result(task.group, task.at, Ending.HANG, detail="without using the CPU")
            self._start()
        else:
            return None
        self.task = None
        return result

    def _lost(self, task: Task) -> Result:
        code = self._process.exitcode
        if code == -SIGXCPU:
            return Result(task.group, task.at, Ending.HANG, detail=f"more than {task.cpu:g} CPU s", cpu=task.cpu)
        return Result(task.group, task.at, Ending.CRASH, detail=f"the process ended with {code}")

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
            wait([child.line for child in children if child.task], timeout=5.0)
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
