"""What the long-lived processes of a service hold, and its disk: memory, descriptors, threads, bytes, sampled as time
goes by.

A leak is held for ever, what a request takes only while it is answered. So a sample is the least of some looks: a file
that is just being sent is no leak, though it is open at one look.

A process is judged warm, by its second quarter: before, it loads libraries at their first use (netCDF in the API: 60
MB), fills its pools (SQLite keeps up to 5 + 5 connections in an API process, two descriptors each) and gets arenas of
memory for its threads. All of that is bounded, and a crowd of requests after each sample (chaos.soak) brings it about
early, instead of by chance in the last quarter.
"""

from __future__ import annotations

import json
import os
import time
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from statistics import mean
from typing import TypeVar

from chaos.served import Served

ROOM = 1.05
"""Part of the memory of the second quarter that the last may have, on average: what more is growth."""
DISK_ROOM = 1.10
"""The same of the disk."""
SPARE = 3
"""Descriptors and threads that may be there by chance in every look of a sample: clients that stay connected."""
LOOKS, BETWEEN = 20, 0.1
"""Looks at a process for one sample, and seconds between two of them."""
Sample = TypeVar("Sample")
PAGE = os.sysconf("SC_PAGE_SIZE")


@dataclass
class Growth:
    """Samples by process: memory (MB), descriptors, threads; and of the data directory (MB)."""

    served: Served
    samples: dict[tuple[str, int], list[tuple[float, int, int]]] = field(default_factory=dict)
    disk: list[float] = field(default_factory=list)
    requests: int = 0

    def sample(self) -> None:
        """Look some times, and keep the least of each."""
        by_process: dict[tuple[str, int], list[tuple[float, int, int]]] = {}
        for _ in range(LOOKS):
            for role, pid in self._processes():
                with suppress(OSError):
                    by_process.setdefault((role, pid), []).append(_usage(pid))
            time.sleep(BETWEEN)
        self.disk.append(_size(self.served.settings.data))
        for process, looks in by_process.items():
            memory, descriptors, threads = (min(look[i] for look in looks) for i in range(3))
            self.samples.setdefault(process, []).append((memory, int(descriptors), int(threads)))

    @property
    def flat(self) -> bool:
        """Whether every process lived all along, and neither one nor the disk holds more in the end than once it was
        warm."""
        longest = max(map(len, self.samples.values()))
        return self.disk_flat and all(len(looks) == longest and _is_flat(looks) for looks in self.samples.values())

    @property
    def disk_flat(self) -> bool:
        """Whether what is kept has stayed as much as it was."""
        early, late = _quarters(self.disk)
        return mean(late) <= DISK_ROOM * mean(early)

    def lines(self) -> list[str]:
        """A table: means of memory over the second and the last quarter, most descriptors and threads in them."""
        lines = ["| process | samples | MB, 2nd quarter | MB, last | descriptors | threads | |",
                 "| --- | ---: | ---: | ---: | --- | --- | --- |"]  # fmt: skip
        for (role, _), samples in self.samples.items():
            early, late = _quarters(samples)
            memory = [f"{mean(m for m, _, _ in part):.1f}" for part in (early, late)]
            counts = [" → ".join(str(max(sample[i] for sample in part)) for part in (early, late)) for i in (1, 2)]
            row = [role, str(len(samples)), *memory, *counts, "flat" if _is_flat(samples) else "GROWS"]
            lines.append("| " + " | ".join(row) + " |")
        sizes = [f"{mean(part):.1f}" for part in _quarters(self.disk)]
        row = ["disk", str(len(self.disk)), *sizes, "", "", "flat" if self.disk_flat else "GROWS"]
        return [*lines, "| " + " | ".join(row) + " |"]

    def as_json(self) -> str:
        """Every sample, a line for each process: for whoever asks why a verdict is what it is."""
        lines = [json.dumps([role, samples]) for (role, _), samples in self.samples.items()]
        return "[\n" + ",\n".join([*lines, json.dumps(["disk", self.disk])]) + "\n]\n"

    def _processes(self) -> list[tuple[str, int]]:
        served = self.served
        pids = [("supervisor", served.process.pid if served.process else None), ("worker", served.worker()),
                ("broker", served.broker()), *((f"API {n}", pid) for n, pid in enumerate(served.apis()))]  # fmt: skip
        return [(role, pid) for role, pid in pids if pid is not None]


def _usage(pid: int) -> tuple[float, int, int]:
    """MB, descriptors and threads of a process now. Raises OSError if there is none."""
    pages = int(Path(f"/proc/{pid}/statm").read_text().split()[1])
    descriptors, threads = (len(os.listdir(f"/proc/{pid}/{name}")) for name in ("fd", "task"))  # noqa: PTH208
    return 1e-6 * pages * PAGE, descriptors, threads


def _size(directory: Path) -> float:
    """MB of all files below."""
    total = 0
    for folder, _, names in os.walk(directory):  # which passes over folders that have just been removed
        for name in names:
            with suppress(OSError):  # so may this one be
                total += Path(folder, name).stat().st_size
    return 1e-6 * total


def _quarters(samples: list[Sample]) -> tuple[list[Sample], list[Sample]]:
    quarter = max(1, len(samples) // 4)
    return samples[quarter : 2 * quarter] or samples, samples[-quarter:]


def _is_flat(samples: list[tuple[float, int, int]]) -> bool:
    early, late = _quarters(samples)
    memory = mean(m for m, _, _ in late) <= ROOM * mean(m for m, _, _ in early)
    return memory and all(max(x[i] for x in late) <= max(x[i] for x in early) + SPARE for i in (1, 2))
