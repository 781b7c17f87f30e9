"""What was found, as text."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from stress.ending import FAILURES, Ending, Result

SHOWN = 12
"""Failures of a group that the text shows; the data have them all."""


def text(made_with: dict[str, list[str]], results: dict[str, list[Result]]) -> str:
    """The tables; `made_with` and `results` by group."""
    lines = ["# Stability under stress", "",
             "Endings are defined in `stress/ending.py`, what a run must show to be correct in `stress/books.py`.", "",
             "## How the runs ended", "", *endings(results), "", "## Named outcomes", ""]  # fmt: skip
    everything = [result for group in results.values() for result in group]
    outcomes = Counter(result.outcome for result in everything if result.ending is Ending.NAMED)
    lines += [f"- `{name}`: {count}" for name, count in outcomes.most_common()]
    lines += ["", "## How well the books of correct runs close", "", "Median / 99th percentile / largest.", ""]
    lines += [*closeness(results), "", "## Failures", ""]
    failed = {name: [result for result in group if result.ending in FAILURES] for name, group in results.items()}
    lines += [f"{sum(map(len, failed.values()))} of {len(everything)} runs.", ""]
    for name, runs in failed.items():
        lines += [f"- {name} {list(run.at)}: {run.ending.value}, {_first(run.detail)}" for run in runs[:SHOWN]]
        if len(runs) > SHOWN:
            lines.append(f"- {name}: {len(runs) - SHOWN} more, in the data")
    lines += ["", "## What it was run with", ""]
    lines += [f"- {name}: {'; '.join(facts)}" for name, facts in made_with.items()]
    return "\n".join(lines) + "\n"


def endings(results: dict[str, list[Result]]) -> list[str]:
    """Runs by group and ending, and their CPU time."""
    everything = [result for group in results.values() for result in group]
    occurring = [ending for ending in Ending if any(result.ending is ending for result in everything)]
    rows = []
    for name, runs in [*results.items(), ("all", everything)]:
        counts = Counter(result.ending for result in runs)
        rows.append([name, len(runs), *(counts[ending] for ending in occurring), f"{sum(r.cpu for r in runs):.0f}"])
    return table(["runs of", "runs", *(ending.value for ending in occurring), "CPU s"], rows)


def closeness(results: dict[str, list[Result]]) -> list[str]:
    """Median, 99th percentile and largest of what must vanish."""
    names = ("balance", "stretch", "turns", "error")
    rows = []
    for name_of_group, group in results.items():
        correct = [result for result in group if result.ending is Ending.CORRECT]
        cells = []
        for name in names:
            values = np.array([abs(getattr(result, name)) for result in correct])
            values = values[np.isfinite(values)]
            cells.append(" / ".join(f"{np.quantile(values, q):.0e}" for q in (0.5, 0.99, 1.0)) if len(values) else "")
        rows.append([name_of_group, *cells])
    return table(["runs of", "energy / turnover", "stretch", "Tw+Wr-Lk", "error / L"], rows)


def table(header: Sequence[str], rows: Iterable[Sequence[Any]]) -> list[str]:
    """Lines of a table."""
    lines = ["| " + " | ".join(header) + " |", "| --- " + "| ---: " * (len(header) - 1) + "|"]
    return lines + ["| " + " | ".join(str(value) for value in row) + " |" for row in rows]


def _first(detail: str) -> str:
    lines = [line for line in detail.strip().splitlines() if line]
    return lines[-1][:160] if lines else ""
