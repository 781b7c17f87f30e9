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

from hockle.tube import Tube, draw_tubes

PAPERS_TIMES = (20.0, 25.0, 29.0, 32.0)
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
BENDING, TORSION, KINETIC, OTHER = "#c2410c", "#1d4ed8", "#15803d", ("#7c3aed", "#0891b2")
ENERGIES = (
    ("energy_torsion", "torsional", TORSION),
    ("energy_bending", "bending", BENDING),
    ("energy_kinetic", "kinetic", KINETIC),
    ("energy_contact", "contact", OTHER[0]),
    ("energy_potential", "potential", OTHER[1]),
)
PREFIXES = ((1.0, "J"), (1e-3, "mJ"), (1e-6, "µJ"), (1e-9, "nJ"))


def snapshots(dataset: xr.Dataset) -> Figure:
    """The rod at four times (figure 6): thickened tubes with a stripe along a1 that shows the twist."""
    times = snapshot_times(dataset)
    frames = [dataset.sel(time=t, method="nearest") for t in times]
    tubes = [Tube.of(frame.r.values, frame.orientation.values) for frame in frames]
    weighs = any(json.loads(dataset.attrs["case"]).get("loads", {}).get("gravity", (0, 0, 0)))
    with mpl.rc_context(STYLE):
        figure = draw_tubes(tubes, [f"t = {float(frame.time):g} s" for frame in frames], upright=weighs)
        figure.suptitle(dataset.attrs["title"], fontsize=12)
    return figure


def energies(dataset: xr.Dataset) -> Figure:
    """Strain energies and kinetic energy in time (figure 7), and what else there is of energy."""
    t = dataset.time.values
    shown = [(dataset[name].values, label, colour) for name, label, colour in ENERGIES]
    largest = max(float(np.abs(values).max()) for values, _, _ in shown)
    scale, unit = next((one for one in PREFIXES if largest >= one[0]), PREFIXES[-1])
    with mpl.rc_context(STYLE):
        figure, axes = _axes("time (s)", f"energy ({unit})")
        for values, label, colour in shown:
            if np.abs(values).max() > 1e-4 * largest:
                axes.plot(t, values / scale, color=colour, label=label)
        _finish(axes, dataset)
    return figure


def topology(dataset: xr.Dataset) -> Figure:
    """Twist, writhe and linking number in time (figure 8)."""
    t = dataset.time.values
    with mpl.rc_context(STYLE):
        figure, axes = _axes("time (s)", "turns")
        axes.plot(t, dataset.Lk, color="#374151", label="Lk = Tw + Wr")
        axes.plot(t, dataset.Tw, color=TORSION, label="Tw")
        axes.plot(t, dataset.Wr, color=BENDING, label="Wr")
        _finish(axes, dataset)
    return figure


def snapshot_times(dataset: xr.Dataset) -> Sequence[float]:
    """The paper's times for the paper's cable, otherwise four that divide the run evenly."""
    end = float(dataset.time[-1])
    if dataset.attrs["case_name"] == "goyal-2003" and end >= PAPERS_TIMES[-1]:
        return PAPERS_TIMES
    return [float(t) for t in np.linspace(0.0, end, 4)]


def _axes(x: str, y: str) -> tuple[Figure, Axes]:
    figure = Figure(figsize=(7.0, 4.2), layout="constrained", facecolor="white")
    axes = figure.add_subplot(xlabel=x, ylabel=y)
    return figure, axes


def _finish(axes: Axes, dataset: xr.Dataset) -> None:
    axes.set_xlim(0.0, float(dataset.time[-1]))
    axes.set_title(dataset.attrs["title"], fontsize=10)
    axes.legend()
