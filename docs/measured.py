"""The tables of measured.md: aims, and what the measuring commands have kept of their last runs."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Sequence
from importlib import import_module
from itertools import groupby
from pathlib import Path
from typing import Any

from benchmarks import tolerances
from benchmarks.work_precision import table
from benchmarks.work_precision.measure import Point
from docs.markers import markdown
from validation.kept import kept
from validation.row import Row

RESULTS = Path(__file__).parents[1] / "benchmarks" / "results"
HEAD = ("aim", "measured", "met", "command")
SHOWN = (
    "goyal |Tw+Wr-Lk| to 32 s", "staggered goyal |Tw+Wr-Lk| before contact", "staggered goyal |Tw+Wr-Lk| to 34 s",
    "staggered goyal energy balance of the input, before contact",
    "staggered goyal energy balance of the input, to 34 s", "both methods, goyal Wr at 25 s",
    "both methods, goyal Wr at 32 s", "free flight 10 s, N = 1000, dt .25 ms, angular momentum",
    "staggered free flight 10 s, angular momentum", "error bars,",
)  # fmt: skip
"""How the rows begin that are shown one by one."""


def scenes() -> str:
    """How each published scene came out."""
    return markdown(HEAD, [_scene(scene, rows) for scene, rows in sorted(kept().items())])


def _scene(scene: str, rows: Sequence[Row]) -> tuple[str, ...]:
    title = " ".join((import_module(f"validation.{scene}").__doc__ or "").split("\n\n")[0].split()).rstrip(".")
    missed = [row for row in rows if not row.passed]
    nearest = max(rows, key=lambda row: row.error / row.aim if row.aim else 0.0)
    examples = "; ".join(f"{row.name}: off by {row.error:.2g}, aim {row.aim:.2g}" for row in missed or [nearest])
    aim = f"{title}: {len(rows)} values within their bounds"
    measured = f"{len(missed)} outside: {examples}" if missed else f"all; nearest to its bound: {examples}"
    return aim, measured, _met(not missed), f"`python -m validation {scene}`"


def figures() -> str:
    """The rows that are shown one by one."""
    rows = [(scene, row) for scene, rows in kept().items() for row in rows if row.name.startswith(SHOWN)]
    return markdown(HEAD, [
        (f"{row.name} ≤ {row.aim:.2g}", f"{row.error:.2g}", _met(row.passed), f"`python -m validation {scene}`")
        for scene, row in rows
    ])  # fmt: skip


COSTS = (
    ("iteration_us", "box method: a Newton iteration", "total", "µs"),
    ("staggered_us", "staggered method: a Newton iteration, three stages", "total", "µs"),
    ("scene_s", "goyal-2003 to 32 s with its frames, dt_max 0.1 s", "CPU with frames", "s"),
    ("writhe_us", "writhe of a frame", "writhe", "µs"),
    ("compilation_s", "a process that need not compile, with a run of goyal-2003 to 32 s at N = 100",
     "second process", "s"),
)  # fmt: skip
"""Tables of `make bench`: what they are about, and the column that has an aim."""


def costs() -> str:
    """CPU time of kernels and scenes."""
    results = _read("last.json")
    rows = [(subject, row, row[column], unit)
            for name, subject, column, unit in COSTS for row in results[name] if row["aim"]]  # fmt: skip
    return markdown(HEAD, [
        (f"{subject}{_at(row)}: at most {row['aim']:g} {unit}", f"{value:.3g} {unit}", _met(value <= row["aim"]),
         "`make bench`") for subject, row, value, unit in rows
    ])  # fmt: skip


def _at(row: dict[str, Any]) -> str:
    return f", N = {row['intervals']:g}" if "intervals" in row else ""


def skipping() -> str:
    """What a feature costs a scene that lacks it."""
    def case(row: dict[str, Any]) -> tuple[str, str, float]:
        return row["feature"], row["method"], row["aim"]

    rows = []
    for (feature, method, aim), same in groupby(sorted(_read("skipping.json")["rows"], key=case), case):
        ratios = [row["ratio"] for row in same]
        rows.append((feature, method, aim, ratios))
    return markdown(HEAD, [
        (f"{feature}, {method}: at most {aim:g}", f"{min(ratios):.3f} to {max(ratios):.3f}", _met(max(ratios) <= aim),
         "`make bench-skipping`") for feature, method, aim, ratios in rows
    ])  # fmt: skip


def errors() -> str:
    """CPU time in which the default mode reaches a true error."""
    rows = _read("tolerances.json")["rows"]
    return markdown(HEAD, [
        (f"goyal-2003 to 25 s, true error at most {error:.0e}: {aim:g} s", *_reached(rows, error, aim),
         "`make bench-tolerances`") for error, aim in tolerances.AIMS.items()
    ])  # fmt: skip


def _reached(rows: Sequence[dict[str, Any]], error: float, aim: float) -> tuple[str, str]:
    """What the cheapest run that reaches an error costs, and whether that is within the aim."""
    row = tolerances.reached(rows, error)
    if row is None:
        nearest = min(rows, key=lambda row: max(row["true"].values()))
        name, least = max(nearest["true"].items(), key=lambda item: item[1])
        return f"not reached: {name} {least:.1e} for {nearest['cpu_s']:.3g} s", _met(False)
    asked = next(row for row in rows if row["tolerance"] == error)
    measured = f"{row['cpu_s']:.3g} s by a tolerance of {row['tolerance']:.0e}"
    if row is not asked:
        measured += f"; {asked['cpu_s']:.3g} s by {error:.0e}, for {max(asked['true'].values()):.1e}"
    return measured, _met(row["cpu_s"] <= aim)


def peers() -> str:
    """Times less CPU than the peers at equal error."""
    return markdown(HEAD, [
        (f"{row.scene}, {row.quantity}: {row.aim:g} of {row.peer}", f"{_times(row.least)} to {_times(row.most)}",
         _met(row.least >= row.aim), "`make bench-work-precision`")
        for row in table.comparisons(_points()) if isinstance(row, table.Comparison)
    ])  # fmt: skip


def _times(ratio: float) -> str:
    return f"{ratio:.0f}" if ratio >= 100 else f"{ratio:.3g}"


def agreement() -> str:
    """Whether the methods agree within their error bars."""
    return markdown(HEAD, [
        (f"{row.scene}, {row.quantity}: box and staggered agree within their error bars", "; ".join(row.shown),
         _met(row.met), "`make bench-work-precision`") for row in table.agreements(_points())
    ])  # fmt: skip


def _points() -> list[Point]:
    return [Point(**point) for scene in _read("work_precision.json").values() for point in scene["points"]]


def _read(name: str) -> Any:
    return json.loads((RESULTS / name).read_text(encoding="utf-8"))


def _met(met: bool) -> str:
    return "yes" if met else "**missed**"


def origins() -> str:
    """The commit, the CPU and the versions that each command measured."""
    validated = json.loads((Path(__file__).parents[1] / "validation/results/rows.json").read_text(encoding="utf-8"))
    compared = _read("work_precision.json")
    parts: list[tuple[str, Iterable[str]]] = [
        ("python -m validation", _made_with(validated)), ("make bench", [_line(_read("last.json"))]),
        ("make bench-skipping", [_line(_read("skipping.json"))]), ("make bench-work-precision", _made_with(compared)),
        ("make bench-tolerances", [_line(_read("tolerances.json"))]),
    ]  # fmt: skip
    return markdown(("command", "measured with"), [(f"`{command}`", "; or ".join(lines)) for command, lines in parts])


def _made_with(parts: dict[str, Any]) -> list[str]:
    return list(dict.fromkeys(map(_line, parts.values())))


def _line(part: dict[str, Any]) -> str:
    return ", ".join(part["made with"])


TABLES: dict[str, Callable[[], str]] = {
    "scenes": scenes, "figures": figures, "costs": costs, "skipping": skipping, "errors": errors, "peers": peers,
    "agreement": agreement, "origins": origins,
}  # fmt: skip
