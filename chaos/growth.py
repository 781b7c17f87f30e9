"""What the long-lived processes of a service hold: memory, descriptors, threads, sampled as time goes by."""

from __future__ import annotations

import os
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from statistics import mean

from chaos.served import Served

ROOM = 1.05
"""Part of the memory of the second quarter that the last may have, on average: what more is growth."""
SPARE = 3
"""Descriptors and threads that may be open by chance when a sample is taken."""
PAGE = os.sysconf("SC_PAGE_SIZE")


@dataclass
class Growth:
    """Samples by process: memory (MB), descriptors, threads."""

    served: Served
    samples: dict[tuple[str, int], list[tuple[float, int, int]]] = field(default_factory=dict)
    requests: int = 0

    def sample(self) -> None:
        """Look once."""
        for role, pid in self._processes():
            with suppress(OSError):
                pages = int(Path(f"/proc/{pid}/statm").read_text().split()[1])
                counts = (len(os.listdir(f"/proc/{pid}/{what}")) for what in ("fd", "task"))  # noqa: PTH208
                descriptors, threads = counts
                self.samples.setdefault((role, pid), []).append((1e-6 * pages * PAGE, descriptors, threads))

    @property
    def flat(self) -> bool:
        """Whether every process lived all along, and none holds more in the end than once it was warm."""
        longest = max(map(len, self.samples.values()))
        return all(len(found) == longest and _is_flat(found) for found in self.samples.values())

    def lines(self) -> list[str]:
        """A table: means of memory over the second and the last quarter, most descriptors and threads in them."""
        lines = ["| process | samples | MB, 2nd quarter | MB, last | descriptors | threads | |",
                 "| --- | ---: | ---: | ---: | --- | --- | --- |"]  # fmt: skip
        for (role, _), found in self.samples.items():
            early, late = _quarters(found)
            memory = [f"{mean(m for m, _, _ in part):.1f}" for part in (early, late)]
            held = [" → ".join(str(max(one[i] for one in part)) for part in (early, late)) for i in (1, 2)]
            row = [role, str(len(found)), *memory, *held, "flat" if _is_flat(found) else "GROWS"]
            lines.append("| " + " | ".join(row) + " |")
        return lines

    def _processes(self) -> list[tuple[str, int]]:
        served = self.served
        found = [("supervisor", served.process.pid if served.process else None), ("worker", served.worker()),
                 ("broker", served.broker()), *((f"API {n}", pid) for n, pid in enumerate(served.apis()))]  # fmt: skip
        return [(role, pid) for role, pid in found if pid is not None]


def _quarters(found: list[tuple[float, int, int]]) -> tuple[list[tuple[float, int, int]], list[tuple[float, int, int]]]:
    quarter = max(1, len(found) // 4)
    return found[quarter : 2 * quarter] or found, found[-quarter:]


def _is_flat(found: list[tuple[float, int, int]]) -> bool:
    early, late = _quarters(found)
    memory = mean(m for m, _, _ in late) <= ROOM * mean(m for m, _, _ in early)
    return memory and all(max(x[i] for x in late) <= max(x[i] for x in early) + SPARE for i in (1, 2))
