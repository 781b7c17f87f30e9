"""A client that reads frames of the jobs that run, while faults are done."""

from __future__ import annotations

import threading
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import httpx
import numpy as np

from service.results import open_dataset

EVERY, STRIDE = 0.2, 20


@dataclass(frozen=True)
class Read:
    """What was read of a running job: of each frame so far its time, twist and some positions."""

    job: str
    values: Mapping[str, Any]

    def is_of(self, dataset: Path) -> bool:
        """Whether the dataset of the job has the same frames, to the bit."""
        with open_dataset(dataset) as whole:
            frames = np.searchsorted(whole.time, self.values["time"])
            if frames.max(initial=-1) >= whole.sizes["time"]:
                return False
            same = {"time": whole.time[frames], "Tw": whole.Tw[frames], "r": whole.r[frames, ::STRIDE]}
            return all(np.array_equal(values, self.values[name], equal_nan=True) for name, values in same.items())


class Reader:
    """Reads one running job after the other. A context: it has a thread."""

    def __init__(self, address: str, reads: list[Read]) -> None:
        self._address, self._reads = address, reads
        self._stopped = threading.Event()
        self._thread = threading.Thread(target=self._run)

    def __enter__(self) -> Reader:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._stopped.set()
        self._thread.join()

    def _run(self) -> None:
        with httpx.Client(base_url=self._address, timeout=10.0, trust_env=False) as client:
            while not self._stopped.wait(EVERY):
                with suppress(httpx.HTTPError):  # whoever would answer may have just been killed
                    for job in client.get("/v1/jobs?status=running").raise_for_status().json()["jobs"]:
                        self._read(client, job["id"])

    def _read(self, client: httpx.Client, job: str) -> None:
        answer = client.get(f"/v1/jobs/{job}/data?variables=Tw,r&s_stride={STRIDE}")
        if answer.status_code != 200 or answer.headers["job-status"] != "running":
            return
        told = answer.json()
        arrays = {"time": told["coordinates"]["time"], **told["variables"]}
        self._reads.append(Read(job, {name: np.array(arrays[name]["values"], float) for name in ("time", "Tw", "r")}))
