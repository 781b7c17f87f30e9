"""The energies of a rod, as every method reports them in its own quadrature."""

from __future__ import annotations

from typing import NamedTuple


class Energies(NamedTuple):
    """In J: bending 1/2 int EJ_i (kappa_i - kappa0_i)^2, torsion with GJ3, stretching 1/2 int N^2 / EA, kinetic, of the
    added mass, potential."""

    bending: float
    torsion: float
    stretching: float
    kinetic: float
    added_mass: float
    potential: float
