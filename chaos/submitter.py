"""A client that hands in jobs, and repeats what was not answered."""

from __future__ import annotations

import itertools
import random
import threading
import time
from collections.abc import Mapping
from contextlib import suppress
from typing import Any

import httpx

from chaos.record import Record
from chaos.served import PATIENCE, Served
from service.cases import apply_settings, load_case
from service.jobs.job import LEAST_MEMORY

PERIOD = 50
STARVED, POISONED = 7, 13
"""Of so many jobs one has too little memory, and of one every process is killed: those with these numbers."""
GREEDY = apply_settings(load_case("goyal-2003"), {"numerics.intervals": 10_000})
"""A case that needs more at once."""


class Submitter:
    """Hands in one job after the other, from any thread."""

    def __init__(self, served: Served, record: Record, cases: Mapping[str, Any]) -> None:
        self._address, self._record, self._cases = served.address, record, cases
        self._random = random.Random(record.seed + 1)
        self._numbers = itertools.count()
        self._lock = threading.Lock()

    def submit(self) -> None:
        """Hand in the next job. Raises TimeoutError if nobody ever answers."""
        with self._lock:
            number, name = next(self._numbers), self._random.choice(sorted(self._cases))
        body = {"case": self._cases[name], "label": f"{self._record.seed}-{number}", "reuse": False}
        starved, poisoned = (number % PERIOD == its for its in (STARVED, POISONED))
        if starved:
            body |= {"case": GREEDY, "limits": {"memory": LEAST_MEMORY}}
        job_id = self._accepted(body)
        if starved:
            self._record.starved.add(job_id)
        if poisoned:
            self._record.poisoned.add(job_id)
        self._record.accepted[job_id] = name

    def _accepted(self, body: dict[str, Any]) -> str:
        """Hand in a job until there is an answer: the key makes one of it, whatever became of answers before."""
        deadline = time.monotonic() + PATIENCE
        while time.monotonic() < deadline:
            with suppress(httpx.TransportError):
                answer = httpx.post(f"{self._address}/v1/jobs", json=body, timeout=20.0, trust_env=False,
                                    headers={"Idempotency-Key": body["label"]})  # fmt: skip
                if answer.status_code in (200, 202):
                    return str(answer.json()["id"])
            time.sleep(0.1)
        raise TimeoutError("the API accepts nothing")
