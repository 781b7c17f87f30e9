"""An ensemble run to its end by two workers, beside the CPU time of its runs; on a machine that others use too."""

from __future__ import annotations

import secrets
import time
from contextlib import suppress
from dataclasses import dataclass, field
from datetime import datetime
from pathlib import Path
from typing import Any

import httpx
import netCDF4
import numpy as np

from benchmarks.load.service import cpu_time, started
from benchmarks.reading.scenes import finished

CASE, INTERVALS, WORKERS = "goyal-2003", 100, 2


@dataclass
class Waited:
    """Seconds for which the workers' processes were ready to run and had no core, as the kernel counts them."""

    last: dict[int, int] = field(default_factory=dict)
    first: dict[int, int] = field(default_factory=dict)

    def look(self) -> None:
        """Before, during and after: what a process that ends has waited since the last look is lost."""
        for pid in started("worker"):
            with suppress(OSError):
                self.last[pid] = int(Path("/proc", str(pid), "schedstat").read_text().split()[1])
                self.first.setdefault(pid, self.last[pid])

    @property
    def seconds(self) -> float:
        """So far."""
        return sum(told - self.first[pid] for pid, told in self.last.items()) / 1e9


def of_members(client: httpx.Client, members: int) -> list[str]:
    """How long so many members took, and the CPU time of their runs and of the service."""
    values = (secrets.randbelow(10**9) * 1e-9 + np.linspace(0.0, 1.0, members)).tolist()
    body = {"case": CASE, "set": {"numerics.intervals": INTERVALS}, "parameters": {"loads.damping": values}}
    for _ in range(WORKERS):  # with what they load first
        finished(client, {"case": CASE, "set": {"numerics.intervals": INTERVALS, "t_end": 1.0}, "reuse": False})
    waited = Waited()
    waited.look()
    cpu, workers, began = cpu_time(), cpu_time("worker"), time.perf_counter()
    ensemble = client.post("/v1/ensembles", json=body).raise_for_status().json()
    while ensemble["finished"] is None:
        time.sleep(0.5)
        ensemble = client.get(ensemble["links"]["self"]).raise_for_status().json()
        waited.look()
    wall, service, workers = time.perf_counter() - began, cpu_time() - cpu, cpu_time("worker") - workers
    runs, busy = _runs(client, ensemble)
    free = wall - waited.seconds / WORKERS
    return ["", f"{members} members of {CASE} with {INTERVALS} intervals, {WORKERS} workers on 2 cores:", "",
            "| what | s | by (CPU of the runs / 2) | aim |", "|---|---|---|---|",
            _line("CPU time of the runs, as their datasets tell", runs, "", ""),
            _line("CPU time of the workers, by 2", workers / 2, workers / runs, "<= 1.1"),
            _line("CPU time of all processes of the service, by 2", service / 2, service / runs, "<= 1.1"),
            _line("wall clock", wall, 2 * wall / runs, "<= 1.1, on two free cores"),
            _line("wall clock, less the time that a worker had no core", free, 2 * free / runs, "<= 1.1"), "",
            f"A worker had a member in hand for {100 * busy / WORKERS / wall:.1f} % of the wall clock."]  # fmt: skip


def _line(what: str, seconds: float, ratio: float | str, aim: str) -> str:
    return f"| {what} | {seconds:.1f} | {f'{ratio:.3f}' if ratio else ''} | {aim} |"


def _runs(client: httpx.Client, ensemble: dict[str, Any]) -> tuple[float, float]:
    """CPU seconds of the members' runs, and the seconds from each one's start to its end."""
    cpu = busy = 0.0
    for member in client.get(ensemble["links"]["members"] + "?limit=1000").raise_for_status().json()["members"]:
        job = client.get(member["links"]["job"]).raise_for_status().json()
        began, ended = (datetime.fromisoformat(job[name]) for name in ("started", "finished"))
        busy += (ended - began).total_seconds()
        content = client.get(job["links"]["dataset"]).raise_for_status().content
        with netCDF4.Dataset("run.nc", memory=content) as file:
            cpu += float(file.cpu_time)
    return cpu, busy
