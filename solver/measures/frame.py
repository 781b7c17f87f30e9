"""What a simulation yields: the state of the rod at one output time, and its measures.

Each output is declared here and nowhere else: its name, and the `Output` that datasets, cases and documents go by.
For one that follows from the others, write its function in this file and add to `Frame` a line like

    tip: Annotated[Array, Output("m", "position of the end", "lab", of=_tip)] = FOLLOWS
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import nan
from typing import Annotated, get_type_hints

import numpy as np

from solver.arrays import Array
from solver.measures.output import FOLLOWS, Output
from solver.scene.scene import Scene


@dataclass(frozen=True, kw_only=True)
class Fields:
    """What a method knows along the rod at one time, at arclengths s (n,), n = intervals + 1.

    Vectors (n, 3); `orientation` (n, 4), unit quaternion (w, x, y, z) that takes material components to lab ones;
    `strain` (n,).
    """

    v: Annotated[Array, Output("m/s", "velocity of the centreline", "material", along_rod=True)]
    omega: Annotated[Array, Output("rad/s", "angular velocity of the section", "material", along_rod=True)]
    f: Annotated[Array, Output("N", "internal force", "material", along_rod=True)]
    kappa: Annotated[Array, Output("rad/m", "curvature and twist", "material", along_rod=True)]
    q: Annotated[Array, Output("N m", "internal moment", "material", along_rod=True)]
    r: Annotated[Array, Output("m", "position of the centreline", "lab", along_rod=True)]
    orientation: Annotated[Array, Output("1", "rotation from material to lab components", "quaternion", along_rod=True)]
    strain: Annotated[Array, Output("1", "axial strain, 0 of a rod that cannot stretch", along_rod=True)]


@dataclass(frozen=True, kw_only=True)
class Frame(Fields):
    """The rod at time `t` (s): its fields, and numbers.

    Works and dissipation are accumulated from t = 0;
    `energy_balance` = (sum of energies) - (its value at t = 0) - work_ends - work_loads + dissipation; where a step
    passes the frame, that at the step's end; and without what the mesh does not show of the energy of bending.
    `astray`: the size of the balance, the largest until then, less what damping or a viscous fluid has taken
    since.
    `Wr`, `Lk` are NaN if not asked for. `min_gap`: of points more than the contact's skip of arc apart (NaN without
    contact, and while the total curvature proves that none are within its cutoff).

    Of a static analysis: `parameter` goes back behind a fold while `t`, by how much it has changed, grows. Its works,
    dissipation and balance are NaN.
    """

    t: float
    energy_bending: Annotated[float, Output("J", "strain energy of bending")]
    energy_torsion: Annotated[float, Output("J", "strain energy of torsion")]
    energy_stretching: Annotated[float, Output("J", "strain energy of stretching")]
    energy_kinetic: Annotated[float, Output("J", "kinetic energy of the rod")]
    energy_added_mass: Annotated[float, Output("J", "kinetic energy of the added mass of fluid")]
    energy_potential: Annotated[float, Output("J", "potential energy of weight and buoyancy")]
    energy_contact: Annotated[float, Output("J", "potential energy of self-contact")]
    work_ends: Annotated[float, Output("J", "work of the ends since the start")]
    work_loads: Annotated[float, Output("J", "work of the loads since the start")]
    dissipation: Annotated[float, Output("J", "energy dissipated since the start")]
    energy_balance: Annotated[float, Output("J", "energy gained less work done plus energy dissipated, zero if exact")]
    astray: Annotated[float, Output("J", "energy that the balance lacks, unless damped since", verified=False)] = nan
    Tw: Annotated[float, Output("turn", "twist")]
    Wr: Annotated[float, Output("turn", "writhe of the centreline continued by straight rays")]
    Lk: Annotated[float, Output("turn", "linking number, the relative rotation of the ends")]
    min_gap: Annotated[
        float, Output("m", "smallest gap between surfaces, once the total curvature does not rule contact out")
    ]
    contacts: Annotated[int, Output("1", "number of point pairs that press on each other", verified=False)]
    dt: Annotated[float, Output("s", "length of the time step that ended here", verified=False)]
    newton_iterations: Annotated[int, Output("1", "Newton iterations of the time step that ended here", verified=False)]
    parameter: Annotated[float, Output("s", "time in the schedules, which may go back", statics=True)] = nan
    negative_modes: Annotated[
        int, Output("1", "directions in which the energy falls, 0 if stable", statics=True, verified=False)
    ] = -1
    neutral_modes: Annotated[
        int, Output("1", "directions in which the energy stays the same", statics=True, verified=False)
    ] = -1
    max_curvature: Annotated[
        float, Output("rad/m", "largest curvature of the centreline along the rod", of=_max_curvature)
    ] = FOLLOWS


def _max_curvature(frame: Frame, s: Array, scene: Scene) -> float:
    """The largest sqrt(kappa1^2 + kappa2^2), of which the inverse is the smallest bend radius."""
    return float(np.hypot(frame.kappa[:, 0], frame.kappa[:, 1]).max())


def _declared() -> tuple[Output, ...]:
    """The records of a frame's fields, with their names and types."""
    hints = get_type_hints(Frame, include_extras=True).items()
    return tuple(
        replace(output, name=name, type="i4" if hint.__origin__ is int else "f8")
        for name, hint in hints
        for output in getattr(hint, "__metadata__", ())
    )


OUTPUTS = _declared()
"""Every output, in the order of a frame's fields; the time is none."""


DERIVED = tuple((output.name, output.of) for output in OUTPUTS if output.of is not None)


def complete(frame: Frame, s: Array, scene: Scene) -> Frame:
    """The same frame, in which the outputs that follow from the others are set; `s` (n,): its nodes' arclengths, m."""
    for name, of in DERIVED:
        object.__setattr__(frame, name, of(frame, s, scene))  # a copy would take longer than most of them
    return frame


@dataclass
class Statistics:
    """What a run has cost so far; it grows while the run's frames are taken.

    All of it counts as if it had been alone; `taken_over`: how many of its steps were taken by another run that began
    alike.
    """

    steps: int = 0
    newton_iterations: int = 0
    failed_steps: int = 0
    cpu_time: float = 0.0
    taken_over: int = 0
