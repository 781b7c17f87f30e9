"""What is done again and again beside a campaign."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager


@contextmanager
def repeated(every: float, action: Callable[[], object]) -> Iterator[None]:
    """Within it, call `action` on a thread of its own, with pauses of `every` seconds."""
    stopped = threading.Event()

    def run() -> None:
        while not stopped.wait(every):
            action()

    thread = threading.Thread(target=run)
    thread.start()
    try:
        yield
    finally:
        stopped.set()
        thread.join()
