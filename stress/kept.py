"""What was found, kept in a folder: data, tables and maps, each group as it was last run."""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from dataclasses import asdict
from math import nan
from pathlib import Path
from typing import Any

from stress import figure, report
from stress.ending import Ending, Result
from stress.sweeps import MAPS, SWEEPS

STEM = "stress"


class Kept:
    """The groups of runs in a folder; `made_with`: by group, with what they were run."""

    def __init__(self, folder: Path) -> None:
        self._folder, self._file = folder, folder / f"{STEM}.json"
        groups = json.loads(self._file.read_text(encoding="utf-8")) if self._file.is_file() else {}
        self.made_with: dict[str, list[str]] = {name: group["made with"] for name, group in groups.items()}
        self.results = {name: [_read(run) for run in group["runs"]] for name, group in groups.items()}

    def keep(self, name: str, made_with: list[str], results: Sequence[Result]) -> None:
        """Put a group in the place of what was kept of it, and bring tables and figures up to date."""
        self.made_with[name], self.results[name] = made_with, list(results)
        self._folder.mkdir(exist_ok=True)
        self._file.write_text(self._data(), encoding="utf-8")
        (self._folder / f"{STEM}.md").write_text(self.text(), encoding="utf-8")
        for sweep in MAPS:
            if sweep.name == name:
                stem = re.sub(r"[^a-zA-Z0-9]+", "-", name).lower()
                figure.draw_map(sweep, results, self._folder / f"{stem}.png")
        shown = [sweep for sweep in SWEEPS if sweep.name in self.results]
        if name in (sweep.name for sweep in shown):
            runs = [result for sweep in shown for result in self.results[sweep.name]]
            figure.draw_sweeps(shown, runs, self._folder / "sweeps.png")

    def text(self) -> str:
        """The tables."""
        return report.text(self.made_with, self.results)

    def _data(self) -> str:
        groups = []
        for name, results in self.results.items():
            runs = ",\n".join(json.dumps(_plain(result)) for result in results)
            made_with = json.dumps(self.made_with[name])
            groups.append(f'{json.dumps(name)}: {{"made with": {made_with}, "runs": [\n{runs}]}}')
        return "{\n" + ",\n".join(groups) + "\n}\n"


def _plain(result: Result) -> dict[str, Any]:
    """A result as plain data, without what says nothing: NaN, empty and the centreline."""
    out: dict[str, Any] = {}
    for key, value in asdict(result).items():
        if isinstance(value, float):
            if value == value:
                out[key] = float(f"{value:.3g}")
        elif key != "r" and value not in ("", None):
            out[key] = value
    return out


def _read(run: dict[str, Any]) -> Result:
    return Result(**{"error": nan, **run, "at": tuple(run["at"]), "ending": Ending(run["ending"])})
