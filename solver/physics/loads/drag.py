"""Drag of a fluid, with u the velocity relative to the current, T the tangent, u_n = u - (u . T) T:

    B = -(1/2 rho_w D Cdn |u_n| + zeta_n) u_n - (1/2 rho_w pi D Cdt |u . T| + zeta_t) (u . T) T,

Morison's, and that of a viscous fluid which creeps past (`Fluid.creeping_drag`), whose moment is in `damping`.
"""

from __future__ import annotations

from math import pi
from typing import Any, NamedTuple

import numpy as np

from solver.kernels.kernel import inner
from solver.kernels.vectors import add, dot, identity, minus, norm, outer, plus, times, vector
from solver.physics.loads.load import Point, Samples, Source, Tangents, as_lost
from solver.scene.fluid import NO_FLUID
from solver.scene.scene import Scene

account = as_lost


class Record(NamedTuple):
    """`normal` 1/2 rho_w D Cdn, `tangential` 1/2 rho_w pi D Cdt (n,) in kg/m^2; `current` (1, 3) in m/s, lab;
    `creeping` (n, 2), zeta_n and zeta_t in kg/(m s)."""

    present: bool
    normal: Any
    tangential: Any
    current: Any
    creeping: Any


def of(scene: Scene, samples: Samples) -> Source:
    """The drag of a scene's fluid, whose current is the same everywhere and always: else see `sheared_drag`."""
    fluid = scene.fluid or NO_FLUID
    half, normal, tangential = 0.5 * fluid.density * samples.section.diameter, fluid.drag_normal, fluid.drag_tangential
    present = not fluid.varies and fluid.density * (normal + tangential) + fluid.viscosity > 0.0
    creeping = fluid.creeping_drag(samples.section.diameter, float(scene.rod.length))
    current = np.array([fluid.current], dtype=float)
    return Source(Record(present, half * normal, pi * half * tangential, current, creeping))


def about(record: Record, axis: Any) -> Record:
    """In the plane of an axis."""
    return record._replace(current=record.current @ axis.lab)


@inner
def force(load: Record, i: int, j: int, at: Point) -> Any:
    """B of the velocity and the tangent."""
    u = minus(at.V, vector(load.current, 0))
    along = dot(u, at.T)
    u_n = minus(u, times(along, at.T))
    n = load.normal[j] * norm(u_n) + load.creeping[j, 0]
    t = load.tangential[j] * abs(along) + load.creeping[j, 1]
    return plus(times(-n, u_n), times(-t * along, at.T)), None


@inner
def tangents(load: Record, i: int, j: int, at: Point) -> Tangents:
    """By the velocity and by the tangent.

    d(|u_n| u_n) = (|u_n| + u_n u_n^t / |u_n|) du_n with du_n = du - T (T . du) - T (u . dT) - (u . T) dT; T . dT = 0.
    """
    u, T = minus(at.V, vector(load.current, 0)), at.T
    along = dot(u, T)
    u_n = minus(u, times(along, T))
    speed = norm(u_n)
    unit = times(1.0 / speed if speed > 0.0 else 0.0, u_n)
    n, t = load.normal[j], load.tangential[j] * abs(along)
    across, apart = n * speed + load.creeping[j, 0], load.creeping[j, 0] - load.creeping[j, 1]
    C = add(add(identity(-across, T), outer(times(-n, unit), u_n)), outer(times(n * speed - 2.0 * t + apart, T), T))
    by_T = add(identity((n * speed - t + apart) * along, T), outer(times(n * speed - 2.0 * t + apart, T), u))
    return Tangents(None, C, None, add(by_T, outer(times(n * along, unit), u_n)), None, None, None)


@inner
def carrier(load: Record, i: int, j: int, at: Point) -> Any:
    """The current."""
    return vector(load.current, 0)
