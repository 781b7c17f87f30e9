"""Submissions from many clients in few transactions: a commit takes as long for a hundred jobs as for one."""

from __future__ import annotations

import logging
import queue
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import Future
from contextlib import contextmanager

from service.jobs.database import Database
from service.jobs.job import Job
from service.jobs.submission import Submission, Terms, submit_all

AT_ONCE = 200
PAUSE = 0.05  # s between two tellings: in a rush of submissions they would cost as much as these

Waiting = tuple[Submission, "Future[Job]"]
log = logging.getLogger(__name__)


class InFlight(Exception):
    """A submission with this idempotency key has not been answered yet."""


class Submissions:
    """Takes submissions from any thread, and commits together those that wait. A context: it has two threads.

    After a commit `committed` is called, by a thread that does nothing else: nobody waits for it.
    """

    def __init__(self, database: Database, terms: Terms, committed: Callable[[], object]) -> None:
        self._database, self.terms, self._committed = database, terms, committed
        self._waiting: queue.SimpleQueue[Waiting | None] = queue.SimpleQueue()
        self._in_flight: set[tuple[str, str]] = set()
        self._lock = threading.Lock()
        self._since: float | None = None
        """When the batch was taken that is being written (time.monotonic)."""
        self._news: queue.SimpleQueue[bool] = queue.SimpleQueue()
        self._threads = [threading.Thread(target=work, name=work.__name__, daemon=True)
                         for work in (self._commit, self._tell)]  # fmt: skip

    def __enter__(self) -> Submissions:
        for thread in self._threads:
            thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._waiting.put(None)
        for thread in self._threads:
            thread.join()

    @property
    def silent(self) -> float:
        """Seconds for which the batch that is being written has been waited for; 0 while nothing is."""
        since = self._since
        return 0.0 if since is None else time.monotonic() - since

    @contextmanager
    def put(self, submission: Submission) -> Iterator[Future[Job]]:
        """The job that comes of a submission, once it is on disk; its key is in flight while the block runs.

        Raises InFlight. The future may raise KeyReused, QuotaReached, or what the database raises.
        """
        with self._lock:
            if submission.key and submission.mark in self._in_flight:
                raise InFlight(submission.key)
            self._in_flight.add(submission.mark)
        try:
            future: Future[Job] = Future()
            self._waiting.put((submission, future))
            yield future
        finally:
            with self._lock:
                self._in_flight.discard(submission.mark)

    def announce(self) -> None:
        """Tell of a commit that was made elsewhere."""
        self._news.put(True)

    def _commit(self) -> None:
        while (first := self._waiting.get()) is not None:
            if first[1].set_running_or_notify_cancel():
                self._since = time.monotonic()
                self._settle([first])
                self._since = None
                self._news.put(True)
        self._news.put(False)

    def _more(self) -> list[Waiting]:
        """All that waits besides and is still wanted, up to a bound."""
        items: list[Waiting] = []
        while len(items) < AT_ONCE:
            try:
                item = self._waiting.get_nowait()
            except queue.Empty:
                break
            if item is None:  # the end, for the next look
                self._waiting.put(None)
                break
            if item[1].set_running_or_notify_cancel():
                items.append(item)
        return items

    def _settle(self, batch: list[Waiting], again: bool = True) -> None:
        """Answer a batch, with all that came while other processes wrote. If it fails, each is tried once more by
        itself: one may be at fault, or another process may have written the same idempotency key in the meantime."""
        try:
            with self._database.writing() as transaction:
                if again:
                    batch += self._more()
                results = submit_all(transaction, [submission for submission, _ in batch], self.terms)
        except Exception as error:
            for item in batch:
                if again:
                    self._settle([item], again=False)
                else:
                    item[1].set_exception(error)
            return
        for (_, future), result in zip(batch, results, strict=True):
            if isinstance(result, Job):
                future.set_result(result)
            else:
                future.set_exception(result)

    def _tell(self) -> None:
        while self._news.get():
            while not self._news.empty():
                if not self._news.get():
                    return
            try:
                self._committed()
            except Exception:
                log.exception("the workers could not be told of new jobs; the reconciler will")
            time.sleep(PAUSE)
