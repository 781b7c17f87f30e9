"""How far a run has drifted from what the physics keeps, read from its dataset."""

from __future__ import annotations

from math import isfinite
from pathlib import Path

import xarray as xr

from service.jobs import Drift
from service.results import open_dataset

ENERGIES = ("bending", "torsion", "kinetic", "added_mass", "potential", "contact")
GIVEN = ("work_ends", "work_loads", "dissipation")


def drift_of(dataset: Path, method: str) -> Drift:
    """The drift of a published run that `method` has computed.

    topology = |Tw + Wr - Lk| (turn) of the last frame;
    energy = |energy_balance| of the last frame / energy that changed its form until then, which is the sum over
    the energies of (largest - smallest) and of |work| and dissipation: it does not depend on where heights count from.
    """
    with open_dataset(dataset) as run:
        if run.sizes["time"] == 0:
            return Drift(method)
        last = run.isel(time=-1)
        topology = abs(float(last["Tw"] + last["Wr"] - last["Lk"]))
        balance, changed = abs(float(last["energy_balance"])), _changed(run)
    return Drift(method, topology if isfinite(topology) else None,
                 balance / changed if changed > 0.0 and isfinite(balance / changed) else None)


def _changed(run: xr.Dataset) -> float:
    """Energy (J) that has changed its form or come from outside."""
    stored = (run[f"energy_{name}"] for name in ENERGIES)
    return sum(float(energy.max() - energy.min()) for energy in stored) + sum(
        abs(float(run[name][-1])) for name in GIVEN
    )
