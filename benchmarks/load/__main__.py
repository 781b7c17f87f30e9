"""`python -m benchmarks.load`: what the service bears on this machine, beside its aims; kept in results/load.md.

Everything runs on loopback, in a service of its own, and stops by itself after some minutes.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import uvloop

from benchmarks.load.scenes import SUBMITTERS, choices, events, first_step, statuses, submissions
from benchmarks.load.service import whole, without_workers
from service.settings import Settings
from validation.provenance import provenance

RESULTS = Path(__file__).parents[1] / "results" / "load.md"
QUEUED = 10_000
HOW = """\
Two API processes as `hockle serve` starts them, SQLite in WAL mode with synchronous=FULL, on loopback; the clients
are one process beside them (asyncio with uvloop), on the same cores. Latency is from the write of the request to
the last byte of the answer. Status: 1000 keep-alive connections, each once a second, out of step. Submissions: so many
connections, each one after the other, every case another one. These are measured without workers, so that what
jobs cost is not in them, nor is the choice among the jobs that wait, which is measured by itself. The rest is
measured with the whole of `hockle serve` and one worker, warmed by a job. First step: one job at a time, from the
request to the worker's claim, to the first steps that its log tells of, and to the end of a job of a single step, its
dataset published. Events: from the time in `ended` to its arrival at 200 listeners. The load of the machine, beside
ours, is in the figures."""


def row(name: str, seconds: Sequence[float], aim: str, rate: str = "") -> dict[str, Any]:
    """One line of the table, in ms."""
    ordered = sorted(seconds)
    p50, p99 = (1e3 * ordered[min(len(ordered) - 1, int(part * len(ordered)))] for part in (0.5, 0.99))
    told = {"what": name, "n": len(ordered), "p50 ms": f"{p50:.2f}", "p99 ms": f"{p99:.1f}", "a second": rate,
            "aim": aim, "p50 / that of none queued": ""}  # fmt: skip
    print(" ".join(map(str, told.values())), file=sys.stderr, flush=True)
    return told


async def measure(host: str, port: int, settings: Settings, queued: str) -> list[dict[str, Any]]:
    """Every scene once."""
    rows = [row(f"a worker's choice and claim{queued}", await choices(host, port, settings), "")]
    for clients in SUBMITTERS:
        rate, seconds = await submissions(host, port, clients)
        rows.append(row(f"durable submission, {clients} clients{queued}", seconds, ">= 1000/s, p99 <= 50 ms",
                        f"{rate:.0f}"))  # fmt: skip
    return [
        *rows,
        row(f"status, 1000 pollers{queued}", await statuses(host, port, unchanged=False), "p99 <= 20 ms"),
        row(f"status answered 304{queued}", await statuses(host, port, unchanged=True), "p99 <= 10 ms"),
    ]


async def main() -> None:
    """Measure with an empty queue and with a long one, print and keep."""
    before = os.getloadavg()
    with without_workers() as place:
        rows = await measure(*place, "")
        await submissions(*place[:2], clients=SUBMITTERS[-1], many=QUEUED)
        full = await measure(*place, f", {QUEUED:,} queued")
    for alone, queued in zip(rows, full, strict=True):
        queued["p50 / that of none queued"] = f"{float(queued['p50 ms']) / float(alone['p50 ms']):.2f}"
    rows += full
    with whole() as place:
        claimed, stepped, ended = await first_step(*place)
        rows.append(row("submission to the worker's claim", claimed, ""))
        rows.append(row("submission to the first solver step", stepped, "p99 <= 100 ms"))
        rows.append(row("submission to the end of a job of one step", ended, ""))
        rows.append(row("event, 200 listeners", await events(*place[:2]), ""))
    text = [*(f"- {line}" for line in provenance()),
            f"- load average of the machine before {before[0]:.1f}, after {os.getloadavg()[0]:.1f}", "", HOW, ""]
    text += ["| " + " | ".join(rows[0]) + " |", "|---" * len(rows[0]) + "|"]
    text += ["| " + " | ".join(str(value) for value in one.values()) + " |" for one in rows]
    print("\n".join(text))
    RESULTS.write_text("\n".join([*text, ""]), encoding="utf-8")


if __name__ == "__main__":
    uvloop.run(main())
