"""The table of what was measured: latencies as numbers, and how they are shown."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass


@dataclass(frozen=True)
class Row:
    """Latencies (s) of one thing, and what they shall be. `rate`: how many a second, where that is told; `control`:
    the same thing without what is tried here; `cpu`: CPU time (s) that the service took for each."""

    what: str
    seconds: Sequence[float]
    aim: str = ""
    rate: float | None = None
    control: Row | None = None
    cpu: float | None = None

    def quantile(self, part: float) -> float:
        """The latency (s) that this part of them does not reach."""
        return sorted(self.seconds)[min(len(self.seconds) - 1, int(part * len(self.seconds)))]

    @property
    def ratio(self) -> float | None:
        """The median by that of the control."""
        return None if self.control is None else self.quantile(0.5) / self.control.quantile(0.5)

    def cells(self) -> dict[str, str]:
        """What the table shows, by its columns."""
        return {
            "what": self.what, "n": str(len(self.seconds)), "p50 ms": f"{1e3 * self.quantile(0.5):.2f}",
            "p99 ms": f"{1e3 * self.quantile(0.99):.1f}", "CPU ms": "" if self.cpu is None else f"{1e3 * self.cpu:.1f}",
            "a second": "" if self.rate is None else f"{self.rate:.0f}",
            "aim": self.aim, "p50 / that of the control": "" if self.ratio is None else f"{self.ratio:.2f}",
        }  # fmt: skip


def table(rows: Sequence[Row]) -> list[str]:
    """The lines of a table in Markdown, without the columns in which nothing stands."""
    cells = [row.cells() for row in rows]
    columns = [name for name in cells[0] if any(row[name] for row in cells)]
    return [_line(columns), "|---" * len(columns) + "|", *(_line([row[name] for name in columns]) for row in cells)]


def _line(cells: Sequence[str]) -> str:
    return "| " + " | ".join(cells) + " |"
