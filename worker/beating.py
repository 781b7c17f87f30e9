"""How a worker shows that it gets on: its parent by Celery's own loop, each child by a thread.

The parent's pulse is what the supervisor looks at; the parent looks at its children's, and kills those that stand
still: the pool starts others. Each child tells the registry that there is one who can run a job, and names its parent
as soon as that does not get on, for without it no message comes: long before the supervisor replaces both.
"""

from __future__ import annotations

import logging
import os
import signal
import time
from contextlib import suppress
from pathlib import Path
from typing import Any

from celery import bootsteps
from sqlalchemy.exc import DBAPIError

from service.jobs import Database
from service.jobs.processes import EVERY, Presence
from service.pulse import EVERY as BEAT
from service.pulse import STILL, Listener, Pulse, last_beat, path_of
from service.rounds import Rounds

STUCK = 30.0
"""Seconds after which Celery's loop stands still."""
log = logging.getLogger(__name__)


class Parent:
    """The parent of the pool."""

    def __init__(self, pulses: Path, lease: float) -> None:
        self._pulses, self._pulse = pulses, Pulse(pulses, "worker")
        self._longest = max(STILL, lease)  # a child at work that is not stopped is ended by its fence before
        self._children: dict[int, Listener] = {}
        self._consumer: Any = None
        self._turned = 0.0

    def rounds(self) -> Rounds:
        """A thread that beats while the parent gets on, and looks after its children."""
        return Rounds("beating", BEAT, self.once)

    def once(self) -> None:
        """Beat, unless Celery's loop, once it is connected to the broker, does not turn; then look at the children."""
        consumer = self._consumer
        if consumer is None:
            self._pulse.beat()
        elif time.monotonic() - self._turned < STUCK:
            self._pulse.beat()
            self._look(consumer.pool.info.get("processes", ()))

    def loops(self, consumer: Any) -> None:
        """Celery's loop begins (`consumer`), or is over (None): it does not turn while the broker is away."""
        self._turned, self._consumer = time.monotonic(), consumer

    def turned(self) -> None:
        """Celery's loop turns."""
        self._turned = time.monotonic()

    def _look(self, pids: list[int]) -> None:
        for ended in self._children.keys() - set(pids):
            path_of(self._pulses, "child", ended).unlink(missing_ok=True)
        self._children = {pid: self._children.get(pid) or Listener() for pid in pids}
        for pid, listener in self._children.items():
            if listener.stands_still(last_beat(self._pulses, "child", pid), self._longest):
                log.error("the worker process %d stands still, and is ended", pid)
                with suppress(ProcessLookupError):
                    os.kill(pid, signal.SIGKILL)


def step_of(parent: Parent) -> type[bootsteps.StartStopStep]:
    """A step of Celery's consumer that lets `parent` hear its loop."""

    class Loop(bootsteps.StartStopStep):  # type: ignore[misc]  # celery is untyped
        """Started with each connection to the broker."""

        requires = ("celery.worker.consumer.tasks:Tasks",)

        def start(self, consumer: Any) -> None:
            """Hear it from now on."""
            self._timer = consumer.timer.call_repeatedly(BEAT, parent.turned)
            parent.loops(consumer)

        def stop(self, consumer: Any) -> None:
            """Hear it no more."""
            self._timer.cancel()
            parent.loops(None)

    return Loop


class Child:
    """A process of the pool, which runs one job at a time."""

    def __init__(self, database: Database, pulses: Path, parent: int) -> None:
        self._pulse, self._presence = Pulse(pulses, "child"), Presence(database, "worker")
        self._pulses, self._parent, self._listener = pulses, parent, Listener()
        self._beating = Rounds("beating", BEAT, self._pulse.beat)
        self._presenting = Rounds("presence", EVERY, self._present)  # it may take long where the database is away

    def start(self) -> None:
        """Beat from now on, in the file and in the row."""
        self._beating.start()
        self._presenting.start()

    def end(self) -> None:
        """Be gone."""
        self._presenting.stop()
        with suppress(DBAPIError):
            self._presence.leave()

    def _present(self) -> None:
        silent = self._listener.silent(last_beat(self._pulses, "worker", self._parent))
        self._presence.beat(["parent"] if silent >= STILL / 2 else [])
