"""What was done, and what became of the jobs, as a table."""

from __future__ import annotations

import os
from collections import Counter
from pathlib import Path

from chaos.judge import Verdict
from validation.provenance import provenance

RESULTS = Path(__file__).parent / "results"
COLUMNS = ("jobs", "faults", "published", "read_live", "lost", "duplicated", "overlaps", "not_identical", "not_as_read",
           "wrong_outcome", "left_over", "miscounted")  # fmt: skip
HEAD = ("seed", *(name.replace("_", " ") for name in COLUMNS), "redone", "s", "")


class Report:
    """The seeds that were run on one kind of database, so far."""

    def __init__(self, kind: str) -> None:
        self.kind, self.total, self.faults = kind, Verdict(), Counter[str]()
        self._made_with = [*provenance(), f"{os.cpu_count()} cores"]
        self.lines: list[str] = []

    def add(self, seed: int, verdict: Verdict, faults: Counter[str], seconds: float) -> None:
        """One more seed, which took so many seconds."""
        self.total, self.faults = self.total + verdict, self.faults + faults
        self.lines.append(_row(str(seed), verdict, f"{seconds:.0f}"))

    def text(self) -> str:
        """The table, in Markdown."""
        lines = [f"# Faults on {self.kind}", "", *(f"- {line}" for line in self._made_with), ""]
        lines += ["| " + " | ".join(HEAD) + " |", "|" + " ---: |" * len(HEAD), *self.lines,
                  _row(f"{len(self.lines)} seeds", self.total, ""), ""]
        lines += _counts("fault", self.faults) + _counts("outcome", self.total.outcomes)
        return "\n".join(lines)

    def keep(self) -> None:
        """Write the table into results/."""
        RESULTS.mkdir(exist_ok=True)
        (RESULTS / f"{self.kind}.md").write_text(self.text(), encoding="utf-8")


def _row(name: str, verdict: Verdict, seconds: str) -> str:
    counts = [str(getattr(verdict, column)) for column in COLUMNS]
    cells = [name, *counts, f"{verdict.redone:.1%}", seconds, "good" if verdict.good else "BAD"]
    return "| " + " | ".join(cells) + " |"


def _counts(title: str, counts: Counter[str]) -> list[str]:
    rows = [f"| {name} | {count} |" for name, count in counts.most_common()]
    return [f"| {title} | n |", "| :--- | ---: |", *rows, ""]
