"""Viscous damping: B = -c rho_c A v, Q = -c I omega - pi mu D^2 omega_3 a3.

The last is what a fluid of viscosity mu does to a round rod that spins in it (a long cylinder's, 4 pi mu a^2 with its
radius a; Landau & Lifshitz, Fluid Mechanics, 18); what it does against its velocity is in `drag`.
"""

from __future__ import annotations

from math import pi
from typing import Any, NamedTuple

import numpy as np

from solver.kernels.kernel import inner
from solver.kernels.vectors import diagonal, identity, times, times_each, vector
from solver.physics.loads.load import VISCOUS, Point, Samples, Source, Tangents
from solver.scene.fluid import NO_FLUID
from solver.scene.scene import Scene


class Record(NamedTuple):
    """`by_velocity` -c rho_c A (n,) in kg/(m s), `by_omega` -c I - pi mu D^2 e3 (n, 3) in kg m/s."""

    present: bool
    by_velocity: Any
    by_omega: Any


def of(scene: Scene, samples: Samples) -> Source:
    """The damping of a scene, and of its fluid against spin."""
    c, section = float(scene.damping), samples.section
    viscosity = (scene.fluid or NO_FLUID).viscosity
    by_omega = -c * section.inertia
    by_omega[:, 2] -= pi * viscosity * section.diameter**2
    return Source(Record(c > 0.0 or viscosity > 0.0, -c * section.mass, by_omega))


def about(record: Record, axis: Any) -> Record:
    """In the plane of an axis."""
    return record._replace(by_omega=np.ascontiguousarray(record.by_omega[:, axis.index]))


@inner
def force(load: Record, i: int, j: int, at: Point) -> Any:
    """B = -c rho_c A V, Q = -c I omega - pi mu D^2 omega_3 a3."""
    return times(load.by_velocity[j], at.V), times_each(vector(load.by_omega, j), at.omega)


@inner
def tangents(load: Record, i: int, j: int, at: Point) -> Tangents:
    """By the velocities."""
    C, moment_omega = identity(load.by_velocity[j], at.V), diagonal(vector(load.by_omega, j))
    return Tangents(None, C, None, None, None, None, moment_omega)


@inner
def account(load: Record) -> int:
    """Viscous."""
    return VISCOUS
