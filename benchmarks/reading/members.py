"""An ensemble run to its end by two workers, beside the CPU time of its runs; on a machine that others use too."""

from __future__ import annotations

import secrets
import tempfile
import time
from argparse import Namespace
from collections.abc import Iterator, Sequence
from contextlib import redirect_stderr, redirect_stdout, suppress
from dataclasses import dataclass, field
from datetime import datetime
from io import StringIO
from pathlib import Path
from typing import Any

import httpx
import netCDF4
import numpy as np

from benchmarks.load.service import cpu_time, started
from benchmarks.reading.scenes import finished
from hockle.local import run

CASE, INTERVALS, WORKERS = "goyal-2003", 100, 2
ALONE = 10
"""Of the members, that are run without the service too."""


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
        return sum(waited - self.first[pid] for pid, waited in self.last.items()) / 1e9


def of_members(client: httpx.Client, members: int) -> list[str]:
    """How long so many members took, and the CPU time of their runs and of the service."""
    values = (secrets.randbelow(10**9) * 1e-9 + np.linspace(0.0, 1.0, members)).tolist()
    body = {"case": CASE, "set": {"numerics.intervals": INTERVALS}, "parameters": {"loads.damping": values}}
    for _ in range(WORKERS):  # with what they load first
        finished(client, {"case": CASE, "set": {"numerics.intervals": INTERVALS, "t_end": 1.0}, "reuse": False})
    waited = Waited()
    waited.look()
    cpu, workers, began = cpu_time(), cpu_time("worker"), time.time()
    ensemble = client.post("/v1/ensembles", json=body).raise_for_status().json()
    while ensemble["finished"] is None:
        time.sleep(0.5)
        ensemble = client.get(ensemble["links"]["self"]).raise_for_status().json()
        waited.look()
    service, workers = cpu_time() - cpu, cpu_time("worker") - workers
    wall = datetime.fromisoformat(ensemble["finished"]).timestamp() - began  # not when this program next looked
    runs, busy = _runs(client, ensemble)
    alone = runs * _with_datasets(values[:: max(1, members // ALONE)])
    free = wall - waited.seconds / WORKERS
    durations = {"CPU time of the workers, by 2": workers / 2,
                 "CPU time of all processes of the service, by 2": service / 2,
                 "wall clock": wall,
                 "wall clock, less the time that a worker had no core": free}  # fmt: skip
    return ["", f"{members} members of {CASE} with {INTERVALS} intervals, {WORKERS} workers on 2 cores. Aim: 1.1 times",
            "their CPU time by 2: the solver's, or that of `hockle run` in a warm process, with its dataset.",
            "",
            "| what | s | by (solver / 2) | by (`hockle run` / 2) |", "|---|---|---|---|",
            f"| CPU time of the solver, as the datasets tell | {runs:.1f} |  |  |",
            f"| CPU time of `hockle run` | {alone:.1f} |  |  |",
            *(f"| {what} | {seconds:.1f} | {2 * seconds / runs:.3f} | {2 * seconds / alone:.3f} |"
              for what, seconds in durations.items()), "",
            f"A worker had a member in hand for {100 * busy / WORKERS / wall:.1f} % of the wall clock."]  # fmt: skip


def _with_datasets(values: Sequence[float]) -> float:
    """CPU time of runs by the command line in this process, by that of their solver."""
    runs = list(_by_the_command_line([values[0], *values]))[1:]  # the first one loads what all need
    return sum(cpu for cpu, _ in runs) / sum(solver for _, solver in runs)


def _by_the_command_line(values: Sequence[float]) -> Iterator[tuple[float, float]]:
    """CPU seconds of each run, and of its solver alone."""
    with tempfile.TemporaryDirectory() as directory:
        path = Path(directory, "run.nc")
        for value in values:
            settings = [f"numerics.intervals={INTERVALS}", f"loads.damping={value}"]
            began = time.process_time()
            with redirect_stdout(StringIO()), redirect_stderr(StringIO()):
                run(Namespace(case=CASE, settings=settings, output=path))
            cpu = time.process_time() - began
            with netCDF4.Dataset(path) as file:
                yield cpu, float(file.cpu_time)


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
