"""Keeps the store in order, again and again. Any number of processes may."""

from __future__ import annotations

import logging
import time
from collections.abc import Iterator

from service.jobs import Database, Job
from service.jobs.submission import forget_keys
from service.results import Datasets, StoreUnreachable
from service.rounds import Rounds
from service.settings import Settings
from service.store.removal import remove_files
from service.store.retention import retain
from service.store.verification import all_jobs, look

TICK = 60.0
LOOK_AGAIN = 3600.0
"""Seconds from the beginning of one look at all datasets to that of the next."""
AT_ONCE = 2.0
"""Seconds of looking in one round."""
log = logging.getLogger(__name__)


class Keeper:
    """Deletes what is kept no longer, removes what was deleted, forgets old idempotency keys; looks at every dataset
    each hour."""

    def __init__(self, database: Database, datasets: Datasets, settings: Settings) -> None:
        self._database, self._datasets, self._settings = database, datasets, settings
        self._looking: Iterator[Job] | None = None
        self._look_at = time.monotonic()

    def rounds(self) -> Rounds:
        """The thread, as a context."""
        return Rounds("keeper", TICK, self.once)

    def once(self) -> None:
        """Do what is due."""
        if deleted := retain(self._database, self._settings, time.time()):
            log.info("%d jobs are kept no longer", len(deleted))
        with self._database.writing() as transaction:
            forget_keys(transaction)
        remove_files(self._database, self._datasets)
        self._look_on()

    def _look_on(self) -> None:
        """Look at more of the datasets, the newest first."""
        began = time.monotonic()
        if self._looking is None and began >= self._look_at:
            self._looking, self._look_at = all_jobs(self._database), began + LOOK_AGAIN
        while self._looking is not None and time.monotonic() < began + AT_ONCE:
            job = next(self._looking, None)
            if job is None:
                self._looking = None
                return
            try:
                look(self._database, self._datasets, job)
            except StoreUnreachable as error:
                log.warning("job %s: its dataset cannot be looked at: %s", job.id, error)
