"""`python -m stress [name ...]`: sweeps, maps and random cases, those named or all; 1 if any run failed.

What was found is kept as it comes; what was not asked for stays as it was last run.
"""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Sequence
from importlib.metadata import version
from pathlib import Path
from time import monotonic

SINGLE = dict.fromkeys(("NUMBA_NUM_THREADS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")
os.environ.update(SINGLE)  # before numpy, which reads them when it is imported

from solver import warm  # noqa: E402
from stress import drawn, references  # noqa: E402
from stress.ending import FAILURES, Result, Task  # noqa: E402
from stress.kept import Kept  # noqa: E402
from stress.pool import PROCESSES, Work, results  # noqa: E402
from stress.run import run  # noqa: E402
from stress.sweeps import MAPS, METHODS, SWEEPS, Sweep  # noqa: E402
from validation.provenance import provenance  # noqa: E402

RESULTS = Path(__file__).parent / "results"
ALL = (*SWEEPS, *MAPS)


def main() -> int:
    """Run what is asked for, and keep it."""
    names = [*(sweep.name for sweep in ALL), drawn.GROUP]
    parser = argparse.ArgumentParser(prog="python -m stress", description=__doc__)
    parser.add_argument("names", nargs="*", metavar="name", help=f"one of: {', '.join(names)}")
    parser.add_argument("--random", type=int, default=10_000, help="random cases")
    parser.add_argument("--seed", type=int, default=1)
    asked = parser.parse_args()
    unknown = [name for name in asked.names if name not in names]
    if unknown:
        parser.error(f"unknown name {unknown[0]!r}: must be one of {', '.join(names)}")
    for method in METHODS:
        warm(method)  # compiled once, not in every process
    kept, failed = Kept(RESULTS), False
    for name in asked.names or names:
        began = monotonic()
        found = swept(next(sweep for sweep in ALL if sweep.name == name)) if name != drawn.GROUP else \
            follow(drawn.tasks(asked.random, asked.seed), drawn.draw_and_run)  # fmt: skip
        seed = [f"hypothesis {version('hypothesis')}, seed {asked.seed}"] if name == drawn.GROUP else []
        took = f"{monotonic() - began:.0f} s on the clock, {PROCESSES} processes"
        kept.keep(name, [*provenance(), *seed, took], found)
        bad = sum(result.ending in FAILURES for result in found)
        print(f"{name}: {len(found)} runs, {bad} failed, {took}", flush=True)
        failed |= bad > 0
    print(kept.text())
    return 1 if failed else 0


def swept(sweep: Sweep) -> list[Result]:
    """The runs of a sweep or map, with their errors against the references."""
    tasks = list(sweep.tasks())
    found = {result.at: result for result in follow(tasks)}
    pairs = [(task, found[task.at]) for task in tasks]
    known = references.found(pairs, follow)
    return [known.measured(task, result) for task, result in pairs]


def follow(tasks: Sequence[Task], work: Work = run) -> list[Result]:
    """Run the tasks, and tell of those that failed."""
    found = []
    for _, result in results(work, tasks):
        found.append(result)
        if result.ending in FAILURES and result.group != references.GROUP:
            told = f"{result.ending.value} {result.detail.strip()[-100:]}"
            print(f"  {result.group} {list(result.at)}: {told}", flush=True)
    return found


if __name__ == "__main__":
    sys.exit(main())
