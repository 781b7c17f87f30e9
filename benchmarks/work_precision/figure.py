"""The figure: error over CPU time, a panel a scene and quantity."""

from __future__ import annotations

from collections.abc import Iterable
from math import ceil, floor, log10
from pathlib import Path

from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter

from benchmarks.work_precision.measure import (
    AS_IT_COMES,
    BOX,
    DEFAULT,
    METHODS,
    PAPER,
    PYELASTICA,
    STAGGERED,
    STATICS,
    Point,
)
from benchmarks.work_precision.table import panels

COLUMNS = 3
STYLE = {BOX: ("C0", "o"), STAGGERED: ("C3", "s"), STATICS: ("C4", "P"), DEFAULT: ("k", "*"), PAPER: ("C9", "x"),
         PYELASTICA: ("C2", "^")}  # fmt: skip
MUJOCO_STYLE = (("C1", "v"), ("C5", "D"))


def draw(points: Iterable[Point], file: Path) -> None:
    """Draw all panels into a file."""
    shown = panels(points)
    rows = ceil(len(shown) / COLUMNS)
    figure = Figure(figsize=(4.6 * COLUMNS, 3.7 * rows), layout="constrained")
    axes = figure.subplots(rows, COLUMNS, squeeze=False).ravel()
    styles = _styles(points)
    handles = {}
    for axis, ((scene, quantity), all_points) in zip(axes, shown.items(), strict=False):
        for solver, style in styles.items():
            curve = sorted((p.cpu, p.error) for p in all_points if p.solver == solver and not p.missing)
            if curve:
                handles[solver] = axis.loglog(*zip(*curve, strict=True), **style)[0]
        for line in (axis.xaxis, axis.yaxis):  # whole decades, and only they are named
            low, high = (log10(value) for value in line.get_data_interval())
            line.axes.set(**{f"{line.axis_name}lim": (10.0 ** floor(low), 10.0 ** ceil(high))})
            line.set_minor_formatter(NullFormatter())
        axis.set_title(f"{scene}: {quantity}", fontsize=10)
        axis.set_xlabel("CPU s")
        axis.set_ylabel("error")
        axis.grid(alpha=0.3)
    for axis in axes[len(shown):]:
        axis.set_axis_off()
    figure.legend(handles.values(), handles.keys(), loc="outside lower center", ncols=4, fontsize=9)
    figure.savefig(file, dpi=110)


def _styles(points: Iterable[Point]) -> dict[str, dict[str, object]]:
    solvers = dict.fromkeys(p.solver for p in points)
    peers = [s for s in solvers if s.removesuffix(AS_IT_COMES) not in STYLE and not s.endswith(AS_IT_COMES)]
    styles = STYLE | dict(zip(peers, MUJOCO_STYLE, strict=False))
    drawn = {}
    for solver in [*METHODS, *(s for s in solvers if s not in METHODS)]:
        colour, marker = styles[solver.removesuffix(AS_IT_COMES)]
        raw = solver.endswith(AS_IT_COMES)
        drawn[solver] = {"color": colour, "marker": marker, "linestyle": ":" if raw else "-",
                         "fillstyle": "none" if raw else "full", "markersize": 5}  # fmt: skip
    return drawn
