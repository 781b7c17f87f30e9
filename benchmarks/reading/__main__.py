"""`python -m benchmarks.reading`: reading of results and ensembles, beside their aims; kept in results/reading.md."""

from __future__ import annotations

import argparse
import os
from pathlib import Path

import httpx

from benchmarks.load.service import whole, without_workers
from benchmarks.load.table import Row, table
from benchmarks.reading.scenes import of_a_dataset, of_an_ensemble, of_many_jobs, running
from validation.provenance import provenance

RESULTS = Path(__file__).parents[1] / "results" / "reading.md"
HOW = """\
On loopback, one request after the other over one connection, SQLite. The dataset has 501 frames of 401 nodes with all
fields. The list, and the ensembles, are asked of two API processes without workers."""


def main() -> None:
    """Measure, print the table, and keep it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--members", type=int, default=0, help="also run an ensemble of so many to its end")
    told = parser.parse_args()
    before = os.getloadavg()
    rows: list[Row] = []
    lines: list[str] = []
    with whole() as (host, port, settings), httpx.Client(base_url=f"http://{host}:{port}", timeout=600.0) as client:
        rows += of_a_dataset(client, settings)
        if told.members:
            wall, cpu = running(client, told.members, workers=1)
            lines = ["", f"{told.members} members of goyal-2003 with 100 intervals took {wall:.1f} s with one worker; "
                     f"the CPU time of their runs is {cpu:.1f} s: {wall / cpu:.2f} times that."]
    for scene in (of_many_jobs, of_an_ensemble):
        with without_workers() as (host, port, settings), httpx.Client(
            base_url=f"http://{host}:{port}", timeout=600.0
        ) as client:
            rows += scene(client, settings)
    text = [*(f"- {line}" for line in provenance()),
            f"- load average of the machine before {before[0]:.1f}, after {os.getloadavg()[0]:.1f}", "", HOW, "",
            *table(rows), *lines]  # fmt: skip
    print("\n".join(text))
    RESULTS.write_text("\n".join([*text, ""]), encoding="utf-8")


if __name__ == "__main__":
    main()
