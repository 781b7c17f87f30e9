"""Morison's drag, with u the velocity relative to the current, T the tangent, u_n = u - (u . T) T:

    B = -1/2 rho_w D Cdn |u_n| u_n - 1/2 rho_w pi D Cdt |u . T| (u . T) T.
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
    """`normal` 1/2 rho_w D Cdn, `tangential` 1/2 rho_w pi D Cdt (n,) in kg/m^2; `current` (1, 3) in m/s, lab."""

    present: bool
    normal: Any
    tangential: Any
    current: Any


def of(scene: Scene, samples: Samples) -> Source:
    """The drag of a scene's fluid, whose current is the same everywhere and always: else see `sheared_drag`."""
    fluid = scene.fluid or NO_FLUID
    half, normal, tangential = 0.5 * fluid.density * samples.section.diameter, fluid.drag_normal, fluid.drag_tangential
    present = not fluid.varies and fluid.density * (normal + tangential) > 0.0
    return Source(Record(present, half * normal, pi * half * tangential, np.array([fluid.current], dtype=float)))


def about(record: Record, axis: Any) -> Record:
    """In the plane of an axis."""
    return record._replace(current=record.current @ axis.lab)


@inner
def force(load: Record, i: int, j: int, at: Point) -> Any:
    """B of the velocity and the tangent."""
    u = minus(at.V, vector(load.current, 0))
    along = dot(u, at.T)
    u_n = minus(u, times(along, at.T))
    return plus(times(-load.normal[j] * norm(u_n), u_n), times(-load.tangential[j] * abs(along) * along, at.T)), None


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
    C = add(add(identity(-n * speed, T), outer(times(-n, unit), u_n)), outer(times(n * speed - 2.0 * t, T), T))
    by_T = add(identity((n * speed - t) * along, T), outer(times(n * speed - 2.0 * t, T), u))
    return Tangents(None, C, None, add(by_T, outer(times(n * along, unit), u_n)), None, None, None)


@inner
def carrier(load: Record, i: int, j: int, at: Point) -> Any:
    """The current."""
    return vector(load.current, 0)
