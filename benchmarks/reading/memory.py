"""How much more memory processes come to hold while something is done, by the kernel's count."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path


def started_here(word: str) -> list[int]:
    """The processes that this one has started whose command has the word `called`."""
    pids = Path("/proc/self/task", str(os.getpid()), "children").read_text().split()
    return [int(pid) for pid in pids if word.encode() in Path("/proc", pid, "cmdline").read_bytes().split(b"\0")]


def peak_of(pids: Sequence[int], do: Callable[[], object]) -> float:
    """The most (MB) by which the resident memory of one of them grew meanwhile: at its peak, above that before."""
    before = {}
    for pid in pids:
        Path("/proc", str(pid), "clear_refs").write_text("5")  # the peak is counted anew
        before[pid] = _count(pid, "VmRSS")
    do()
    grown = [0.0]
    for pid in pids:
        with suppress(OSError):
            grown.append(_count(pid, "VmHWM") - before[pid])
    return max(grown) / 1e3


def _count(pid: int, name: str) -> float:
    """A count of kB."""
    match = re.search(rf"{name}:\s+(\d+) kB", Path("/proc", str(pid), "status").read_text())
    return float(match[1]) if match else 0.0
