"""`python -m chaos`: faults campaigns, on loopback, bounded; prints what became of the jobs, 1 if any went wrong."""

from __future__ import annotations

import argparse
import os
import sys
import tempfile
import time
from pathlib import Path

from chaos.campaign import environment, run_seed
from chaos.cases import cases, undisturbed, with_halves
from chaos.judge import judge
from chaos.postgres import binaries
from chaos.report import Report
from hockle.supervisor import ENVIRONMENT, stop_on_signals

KINDS = ("sqlite", "postgresql")


def main() -> int:
    """Run the seeds on each database, and keep a table for each."""
    parser = argparse.ArgumentParser(prog="python -m chaos", description=__doc__)
    parser.add_argument("--database", choices=[*KINDS, "both"], default="both")
    parser.add_argument("--seeds", type=int, default=10)
    parser.add_argument("--first", type=int, default=1, help="the first seed")
    parser.add_argument("--jobs", type=int, default=50, help="at least so many in each seed")
    parser.add_argument("--faults", type=int, default=50, help="at least so many in each seed")
    arguments = parser.parse_args()
    stop_on_signals()  # and clean up then
    os.environ |= ENVIRONMENT
    named_cases = with_halves(cases())
    expected = {name: undisturbed(case) for name, case in named_cases.items()}
    kinds = KINDS if arguments.database == "both" else (arguments.database,)
    good = True
    for kind in kinds:
        if kind == "postgresql" and binaries() is None:
            print("postgresql: not on this machine, left out")
            continue
        seeds = range(arguments.first, arguments.first + arguments.seeds)
        good &= campaign(kind, seeds, arguments.jobs, arguments.faults, named_cases, expected)
    return 0 if good else 1


def campaign(kind: str, seeds: range, jobs: int, faults: int, named_cases: dict[str, dict[str, object]],
             expected: dict[str, str]) -> bool:
    """Run the seeds on one kind of database, keeping what is known after each; whether all went well."""
    report = Report(kind)
    for seed in seeds:
        print(f"{kind}, seed {seed}", file=sys.stderr, flush=True)
        began = time.monotonic()
        with (
            tempfile.TemporaryDirectory(prefix="hockle-chaos-", ignore_cleanup_errors=True) as directory,
            environment(kind, Path(directory) / "data") as (settings, server, small),
        ):
            record, watch = run_seed(seed, settings, server, small, named_cases, jobs, faults)
            verdict = judge(record, watch, settings, expected)
            if not verdict.good:
                print(_logs(settings.data), file=sys.stderr)
        report.add(seed, verdict, record.faults, time.monotonic() - began)
        print(report.lines[-1], flush=True)
        report.keep()
    print(report.text())
    return report.total.good


def _logs(data: Path) -> str:
    """What the processes have said, but for what is usual."""
    return "\n".join(f"--- {path}\n{_unusual(path)}" for path in data.glob("logs/*.log"))


def _unusual(log: Path) -> str:
    lines = log.read_text(errors="replace").splitlines()
    return "\n".join([line for line in lines if '"level": "info"' not in line][-100:])


if __name__ == "__main__":
    sys.exit(main())
