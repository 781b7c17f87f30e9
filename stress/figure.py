"""The maps: how every run of a sweep ended, in colour, with the error against the reference or what stopped it."""

from __future__ import annotations

from collections.abc import Sequence
from math import isnan
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from stress.ending import Ending, Result
from stress.sweeps import Axis, Sweep

COLOURS = {
    Ending.CORRECT: "#86c5a0", Ending.NAMED: "#f2d479", Ending.OUT_OF_BUDGET: "#b9c6d8", Ending.LOST_ENERGY: "#e3a06a",
    Ending.MADE_ENERGY: "#d1495b", Ending.STRETCHED: "#b2568f", Ending.TURNS_LOST: "#8a5ba6",
    Ending.OUT_OF_BALANCE: "#7a6a58", Ending.CROSSED: "#5a3d8a", Ending.NOT_FINITE: "#802020",
    Ending.EXCEPTION: "#404040", Ending.CRASH: "#202020", Ending.HANG: "#000000",
}  # fmt: skip
ENDINGS = list(COLOURS)
SHORT = {
    "step_too_small": "step", "rod_crossed_itself": "cross", "mesh_too_coarse": "mesh", "no_consistent_start": "start",
    "singular_system": "sing.", "equilibrium_lost": "lost", "path_turned_back": "back",
    "shooting_lost_digits": "digits",
}  # fmt: skip


def draw_map(sweep: Sweep, results: Sequence[Result], file: Path) -> None:
    """A map, a panel a method."""
    assert sweep.across is not None
    x, y, methods = sweep.along, sweep.across, sweep.methods
    width = max(1.6 + 0.62 * len(x.values), 4.4)
    figure = Figure(figsize=(width * len(methods), 1.9 + 0.42 * len(y.values)), layout="constrained")
    for axis, method in zip(figure.subplots(1, len(methods), squeeze=False)[0], methods, strict=True):
        cells = [[_find(results, (method, u, w)) for u in x.values] for w in y.values]
        _paint(axis, cells)
        _label(axis, x, [_text(w) for w in y.values], method)
        axis.set_ylabel(y.name)
    figure.suptitle(f"{sweep.name} (scene: {sweep.scene})", fontsize=11)
    _legend(figure, results)
    figure.savefig(file, dpi=110)


def draw_sweeps(sweeps: Sequence[Sweep], results: Sequence[Result], file: Path) -> None:
    """All sweeps along one axis, a strip each, a row a method."""
    heights = [len(sweep.methods) for sweep in sweeps]
    figure = Figure(figsize=(12.0, 1.2 + 0.42 * sum(heights) + 0.75 * len(sweeps)), layout="constrained")
    all_axes = figure.subplots(len(sweeps), 1, height_ratios=[h + 0.2 for h in heights], squeeze=False)[:, 0]
    for axis, sweep in zip(all_axes, sweeps, strict=True):
        of_sweep = [result for result in results if result.group == sweep.name]
        _paint(axis, [[_find(of_sweep, (method, x, None)) for x in sweep.along.values] for method in sweep.methods])
        _label(axis, sweep.along, list(sweep.methods), "")
        axis.set_title(f"{sweep.along.name} (scene: {sweep.scene})", fontsize=9, loc="left")
        axis.set_xlabel("")
    _legend(figure, results)
    figure.savefig(file, dpi=100)


def _find(results: Sequence[Result], at: tuple[Any, ...]) -> Result | None:
    return next((result for result in results if tuple(result.at) == at), None)


def _paint(axis: Axes, cells: list[list[Result | None]]) -> None:
    colours = ListedColormap([COLOURS[ending] for ending in ENDINGS])
    numbers = np.array([[ENDINGS.index(cell.ending) if cell else -1 for cell in row] for row in cells])
    image = np.ma.masked_less(numbers, 0)
    axis.imshow(image, cmap=colours, norm=BoundaryNorm(np.arange(len(ENDINGS) + 1) - 0.5, len(ENDINGS)),
                aspect="auto", origin="lower")  # fmt: skip
    for i, row in enumerate(cells):
        for j, cell in enumerate(row):
            if cell is not None:
                dark = cell.ending not in (Ending.CORRECT, Ending.NAMED, Ending.OUT_OF_BUDGET, Ending.LOST_ENERGY)
                axis.text(j, i, _cell_text(cell), ha="center", va="center", fontsize=6.5, color="w" if dark else "k")
    axis.set_xticks(np.arange(len(cells[0]) + 1) - 0.5, minor=True)
    axis.set_yticks(np.arange(len(cells) + 1) - 0.5, minor=True)
    axis.grid(which="minor", color="w", linewidth=1.2)
    axis.tick_params(which="minor", length=0)


def _cell_text(result: Result) -> str:
    if result.ending is Ending.NAMED:
        return SHORT.get(result.outcome, result.outcome)
    if result.ending in (Ending.LOST_ENERGY, Ending.MADE_ENERGY):
        return f"{result.balance:.0%}"
    return "" if isnan(result.error) else f"{result.error:.0e}".replace("e-0", "e-").replace("e+00", "")


def _label(axis: Axes, x: Axis, rows: list[str], title: str) -> None:
    long = any(len(_text(value)) > 6 for value in x.values)
    axis.set_xticks(range(len(x.values)), [_text(value) for value in x.values], fontsize=7,
                    rotation=18 if long else 0, ha="right" if long else "center")  # fmt: skip
    axis.set_yticks(range(len(rows)), rows, fontsize=8)
    axis.set_xlabel(x.name)
    axis.set_title(title, fontsize=10)


def _text(value: Any) -> str:
    return value if isinstance(value, str) else f"{value:g}"


def _legend(figure: Figure, results: Sequence[Result]) -> None:
    seen = {result.ending for result in results}
    handles = [Patch(color=colour, label=ending.value) for ending, colour in COLOURS.items() if ending in seen]
    note = "number: distance from the reference / L, or energy missing (-) or made (+) / turnover"
    figure.legend(handles=handles, loc="outside lower center", ncols=min(len(handles), 4), fontsize=8, title=note,
                  title_fontsize=7)  # fmt: skip
