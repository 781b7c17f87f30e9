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
    arguments = parser.parse_args()
    unknown = [name for name in arguments.names if name not in names]
    if unknown:
        parser.error(f"unknown name {unknown[0]!r}: must be one of {', '.join(names)}")
    for method in METHODS:
        warm(method)  # compiled once, not in every process
    store, failed = Kept(RESULTS), False
    for name in arguments.names or names:
        began = monotonic()
        runs = swept(next(sweep for sweep in ALL if sweep.name == name)) if name != drawn.GROUP else \
            follow(drawn.tasks(arguments.random, arguments.seed), drawn.draw_and_run)  # fmt: skip
        seed = [f"hypothesis {version('hypothesis')}, seed {arguments.seed}"] if name == drawn.GROUP else []
        took = f"{monotonic() - began:.0f} s on the clock, {PROCESSES} processes"
        store.keep(name, [*provenance(), *seed, took], runs)
        bad = sum(result.ending in FAILURES for result in runs)
        print(f"{name}: {len(runs)} runs, {bad} failed, {took}", flush=True)
        failed |= bad > 0
    print(store.text())
    return 1 if failed else 0


def swept(sweep: Sweep) -> list[Result]:
    """The runs of a sweep or map, with their errors against the references."""
    tasks = list(sweep.tasks())
    by_place = {result.at: result for result in follow(tasks)}
    pairs = [(task, by_place[task.at]) for task in tasks]
    converged = references.converged(pairs, follow)
    return [converged.measured(task, result) for task, result in pairs]


def follow(tasks: Sequence[Task], work: Work = run) -> list[Result]:
    """Run the tasks, and tell of those that failed."""
    finished = []
    for _, result in results(work, tasks):
        finished.append(result)
        if result.ending in FAILURES and result.group != references.GROUP:
            text = f"{result.ending.value} {result.detail.strip()[-100:]}"
            print(f"  {result.group} {list(result.at)}: {text}", flush=True)
    return finished


if __name__ == "__main__":
    sys.exit(main())
