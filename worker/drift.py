"""How far a run has drifted from what the physics keeps, read from its dataset."""

from __future__ import annotations

from collections.abc import Mapping
from math import isfinite
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from service.jobs import Drift
from service.results.query import opened

TOPOLOGY, BALANCE = ("Tw", "Wr", "Lk"), "energy_balance"
ENERGIES = tuple(f"energy_{name}" for name in ("bending", "torsion", "kinetic", "added_mass", "potential", "contact"))
EXCHANGED = ("work_ends", "work_loads", "dissipation")


def drift_of(dataset: Path, method: str) -> Drift:
    """The drift of a published run that `method` has computed.

    topology = |Tw + Wr - Lk| (turn) of the last frame;
    energy = |energy_balance| of the last frame / energy that changed its form until then, which is the sum over
    the energies of (largest - smallest) and of |work| and dissipation: it does not depend on where heights count from.
    """
    with opened(dataset) as source:
        if len(source.time) == 0:
            return Drift(method)
        run = {name: source.read(source.variables[name], {}) for name in (*TOPOLOGY, BALANCE, *ENERGIES, *EXCHANGED)}
    twist, writhe, link = (float(run[name][-1]) for name in TOPOLOGY)
    topology = abs(twist + writhe - link)
    balance, changed = abs(float(run[BALANCE][-1])), _changed(run)
    return Drift(method, topology if isfinite(topology) else None,
                 balance / changed if changed > 0.0 and isfinite(balance / changed) else None)


def _changed(run: Mapping[str, NDArray[np.float64]]) -> float:
    """Energy (J) that has changed its form or come from outside."""
    stored = sum(float(np.nanmax(run[name]) - np.nanmin(run[name])) for name in ENERGIES)
    return stored + sum(abs(float(run[name][-1])) for name in EXCHANGED)
