"""What a simulation yields: the state of the rod at one output time, and its measures."""

from __future__ import annotations

from dataclasses import dataclass
from math import nan
from typing import NamedTuple

from solver.arrays import Array


class Fields(NamedTuple):
    """What is known along the rod at one time; see `Frame` for shapes, frames and units."""

    v: Array
    omega: Array
    f: Array
    kappa: Array
    q: Array
    r: Array
    orientation: Array


@dataclass(frozen=True)
class Frame:
    """The rod at time `t` (s), at arclengths s (n,), n = intervals + 1.

    Material frame (n, 3): `v` (m/s), `omega` (rad/s), `f` (N), `kappa` (rad/m), `q` (N m).
    Lab frame: `r` (n, 3) (m), `orientation` (n, 4), unit quaternion (w, x, y, z) that takes material
    components to lab ones. Energies, works and dissipation in J, the last three accumulated from t = 0;
    `energy_balance` = (sum of energies) - (its value at t = 0) - work_ends - work_loads + dissipation.
    `Tw`, `Wr`, `Lk` in turns (`Wr`, `Lk` NaN if not asked for). `min_gap` (m): smallest surface-to-surface
    distance of points more than the contact's skip of arc apart (NaN without contact, and while the total curvature
    proves that none are within its cutoff); `contacts`: number of point pairs that press on each other.
    `dt` (s) and `newton_iterations`: of the step that ended here.

    Of a static analysis: `parameter` (s), the time in the schedules, which goes back behind a fold while `t`, by how
    much it has changed, grows; `negative_modes`: in how many directions the energy falls, 0 if the equilibrium is
    stable. Its works, dissipation and balance are NaN.
    """

    t: float
    v: Array
    omega: Array
    f: Array
    kappa: Array
    q: Array
    r: Array
    orientation: Array
    energy_bending: float
    energy_torsion: float
    energy_kinetic: float
    energy_added_mass: float
    energy_potential: float
    energy_contact: float
    work_ends: float
    work_loads: float
    dissipation: float
    energy_balance: float
    Tw: float
    Wr: float
    Lk: float
    min_gap: float
    contacts: int
    dt: float
    newton_iterations: int
    parameter: float = nan
    negative_modes: int = -1


@dataclass
class Statistics:
    """What a run has cost so far; it grows while the run's frames are taken."""

    steps: int = 0
    newton_iterations: int = 0
    failed_steps: int = 0
    cpu_time: float = 0.0
