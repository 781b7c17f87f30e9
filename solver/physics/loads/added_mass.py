"""Added mass: B = -Ca rho_w A a_n, a_n = a - (a . T) T the acceleration across the rod (Morison's law).

The fluid's energy is that of 1/2 Ca rho_w A |u_n|^2, u_n = u - (u . T) T, u the velocity relative to the current (to
still water, if that varies); what is left of the power is lost. (docs/decisions/0002)
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from solver.kernels.kernel import inner
from solver.kernels.vectors import add, dot, identity, minus, outer, tangent_rate, times, vector
from solver.physics.loads import drag
from solver.physics.loads.load import Point, Samples, Source, Tangents, as_lost
from solver.scene.fluid import NO_FLUID
from solver.scene.scene import Scene

account, about, carrier = as_lost, drag.about, drag.carrier  # which know the current alone


class Record(NamedTuple):
    """`mass` Ca rho_w A (n,) in kg/m; `current` (1, 3) in m/s, lab."""

    present: bool
    mass: Any
    current: Any


def of(scene: Scene, samples: Samples) -> Source:
    """The added mass of a scene's fluid."""
    fluid = scene.fluid or NO_FLUID
    ratio, current = fluid.density * fluid.added_mass, NO_FLUID.current if fluid.varies else fluid.current
    return Source(Record(ratio > 0.0, ratio * samples.section.area, np.array([current], dtype=float)))


@inner
def force(load: Record, i: int, j: int, at: Point) -> Any:
    """B = -Ca rho_w A (A - (A . T) T)."""
    return times(-load.mass[j], minus(at.A, times(dot(at.A, at.T), at.T))), None


@inner
def tangents(load: Record, i: int, j: int, at: Point) -> Tangents:
    """By the acceleration and by the tangent."""
    m, along = load.mass[j], dot(at.A, at.T)
    M = add(identity(-m, at.T), outer(times(m, at.T), at.T))
    by_T = add(outer(times(m, at.T), at.A), identity(m * along, at.T))
    return Tangents(None, None, M, by_T, None, None, None)


@inner
def entrained(load: Record, j: int, at: Point) -> Any:
    """Ca rho_w A, u_n, and its rate a_n - (u . T_t) T - (u . T) T_t."""
    u, turning = minus(at.V, vector(load.current, 0)), tangent_rate(at.R, at.omega)
    along, across = dot(u, at.T), minus(at.A, times(dot(at.A, at.T), at.T))
    rate = minus(minus(across, times(dot(u, turning), at.T)), times(along, turning))
    return load.mass[j], minus(u, times(along, at.T)), rate
