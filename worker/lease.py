"""Keeps a running job's lease while its frames are computed, and brings back what the owner wants."""

from __future__ import annotations

import logging
import threading

from service.jobs import Job
from service.jobs.registry import Registry

RENEWAL = 0.5
log = logging.getLogger(__name__)


class Cancelled(Exception):
    """The owner of the job does not want it any more."""


class LeaseLost(Exception):
    """The job is another worker's now: nothing more may be written for it."""


class Lease:
    """Renews the lease of `job` from a thread of its own, so that a long step does not lose it.

    `told` is the progress (0 to 1) and the simulated time (s) that it was told last.
    """

    def __init__(self, registry: Registry, job: Job, seconds: float) -> None:
        self._registry, self._job, self._seconds = registry, job, seconds
        self.told = (0.0, 0.0)
        self._verdict: Exception | None = None
        self._stopped = threading.Event()
        self._thread = threading.Thread(target=self._keep, name=f"lease {job.id}", daemon=True)

    def __enter__(self) -> Lease:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._stopped.set()
        self._thread.join()

    def tell(self, progress: float, t: float) -> None:
        """Say how far the run has come. Raises Cancelled or LeaseLost if it must stop."""
        self.told = (progress, t)
        if self._verdict is not None:
            raise self._verdict

    def _keep(self) -> None:
        while not self._stopped.wait(min(RENEWAL, self._seconds / 4)) and self._verdict is None:
            try:
                self._renew()
            except Exception:
                log.exception("job %s: its lease could not be renewed, trying again", self._job.id)

    def _renew(self) -> None:
        job = self._registry.renew(self._job, self._seconds, *self.told)
        if job is None:
            self._verdict = LeaseLost(self._job.id)
        elif job.cancel_requested:
            self._verdict = Cancelled(self._job.id)
