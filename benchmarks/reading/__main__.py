"""`python -m benchmarks.reading`: reading of results and ensembles, beside their aims; kept in results/reading.md."""

from __future__ import annotations

import argparse
import os
from pathlib import Path

import httpx

from benchmarks.load.service import with_workers, without_workers
from benchmarks.load.table import Row, table
from benchmarks.reading.large import lines, of_a_large_dataset
from benchmarks.reading.members import WORKERS, of_members
from benchmarks.reading.scenes import of_a_dataset, of_an_ensemble, of_many_jobs
from validation.provenance import provenance

RESULTS = Path(__file__).parents[1] / "results" / "reading.md"
HOW = """\
On loopback, one request after the other over one connection, SQLite. The dataset has 501 frames of 401 nodes with all
fields. The list, the ensembles, and the dataset of 2 GB are asked of two API processes without workers."""


def main() -> None:
    """Measure, print the table, and keep it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--members", type=int, default=100, help="run an ensemble of so many to its end")
    arguments = parser.parse_args()
    before = os.getloadavg()
    rows: list[Row] = []
    with with_workers() as (host, port, settings), httpx.Client(
        base_url=f"http://{host}:{port}", timeout=600.0
    ) as client:
        rows += of_a_dataset(client, settings)
    for scene in (of_many_jobs, of_an_ensemble):
        with without_workers() as (host, port, settings), httpx.Client(
            base_url=f"http://{host}:{port}", timeout=600.0
        ) as client:
            rows += scene(client, settings)
    with without_workers() as (host, port, settings):
        large = lines(*of_a_large_dataset(f"http://{host}:{port}", settings))
    with with_workers(WORKERS) as (host, port, _), httpx.Client(
        base_url=f"http://{host}:{port}", timeout=600.0
    ) as client:
        members = of_members(client, arguments.members)
    text = [*(f"- {line}" for line in provenance()),
            f"- load average of the machine before {before[0]:.1f}, after {os.getloadavg()[0]:.1f}", "", HOW, "",
            *table(rows), *large, *members]  # fmt: skip
    print("\n".join(text))
    RESULTS.write_text("\n".join([*text, ""]), encoding="utf-8")


if __name__ == "__main__":
    main()
