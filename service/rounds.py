"""A thread that does the same thing again and again."""

from __future__ import annotations

import logging
import threading
import time
from collections.abc import Callable
from typing import Self

log = logging.getLogger(__name__)


class Rounds:
    """Does `once` every so many seconds, whatever goes wrong in it; tells when it last got on. Also a context."""

    def __init__(self, name: str, seconds: float, once: Callable[[], object]) -> None:
        self._name, self._seconds, self._once = name, seconds, once
        self._moved = time.monotonic()
        self._stopped = threading.Event()
        self._thread = threading.Thread(target=self._run, name=name, daemon=True)

    def __enter__(self) -> Self:
        self.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()

    def start(self) -> None:
        """Begin; it ends with the process, if not before."""
        self._thread.start()

    def stop(self) -> None:
        """End, after the round that is being done."""
        self._stopped.set()
        self._thread.join()

    @property
    def silent(self) -> float:
        """Seconds since the last round ended."""
        return time.monotonic() - self._moved

    def _run(self) -> None:
        while True:
            try:
                self._once()
            except Exception:
                log.exception("%s failed; it is tried again in %.1f s", self._name, self._seconds)
            self._moved = time.monotonic()
            if self._stopped.wait(self._seconds):
                return
