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

from chaos.cases import HALF
from chaos.record import Record
from chaos.served import PATIENCE, Served
from service.cases import apply_settings, load_case
from service.jobs.job import LEAST_MEMORY

PERIOD = 50
STARVED, POISONED = 7, 13
"""Of so many jobs one has too little memory, and of one every process is killed: those with these numbers."""
ENSEMBLE, AMONG = 1, 5
"""One of so many submissions, the one with this number, is an ensemble: a case to its end, and to half of that."""
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
        if number % AMONG == ENSEMBLE and f"{name}{HALF}" in self._cases:
            self._submit_ensemble(name, body)
            return
        starved, poisoned = (number % PERIOD == remainder for remainder in (STARVED, POISONED))
        if starved:
            body |= {"case": GREEDY, "limits": {"memory": LEAST_MEMORY}}
        job_id = self._accepted("/v1/jobs", body)["id"]
        if starved:
            self._record.starved.add(job_id)
        if poisoned:
            self._record.poisoned.add(job_id)
        self._record.accepted[job_id] = name

    def _submit_ensemble(self, name: str, body: dict[str, Any]) -> None:
        ends = {self._cases[case]["t_end"]: case for case in (name, f"{name}{HALF}")}
        ensemble = self._accepted("/v1/ensembles", body | {"parameters": {"t_end": [*ends]}})
        self._record.ensembles.add(ensemble["id"])
        for member in self._ask("GET", ensemble["links"]["members"])["members"]:
            self._record.accepted[member["job"]] = ends[member["values"]["t_end"]]

    def _accepted(self, path: str, body: dict[str, Any]) -> dict[str, Any]:
        """Hand in until there is an answer: the key makes one of it, whatever became of answers before."""
        return self._ask("POST", path, json=body, headers={"Idempotency-Key": body["label"]})

    def _ask(self, method: str, path: str, **more: Any) -> dict[str, Any]:
        deadline = time.monotonic() + PATIENCE
        while time.monotonic() < deadline:
            with suppress(httpx.TransportError):
                answer = httpx.request(method, f"{self._address}{path}", timeout=20.0, trust_env=False, **more)
                if answer.is_success:
                    body: dict[str, Any] = answer.json()
                    return body
            time.sleep(0.1)
        raise TimeoutError(f"the API never answers {method} {path}")
