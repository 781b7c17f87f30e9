"""What the rehearsal did and saw, as a table."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from time import monotonic

FILE = Path(__file__).parents[1] / "results" / "rehearsal.md"


class Record:
    """The steps so far."""

    def __init__(self) -> None:
        self._rows: list[tuple[str, str, float]] = []

    @contextmanager
    def step(self, what: str) -> Iterator[Callable[[str], None]]:
        """A step, which may say what it saw. Whatever it raises ends the rehearsal."""
        said: list[str] = []
        began = monotonic()
        print(f"{what} ...", file=sys.stderr, flush=True)
        yield said.append
        self._rows.append((what.rstrip("."), "; ".join(said) or "done", monotonic() - began))
        print(f"    {self._rows[-1][1]} ({self._rows[-1][2]:.0f} s)", file=sys.stderr, flush=True)

    def write(self, commit: str) -> None:
        """Keep the table, of an image of that commit."""
        where = ", ".join([f"image of commit {commit}", _told(["uname", "-sr"]), _told(["buildah", "--version"])])
        lines = ["# The rehearsal", "", f"`make rehearse`: {where}.",
                 "Each row is a step that ended as it should; the first that does not ends the rehearsal.", "",
                 "| step | seen | s |", "| --- | --- | ---: |"]  # fmt: skip
        lines += [f"| {what} | {seen} | {seconds:.0f} |" for what, seen, seconds in self._rows]
        FILE.parent.mkdir(exist_ok=True)
        FILE.write_text("\n".join(lines) + "\n")
        print(f"written to {FILE}", file=sys.stderr)


def _told(command: list[str]) -> str:
    return subprocess.check_output(command, text=True).split(" (")[0].strip()
