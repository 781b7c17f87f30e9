"""Keeps a running job's lease while its steps are computed, and brings back what must end the run."""

from __future__ import annotations

import logging
import threading
import time
from dataclasses import replace

from service.jobs import Reached
from service.jobs.held import HeldJob, Wish
from worker import fence

RENEWAL = 0.5
FENCE = 0.75
"""The part of the lease after which a process that could not renew it is ended."""

log = logging.getLogger(__name__)


class Cancelled(Exception):
    """The owner of the job does not want it any more."""


class LeaseLost(Exception):
    """The job is another worker's now: nothing more may be written for it."""


class OutOfTime(Exception):
    """The job has run for longer than it may."""


class Lease:
    """Renews the lease of a job from a thread of its own, so that a long step does not lose it.

    A process that stalls, or is stopped and goes on later, cannot know that its job was given away
    meanwhile. So the kernel ends it before the lease is over, unless a renewal puts that off.
    """

    def __init__(self, held: HeldJob, seconds: float, since: float) -> None:
        """`since` is when the claim was asked for (time.monotonic)."""
        self._held, self._seconds = held, seconds
        self._started = since
        self._reached = held.job.reached
        self._verdict: Exception | None = None
        self.gives_way = False
        """Whether the job is to be handed back with a checkpoint, for others to run."""
        self._stopped = threading.Event()
        self._thread = threading.Thread(target=self._keep, name=f"lease {held.job.id}", daemon=True)
        self._put_off(since)

    def __enter__(self) -> Lease:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._stopped.set()
        self._thread.join()
        fence.disarm()

    @property
    def reached(self) -> Reached:
        """How far the run has come."""
        wall = self._held.job.reached.wall + time.monotonic() - self._started
        return replace(self._reached, wall=wall)

    def tell(self, reached: Reached) -> None:
        """Say how far the run has come, but for its wall time, which is measured here.

        Raises Cancelled, LeaseLost or OutOfTime if it must stop.
        """
        self._reached = reached
        if self._verdict is not None:
            raise self._verdict

    def renew(self) -> None:
        """Lengthen the lease now, and tell the row what was reached. Raises what the database raises."""
        since, reached = time.monotonic(), self.reached
        wish = self._held.renew(self._seconds, reached)
        if wish is None:
            self._verdict = LeaseLost(self._held.job.id)
            return
        self._put_off(since)
        self.gives_way = wish is Wish.GIVE_WAY
        if wish is Wish.CANCEL:
            self._verdict = Cancelled(self._held.job.id)
        elif reached.wall > self._held.job.limits.wall:
            self._verdict = OutOfTime(self._held.job.id)

    def _put_off(self, since: float) -> None:
        fence.arm(since + FENCE * self._seconds - time.monotonic())

    def _keep(self) -> None:
        while not self._stopped.wait(min(RENEWAL, self._seconds / 4)):
            try:
                self.renew()
            except Exception:
                log.exception("job %s: its lease could not be renewed, trying again", self._held.job.id)
