"""Delivers, again and again. Any number of processes may."""

from __future__ import annotations

import logging
import time
from concurrent.futures import ThreadPoolExecutor

from service.jobs import Database
from service.rounds import Rounds
from service.webhooks.deliveries import Delivery, settle, take_due
from service.webhooks.sender import send

TICK = 1.0
AT_ONCE = 8
log = logging.getLogger(__name__)


class Notifier:
    """Looks every second for what is due, in a thread of its `rounds`."""

    def __init__(self, database: Database) -> None:
        self._database = database

    def rounds(self) -> Rounds:
        """The thread, as a context."""
        return Rounds("notifier", TICK, self.once)

    def once(self) -> None:
        """Deliver what is due, some at the same time: a slow address holds up few others."""
        if due := take_due(self._database, AT_ONCE):
            with ThreadPoolExecutor(AT_ONCE) as pool:
                list(pool.map(self._deliver, due))

    def _deliver(self, delivery: Delivery) -> None:
        answer = send(delivery, int(time.time()))
        settle(self._database, delivery, answer.text, answer.again)
        log.info("job %s: its webhook: %s", delivery.job_id, answer.text)
