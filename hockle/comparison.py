"""Figures of several datasets beside each other."""

from __future__ import annotations

import json
from collections.abc import Mapping

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from hockle.figures import LEAST_TURNS, NOISE, STYLE, prefixed
from hockle.stage import Stage
from hockle.tube import Tube
from hockle.view import View

MOST = 6
"""Datasets in one picture."""

CURVES = (("Tw", "twist", "turns"), ("Wr", "writhe", "turns"), ("energy_bending", "bending energy", "J"),
          ("energy_torsion", "torsional energy", "J"), ("energy_kinetic", "kinetic energy", "J"),
          ("max_curvature", "largest curvature", "rad/m"))
COLOURS = ("#1d4ed8", "#c2410c", "#15803d", "#7c3aed", "#0891b2", "#be185d")


def curves(datasets: Mapping[str, xr.Dataset]) -> Figure:
    """The numbers that say something of at least one of the datasets, over one time, a curve for each dataset."""
    energies = [name for name, _, unit in CURVES if unit == "J"]
    energy = max(float(np.abs(dataset[name]).max()) for dataset in datasets.values() for name in energies)
    least = {"turns": LEAST_TURNS, "J": NOISE * energy, "rad/m": 0.0}
    shown = [curve for curve in CURVES if any(
        float(np.abs(dataset[curve[0]]).max()) > least[curve[2]] for dataset in datasets.values())]  # fmt: skip
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(11.0, 0.6 + 2.6 * ((len(shown) + 1) // 2)), layout="constrained", facecolor="white")
        for place, (name, title, unit) in enumerate(shown):
            axes = figure.add_subplot((len(shown) + 1) // 2, 2, place + 1, xlabel="time (s)")
            largest = max(float(np.abs(dataset[name]).max()) for dataset in datasets.values())
            scale, prefix = prefixed(largest) if unit == "J" else (1.0, "")
            axes.set_ylabel(f"{title} ({prefix}{unit})")
            for k, (label, dataset) in enumerate(datasets.items()):
                dashes = (None, None) if k == 0 else (3 + k, 2)  # so that curves are seen that lie on each other
                axes.plot(dataset.time, dataset[name] / scale, color=COLOURS[k], label=label, dashes=dashes)
        names = figure.axes[0].get_legend_handles_labels()
        figure.legend(*names, loc="outside upper center", ncols=min(3, len(datasets)))
    return figure


def shapes(datasets: Mapping[str, xr.Dataset]) -> Figure:
    """The last frame of each dataset, to one scale."""
    cases = {label: json.loads(dataset.attrs["case"]) for label, dataset in datasets.items()}
    views = {label: View.of(cases[label], dataset.r.values) for label, dataset in datasets.items()}
    tubes = {label: Tube.of(dataset.r.values[-1], dataset.orientation.values[-1]).turned(views[label].axes)
             for label, dataset in datasets.items()}  # fmt: skip
    with mpl.rc_context(STYLE):
        points = np.vstack([tube.r for tube in tubes.values()])
        stage = Stage(list(cases.values()), list(views.values()), points)
        for i, (label, tube) in enumerate(tubes.items()):
            stage.draw(i, tube, f"{label}, t = {float(datasets[label].time[-1]):g} s")
    return stage.figure
