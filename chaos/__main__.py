"""`python -m chaos`: faults campaigns, on loopback, bounded; prints what became of the jobs, 1 if any went wrong."""

from __future__ import annotations

import argparse
import os
import platform
import sys
import tempfile
import time
from collections import Counter
from dataclasses import fields
from pathlib import Path

from chaos.campaign import environment, run_seed
from chaos.cases import cases, undisturbed
from chaos.judge import Verdict, judge
from chaos.postgres import binaries

KINDS = ("sqlite", "postgresql")


def main() -> int:
    """Run the seeds on each database, and print a table for each."""
    parser = argparse.ArgumentParser(prog="python -m chaos", description=__doc__)
    parser.add_argument("--database", choices=[*KINDS, "both"], default="both")
    parser.add_argument("--seeds", type=int, default=10)
    parser.add_argument("--first", type=int, default=1, help="the first seed")
    parser.add_argument("--jobs", type=int, default=50, help="at least so many in each seed")
    parser.add_argument("--faults", type=int, default=50, help="at least so many in each seed")
    told = parser.parse_args()
    os.environ |= {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    known = cases()
    expected = {name: undisturbed(case) for name, case in known.items()}
    kinds = KINDS if told.database == "both" else (told.database,)
    good = True
    for kind in kinds:
        if kind == "postgresql" and binaries() is None:
            print("postgresql: not on this machine, left out")
            continue
        good &= campaign(kind, range(told.first, told.first + told.seeds), told.jobs, told.faults, known, expected)
    return 0 if good else 1


def campaign(kind: str, seeds: range, jobs: int, faults: int, known: dict[str, dict[str, object]],
             expected: dict[str, str]) -> bool:
    """Run the seeds on one kind of database; whether all went well."""
    total, done = Verdict(), Counter[str]()
    for seed in seeds:
        began = time.monotonic()
        with (
            tempfile.TemporaryDirectory(prefix="hockle-chaos-", ignore_cleanup_errors=True) as directory,
            environment(kind, Path(directory) / "data") as (settings, server, small),
        ):
            record, watch = run_seed(seed, settings, server, small, known, jobs, faults)
            verdict = judge(record, watch, settings, expected)
            if not verdict.good:
                print(_logs(settings.data), file=sys.stderr)
        total, done = total + verdict, done + record.faults
        print(f"{kind}, seed {seed}: {verdict.jobs} jobs, {verdict.faults} faults, redone {verdict.redone:.1%}, "
              f"{time.monotonic() - began:.0f} s, {'good' if verdict.good else f'BAD: {verdict}'}", flush=True)
    print(table(kind, seeds, total, done))
    return total.good


def table(kind: str, seeds: range, total: Verdict, done: Counter[str]) -> str:
    """What was done, and what became of the jobs."""
    lines = [f"\n{kind}, seeds {seeds.start} to {seeds.stop - 1}, {platform.machine()}, {os.cpu_count()} cores"]
    lines += [f"  {name:30} {count:6}" for name, count in done.most_common()]
    lines += ["  " + "-" * 37]
    counts = {field.name: getattr(total, field.name) for field in fields(total) if field.name != "outcomes"}
    lines += [f"  {name:30} {count:6}" for name, count in counts.items()]
    lines += [f"  outcome {name:22} {count:6}" for name, count in total.outcomes.most_common()]
    return "\n".join([*lines, f"  {'redone':30} {total.redone:6.1%}", f"  {'GOOD' if total.good else 'BAD'}\n"])


def _logs(data: Path) -> str:
    return "\n".join(f"--- {path}\n{path.read_text(errors='replace')[-4000:]}" for path in data.glob("logs/*.log"))


if __name__ == "__main__":
    sys.exit(main())
