"""What was tried, what was seen, and what must be seen, as a table."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

RESULT = Path(__file__).parents[1] / "results" / "attack.md"


@dataclass(frozen=True)
class Row:
    """One attack."""

    what: str
    seen: str
    must: str
    good: bool


def text(made_with: Sequence[str], rows: Sequence[Row]) -> str:
    """The table, in Markdown, with what it was made with."""
    lines = ["# Attacks", "", *(f"- {line}" for line in made_with), "",
             "| attack | seen | must be |  |", "| :--- | :--- | :--- | :--- |"]
    lines += [f"| {row.what} | {row.seen} | {row.must} | {'good' if row.good else 'BAD'} |" for row in rows]
    return "\n".join([*lines, ""])


def keep(made_with: Sequence[str], rows: Sequence[Row]) -> None:
    """Write the table into the results."""
    RESULT.write_text(text(made_with, rows), encoding="utf-8")
