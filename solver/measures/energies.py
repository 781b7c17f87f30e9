"""The energies of a rod, as every method reports them in its own quadrature."""

from __future__ import annotations

from typing import NamedTuple


class Energies(NamedTuple):
    """In J: bending 1/2 int EJ_i (kappa_i - kappa0_i)^2, torsion with GJ3, kinetic, of the added mass, potential."""

    bending: float
    torsion: float
    kinetic: float
    added_mass: float
    potential: float
