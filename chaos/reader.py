"""A client that reads frames of the jobs that run, while faults are done."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import httpx
import numpy as np

from chaos.repeated import repeated
from service.results import open_dataset

EVERY, STRIDE = 0.2, 20


@dataclass(frozen=True)
class Read:
    """What was read of a running job: of each frame so far its time, twist and some positions."""

    job: str
    values: Mapping[str, Any]

    def is_of(self, dataset: Path) -> bool:
        """Whether the dataset of the job has the same frames, to the bit."""
        with open_dataset(dataset) as stored:
            frames = np.searchsorted(stored.time, self.values["time"])
            if frames.max(initial=-1) >= stored.sizes["time"]:
                return False
            same = {"time": stored.time[frames], "Tw": stored.Tw[frames], "r": stored.r[frames, ::STRIDE]}
            return all(np.array_equal(values, self.values[name], equal_nan=True) for name, values in same.items())


@contextmanager
def reading(address: str, reads: list[Read]) -> Iterator[None]:
    """Within it, jobs that run are read, one after the other; what was read is added to `reads`."""
    with httpx.Client(base_url=address, timeout=10.0, trust_env=False) as client:

        def read_all() -> None:
            with suppress(httpx.HTTPError):  # whoever would answer may have just been killed
                for job in client.get("/v1/jobs?status=running").raise_for_status().json()["jobs"]:
                    reads.extend(_read(client, job["id"]))

        with repeated(EVERY, read_all):
            yield


def _read(client: httpx.Client, job: str) -> list[Read]:
    """What a job has so far, if it still runs."""
    answer = client.get(f"/v1/jobs/{job}/data?variables=Tw,r&s_stride={STRIDE}")
    if answer.status_code != 200 or answer.headers["job-status"] != "running":
        return []
    body = answer.json()
    arrays = {"time": body["coordinates"]["time"], **body["variables"]}
    return [Read(job, {name: np.array(arrays[name]["values"], float) for name in ("time", "Tw", "r")})]
