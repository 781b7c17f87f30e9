"""How far a run has drifted from what the physics keeps."""

from __future__ import annotations

from collections.abc import Mapping
from math import isfinite
from typing import Any

import numpy as np
from numpy.typing import NDArray

from service.jobs import Drift

TOPOLOGY, BALANCE = ("Tw", "Wr", "Lk"), "energy_balance"
ENERGIES = tuple(f"energy_{name}" for name in ("bending", "torsion", "kinetic", "added_mass", "potential", "contact"))
EXCHANGED = ("work_ends", "work_loads", "dissipation")


def drift_of(series: Mapping[str, NDArray[Any]], method: str) -> Drift:
    """The drift of a run that `method` has computed, from its values in time by name.

    topology = |Tw + Wr - Lk| (turn) of the last frame;
    energy = |energy_balance| of the last frame / energy that changed its form until then, which is the sum over
    the energies of (largest - smallest) and of |work| and dissipation: it does not depend on where heights count from.
    """
    if len(series[BALANCE]) == 0:
        return Drift(method)
    twist, writhe, link = (float(series[name][-1]) for name in TOPOLOGY)
    topology = abs(twist + writhe - link)
    balance, changed = abs(float(series[BALANCE][-1])), _changed(series)
    return Drift(method, topology if isfinite(topology) else None,
                 balance / changed if changed > 0.0 and isfinite(balance / changed) else None)


def _changed(series: Mapping[str, NDArray[Any]]) -> float:
    """Energy (J) that has changed its form or come from outside."""
    stored = sum(float(np.nanmax(series[name]) - np.nanmin(series[name])) for name in ENERGIES)
    return stored + sum(abs(float(series[name][-1])) for name in EXCHANGED)
