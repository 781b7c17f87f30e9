"""Looks after jobs that nobody else does: rings again for them, and ends the hopeless."""

from __future__ import annotations

import logging
import threading

from service.jobs.doorbell import Doorbell
from service.jobs.registry import Registry
from service.settings import Settings

AT_ONCE = 100
log = logging.getLogger(__name__)


def reconcile(registry: Registry, doorbell: Doorbell, settings: Settings) -> None:
    """Do once what is due. Any number of processes may do so at the same time."""
    registry.end_lost(settings.attempts)
    for job_id in registry.overdue(settings.ring_again, AT_ONCE):
        if not doorbell.ring(job_id):
            return


class Reconciler:
    """A thread that reconciles a few times within each lease, and at once when it starts."""

    def __init__(self, registry: Registry, doorbell: Doorbell, settings: Settings) -> None:
        self._parts = registry, doorbell, settings
        self._interval = min(5.0, settings.lease / 3, settings.ring_again / 3)
        self._stopped = threading.Event()
        self._thread = threading.Thread(target=self._run, name="reconciler", daemon=True)

    def __enter__(self) -> Reconciler:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._stopped.set()
        self._thread.join()

    def _run(self) -> None:
        while True:
            try:
                reconcile(*self._parts)
            except Exception:
                log.exception("reconciling failed; it is tried again in %.1f s", self._interval)
            if self._stopped.wait(self._interval):
                return
