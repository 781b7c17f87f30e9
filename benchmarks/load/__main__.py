"""`python -m benchmarks.load`: what the service bears on this machine, beside its aims; kept in results/load.md.

Everything runs on loopback, in a service of its own, and stops by itself after some minutes.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import uvloop

from benchmarks.load.backlog import backlog
from benchmarks.load.scenes import SUBMITTERS, choices, events, first_step, statuses, submissions
from benchmarks.load.service import with_workers, without_workers
from benchmarks.load.table import Row, table
from chaos.postgres import postgres
from service.settings import Settings
from validation.provenance import provenance

RESULTS = Path(__file__).parents[1] / "results" / "load.md"
QUEUED, FEW = 10_000, 20
HOW = f"""\
Two API processes as `hockle serve` starts them, on loopback, with the registry in SQLite (WAL mode, synchronous=FULL)
and then in a PostgreSQL of the same machine (its own settings of durability), on an empty database for what needs no
worker and another for the rest; the clients are one process beside them (asyncio with uvloop), on the same cores.
Latency is from the write of the request to the last byte of the answer. Status: 1000 keep-alive connections, each once
a second, out of step. Submissions: so many connections, each one after the other, every case another one. These are
measured without workers, so that what jobs cost is not in them, nor is the choice among the jobs that wait, which is
measured by itself; first with no queue, then with {QUEUED:,} jobs in it. The rest is measured with the whole of
`hockle serve` and one worker, warmed by a job. First step: one job at a time, from the request to the worker's claim,
to the first steps that its log tells of, and to the end of a job of a single step, its dataset published. Events: from
the time in `ended` to its arrival at 200 listeners. Before each of these jobs there is a pause of random length, so
that neither the rest of another job nor the sleep of the feed (0.1 s) is the same every time.

First steps and events are measured three times: with an idle worker, and with one that is busy with a queue of {FEW}
or of {QUEUED:,} jobs of a single step. Those of the queue have a lower priority than what is measured, and are made up
for as they are worked off. A worker lets no job go for another, so that a submission first waits for the rest of the
job that the worker is at: it comes at any moment of that, and the short queue is the control of the long one. The
control of all else is the same with none queued. The load of the machine, beside ours, is in the figures."""


async def of_api(host: str, port: int, settings: Settings) -> list[Row]:
    """What needs no worker, once."""
    rows = [Row("a worker's choice and claim", await choices(host, port, settings))]
    for clients in SUBMITTERS:
        rate, seconds = await submissions(host, port, clients)
        rows.append(Row(f"durable submission, {clients} clients", seconds, ">= 1000/s, p99 <= 50 ms", rate))
    return [
        *rows,
        Row("status, 1000 pollers", await statuses(host, port, unchanged=False), "p99 <= 20 ms"),
        Row("status answered 304", await statuses(host, port, unchanged=True), "p99 <= 10 ms"),
    ]


async def of_worker(host: str, port: int, settings: Settings) -> list[Row]:
    """What becomes of a job and who hears of it, once."""
    claimed, stepped, ended = await first_step(host, port, settings)
    return [
        Row("submission to the worker's claim", claimed),
        Row("submission to the first solver step", stepped, "p99 <= 100 ms"),
        Row("submission to the end of a job of one step", ended),
        Row("event, 200 listeners", await events(host, port)),
    ]


def labelled(rows: Sequence[Row], queued: str = "", controls: Sequence[Row] = ()) -> list[Row]:
    """The rows, each with how many jobs were queued and its control; printed at once."""
    of_each = controls or [None] * len(rows)
    rows = [replace(row, what=row.what + queued, control=control)
            for row, control in zip(rows, of_each, strict=True)]  # fmt: skip
    for row in rows:
        print(*row.cells().values(), file=sys.stderr, flush=True)
    return rows


async def measure(api_database: str = "", worker_database: str = "") -> list[Row]:
    """Every scene with its queues, on SQLite or on these databases."""
    with without_workers(api_database) as place:
        none = labelled(await of_api(*place))
        await submissions(*place[:2], clients=SUBMITTERS[-1], many=QUEUED)
        many = labelled(await of_api(*place), f", {QUEUED:,} queued", none)
    with with_workers(database=worker_database) as place:
        idle = labelled(await of_worker(*place))
        async with backlog(*place, FEW):
            short = labelled(await of_worker(*place), f", busy, {FEW} queued")
        async with backlog(*place, QUEUED):
            long = labelled(await of_worker(*place), f", busy, {QUEUED:,} queued", short)
    return [*none, *many, *idle, *short, *long]


async def main() -> None:
    """Measure, print and keep."""
    before = os.getloadavg()
    on_sqlite = await measure()
    with postgres() as server:
        on_postgresql = await measure(server.create("api"), server.create("workers"))
    text = [*(f"- {line}" for line in provenance()),
            f"- load average of the machine before {before[0]:.1f}, after {os.getloadavg()[0]:.1f}", "", HOW, "",
            "## SQLite", "", *table(on_sqlite), "", "## PostgreSQL", "", *table(on_postgresql)]  # fmt: skip
    print("\n".join(text))
    RESULTS.write_text("\n".join([*text, ""]), encoding="utf-8")


if __name__ == "__main__":
    uvloop.run(main())
