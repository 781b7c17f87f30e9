"""The paper's figures 6, 7 and 8 for any dataset: shapes, energies, twist and writhe."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from hockle.stage import Stage
from hockle.tube import Tube
from hockle.view import View

PAPERS_TIMES = (20.0, 25.0, 29.0, 32.0)
SNAPSHOTS, MOST_FRAMES, MOST_NODES = 4, 400, 60
STYLE: dict[Any, Any] = {
    "font.size": 10,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.color": "#e3e6ea",
    "grid.linewidth": 0.7,
    "axes.edgecolor": "#6b7280",
    "lines.linewidth": 1.8,
    "legend.frameon": False,
}
BENDING, TORSION, KINETIC, OTHER = "#c2410c", "#1d4ed8", "#15803d", ("#7c3aed", "#0891b2", "#a16207")
ENERGIES = (
    ("energy_torsion", "torsional", TORSION),
    ("energy_bending", "bending", BENDING),
    ("energy_stretching", "stretching", OTHER[2]),
    ("energy_kinetic", "kinetic", KINETIC),
    ("energy_contact", "contact", OTHER[0]),
    ("energy_potential", "potential, from its start", OTHER[1]),
)
NOISE = 1e-4
"""An energy that is never this part of the largest may be noise."""

UNSEEN = 5e-3
"""An energy that is never this part of the largest cannot be told from zero beside it: half the width of a line."""

UNMOVED = 2e-3
"""Shapes that differ by less than this part of their extent look the same."""

FEW = 30
"""Frames; a curve through fewer shows where they are."""

LEAST_TURNS = 1e-3
"""Twist and writhe below are noise of the computation, or nothing to be seen."""

LEAST_CHANGE = 0.01
"""Curves that change by less than this part of their size are drawn with their zero: what changes may be noise."""

PREFIXES = ((1e6, "M"), (1e3, "k"), (1.0, ""), (1e-3, "m"), (1e-6, "µ"), (1e-9, "n"))


def snapshots(dataset: xr.Dataset) -> Figure:
    """The rod at four times (figure 6): thickened tubes with a stripe along a1 that shows the twist."""
    case = json.loads(dataset.attrs["case"])
    view = View.of(case, dataset.r.values)
    frames = [dataset.sel(time=t, method="nearest") for t in snapshot_times(dataset)]
    tubes = [Tube.of(frame.r.values, frame.orientation.values).turned(view.axes) for frame in frames]
    start = dataset.r.values[0] @ view.axes.T
    with mpl.rc_context(STYLE):
        points = np.vstack([*(tube.r for tube in tubes), start])
        stage = Stage([case] * len(tubes), [view] * len(tubes), points, ", dashed: at first")
        for i, (tube, frame) in enumerate(zip(tubes, frames, strict=True)):
            stage.draw(i, tube, f"t = {float(frame.time):g} s", start)
        stage.title(dataset.attrs["title"])
    return stage.figure


def energies(dataset: xr.Dataset) -> Figure:
    """Strain energies and kinetic energy in time (figure 7), and what else there is of energy."""
    changes = [(dataset[name].values - _level(name, dataset), label, colour) for name, label, colour in ENERGIES
               if name in dataset]  # fmt: skip
    largest = max(float(np.abs(values).max()) for values, _, _ in changes)
    scale, prefix = prefixed(largest)
    with mpl.rc_context(STYLE):
        figure, axes = panel(_over(dataset), f"energy ({prefix}J)")
        for values, label, colour in changes:
            if np.abs(values).max() > UNSEEN * largest:
                axes.plot(dataset.time, values / scale, color=colour, label=label, **_marked(dataset))
        finish(axes, dataset)
    return figure


def topology(dataset: xr.Dataset) -> Figure:
    """Twist, writhe and linking number in time (figure 8)."""
    with mpl.rc_context(STYLE):
        figure, axes = panel(_over(dataset), "turns")
        for name, colour in (("Lk", "#374151"), ("Tw", TORSION), ("Wr", BENDING)):
            axes.plot(dataset.time, dataset[name], color=colour, label=name, **_marked(dataset))
        finish(axes, dataset)
    return figure


def is_twisted(dataset: xr.Dataset) -> bool:
    """Whether there is any twist or writhe to be seen. Lk alone says nothing: ends may turn freely."""
    return any(float(np.abs(dataset[name]).max()) > LEAST_TURNS for name in ("Tw", "Wr"))


def snapshot_times(dataset: xr.Dataset) -> Sequence[float]:
    """The paper's times for the paper's cable, otherwise those at which the shapes differ most from each other."""
    times = dataset.time.values
    if dataset.attrs["case_name"] == "goyal-2003" and times[-1] >= PAPERS_TIMES[-1]:
        return PAPERS_TIMES
    frames = np.unique(np.linspace(0, len(times) - 1, MOST_FRAMES).astype(int))
    nodes = np.unique(np.linspace(0, dataset.sizes["s"] - 1, MOST_NODES).astype(int))
    return [float(times[frames[i]]) for i in _most_different(dataset.r.values[frames][:, nodes])]


def _most_different(r: NDArray[np.float64]) -> list[int]:
    """The first frame, and then again and again the one that is farthest from all those chosen; in order of time.

    The last one beside the first where the rod does not move.
    """
    chosen = [0]
    least = UNMOVED * float(np.ptp(r, axis=(0, 1)).max())
    distance = np.abs(r - r[0]).max(axis=(1, 2))
    while len(chosen) < SNAPSHOTS and distance.max() > least:
        chosen.append(int(distance.argmax()))
        distance = np.minimum(distance, np.abs(r - r[chosen[-1]]).max(axis=(1, 2)))
    return sorted(chosen) if len(chosen) > 1 else [0, len(r) - 1]


def _over(dataset: xr.Dataset) -> str:
    """What curves are drawn over: equilibria have a parameter instead of time."""
    return "parameter (s)" if json.loads(dataset.attrs["case"]).get("analysis") == "static" else "time (s)"


def _marked(dataset: xr.Dataset) -> dict[str, Any]:
    return {"marker": "o", "markersize": 4} if dataset.sizes["time"] < FEW else {}


def _level(name: str, dataset: xr.Dataset) -> float:
    """What an energy counts from: that of the first frame for a potential, whose zero is where the lab's is."""
    return float(dataset[name][0]) if name == "energy_potential" else 0.0


def prefixed(largest: float) -> tuple[float, str]:
    """The factor and the name of the SI prefix with which numbers up to `largest` are short."""
    return next((prefix for prefix in PREFIXES if largest >= prefix[0]), PREFIXES[-1])


def panel(x: str, y: str) -> tuple[Figure, Axes]:
    """A figure with one pair of axes."""
    figure = Figure(figsize=(7.0, 4.2), layout="constrained", facecolor="white")
    return figure, figure.add_subplot(xlabel=x, ylabel=y)


def finish(axes: Axes, dataset: xr.Dataset) -> None:
    """Name the axes' curves, below them, and the run; have the zero in sight where little changes."""
    axes.set_xlim(0.0, float(dataset.time[-1]))
    low, high = axes.get_ylim()
    if high - low < LEAST_CHANGE * max(abs(low), abs(high)):
        axes.set_ylim(min(1.05 * low, 0.0), max(1.05 * high, 0.0))
    axes.set_title(dataset.attrs["title"], fontsize=10)
    axes.figure.legend(loc="outside lower center", ncols=len(axes.lines))
