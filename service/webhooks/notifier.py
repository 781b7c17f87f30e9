"""The thread that delivers. Any number of processes may run one."""

from __future__ import annotations

import logging
import threading
import time
from concurrent.futures import ThreadPoolExecutor

from service.jobs import Database
from service.webhooks.deliveries import Delivery, settle, take_due
from service.webhooks.sender import send

TICK = 1.0
AT_ONCE = 8
log = logging.getLogger(__name__)


class Notifier:
    """Looks every second for what is due, as a context."""

    def __init__(self, database: Database) -> None:
        self._database = database
        self._stopped = threading.Event()
        self._thread = threading.Thread(target=self._run, name="webhooks", daemon=True)

    def __enter__(self) -> Notifier:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._stopped.set()
        self._thread.join()

    def once(self) -> None:
        """Deliver what is due, some at the same time: a slow address holds up few others."""
        if due := take_due(self._database, AT_ONCE):
            with ThreadPoolExecutor(AT_ONCE) as pool:
                list(pool.map(self._deliver, due))

    def _deliver(self, delivery: Delivery) -> None:
        answer = send(delivery, int(time.time()))
        settle(self._database, delivery, answer.told, answer.again)
        log.info("job %s: its webhook: %s", delivery.job_id, answer.told)

    def _run(self) -> None:
        while not self._stopped.wait(TICK):
            try:
                self.once()
            except Exception:
                log.exception("webhooks could not be delivered; it is tried again in %.0f s", TICK)
