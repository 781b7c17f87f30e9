"""`python -m stress.plausible`: does each plausible scene get an answer in the default mode, and what does it cost?"""

from __future__ import annotations

import argparse
import json
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import asdict
from multiprocessing import get_context
from pathlib import Path
from statistics import median

from stress.plausible.bank import EACH, KINDS
from stress.plausible.run import ANSWERED, FAILED, LATE, REFUSED, Report, run
from stress.report import table
from validation.provenance import provenance

RESULTS = Path(__file__).parents[1] / "results"
CPU, PROCESSES, FACTOR = 60.0, 3, 3.0
HEADER = ("kind", "scenes", ANSWERED, "tolerance met", FAILED, LATE, REFUSED, "CPU s, median", "largest",
          "how they failed")  # fmt: skip


def main() -> int:
    """Run the bank, or a part of it; write the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--each", type=int, default=EACH, help="scenes of each kind")
    parser.add_argument("--kinds", default=",".join(KINDS), help="by name, with commas")
    parser.add_argument("--cpu", type=float, default=CPU, help="seconds of CPU time that a scene may take")
    arguments = parser.parse_args()
    tasks = [(kind, number, arguments.cpu) for kind in arguments.kinds.split(",") for number in range(arguments.each)]
    reports = []
    with ProcessPoolExecutor(PROCESSES, get_context("spawn")) as pool:
        for future in as_completed([pool.submit(run, *task) for task in tasks]):
            reports.append(future.result())
            report = reports[-1]
            print(f"{report.kind:16} {report.number:3} {report.ending:12} {report.outcome:24} {report.cpu:6.2f} s  "
                  f"{report.notes}", flush=True)  # fmt: skip
    reports.sort(key=lambda report: (report.kind, report.number))
    made_with = f"Measured with {'; '.join(provenance())}; at most {arguments.cpu:g} s of CPU time a scene."
    text = "\n".join([made_with, "", *written(reports)])
    print(text)
    (RESULTS / "plausible.md").write_text(f"# Plausible scenes in the default mode\n\n{text}\n")
    (RESULTS / "plausible.json").write_text(json.dumps([asdict(report) for report in reports], indent=1) + "\n")
    return 0


def written(reports: Sequence[Report]) -> list[str]:
    """The table by kinds, and what the whole bank says."""
    kinds = sorted({report.kind for report in reports})
    rows = [_row(kind, [report for report in reports if report.kind == kind]) for kind in kinds]
    return [*table(HEADER, [*rows, _row("all", reports)]), "", *_sentences(reports)]


def _row(name: str, reports: Sequence[Report]) -> list[str]:
    counts = [sum(report.ending == ending for report in reports) for ending in (ANSWERED, FAILED, LATE, REFUSED)]
    met = sum(report.attributes.get("tolerance_met") == "yes" for report in reports if report.ending == ANSWERED)
    times = [report.cpu for report in reports if report.cpu] or [0.0]
    how = ", ".join(sorted({report.outcome for report in reports if report.ending == FAILED}))
    return [name, str(len(reports)), str(counts[0]), str(met), *map(str, counts[1:]), f"{median(times):.2f}",
            f"{max(times):.1f}", how]  # fmt: skip


def _sentences(reports: Sequence[Report]) -> list[str]:
    answered = [report for report in reports if report.ending == ANSWERED]
    near = [report for report in answered if report.cpu / FACTOR <= report.expected <= report.cpu * FACTOR]
    crossed = [report for report in reports if report.outcome == "rod_crossed_itself"]
    return [
        f"- Answered: {len(answered) / len(reports):.1%} (aim 98 %).",
        f"- Cost estimate within a factor of {FACTOR:g}: {len(near) / max(len(answered), 1):.1%} (aim 90 %).",
        f"- Named crossings: {len(crossed) / len(reports):.1%} (aim below 1 %).",
    ]


if __name__ == "__main__":
    raise SystemExit(main())
