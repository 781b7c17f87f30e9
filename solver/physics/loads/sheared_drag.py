"""Morison's drag in a current that depends on height and time: U(r, t) = g(t) c(n . r) U0.

A point feels what `drag` does to one that moves with u = V - U(r, t) in still water. As dU/dr = g c' U0 n^t, the force
has the tangent K = -C dU/dr, with C that by the velocity.
"""

from __future__ import annotations

from dataclasses import replace
from math import inf
from typing import Any, NamedTuple

import numpy as np

from solver.arrays import Array
from solver.kernels.kernel import inner
from solver.kernels.vectors import dot, minus, outer, times, transform, vector
from solver.physics.loads import drag
from solver.physics.loads.load import Point, Samples, Source, Tangents, as_lost
from solver.scene.curve import Curve
from solver.scene.fluid import EVERYWHERE, NO_FLUID, UNIFORM
from solver.scene.scene import Scene

SMALLEST = 1e-300
account = as_lost


class Record(NamedTuple):
    """`still`: the drag of still water; `current` (1, 3), U0; `up` (1, 3), n; `heights` (m,) of the points of c, which
    is cubic in the `pieces` (m - 1, 4) between them and constant `beyond` (2,); `schedule` (times,), g."""

    present: bool
    still: drag.Record
    current: Any
    up: Any
    heights: Any
    pieces: Any
    beyond: Any
    schedule: Any


class ShearedDrag(Source):
    """That of a scene's fluid, unless its current is the same everywhere and always. A step leaps over no layer."""

    def __init__(self, record: Record, schedule: Curve, sheared: bool) -> None:
        super().__init__(record)
        self.bars = record.present and sheared
        self._schedule, self.corners, self.steady = schedule, schedule.corners, schedule.is_constant

    def set_time(self, t: float, i: int) -> None:
        """Write the factor at time t."""
        self.record.schedule[i] = self._schedule.value(t)

    def longest_step(self, r: Array, V: Array) -> float:
        """In which no node comes farther than to the middle of the layer that follows that where it is."""
        up, heights = self.record.up[0], self.record.heights
        middles = 0.5 * (heights[1:] + heights[:-1])
        height, rate = r @ up, V @ up
        above, below = np.append(middles, [inf, inf]), np.append([-inf, -inf], middles)
        rises, falls = heights.searchsorted(height, "right"), heights.searchsorted(height, "left")
        way = np.where(rate > 0.0, above[rises] - height, height - below[falls])
        return float(np.min(way / np.maximum(np.abs(rate), SMALLEST)))


def of(scene: Scene, samples: Samples) -> Source:
    """The drag of a scene's fluid in a current that varies."""
    fluid = scene.fluid or NO_FLUID
    at_rest = replace(fluid, current=NO_FLUID.current, shear=None, schedule=UNIFORM)
    still = drag.of(replace(scene, fluid=at_rest), samples).record
    shear, current = fluid.shear or EVERYWHERE, np.array([fluid.current], dtype=float)
    heights, pieces = shear.factor.polynomials
    present, now = fluid.varies and still.present, np.full(samples.times, fluid.schedule.value(0.0))
    record = Record(present, still, current, shear.up[None], heights, pieces, shear.factor(np.array([-inf, inf])), now)
    return ShearedDrag(record, fluid.schedule, fluid.shear is not None)


@inner
def current(load: Record, i: int, at: Point) -> Any:
    """U at a point, and dU / d(n . r)."""
    height, last = dot(vector(load.up, 0), at.r), len(load.heights) - 1
    factor, slope = load.beyond[0], 0.0
    if height >= load.heights[last]:
        factor = load.beyond[1]
    elif height > load.heights[0]:
        k = np.searchsorted(load.heights, height) - 1
        x, piece = height - load.heights[k], load.pieces[k]
        factor = ((piece[0] * x + piece[1]) * x + piece[2]) * x + piece[3]
        slope = (3.0 * piece[0] * x + 2.0 * piece[1]) * x + piece[2]
    U, g = vector(load.current, 0), load.schedule[i]
    return times(g * factor, U), times(g * slope, U)


@inner
def relative(at: Point, U: Any) -> Point:
    """A point as it moves in water that moves with U."""
    return Point(at.r, minus(at.V, U), at.A, at.T, at.R, at.omega)


@inner
def force(load: Record, i: int, j: int, at: Point) -> Any:
    """B of the place, the velocity and the tangent."""
    return drag.force(load.still, i, j, relative(at, current(load, i, at)[0]))


@inner
def tangents(load: Record, i: int, j: int, at: Point) -> Tangents:
    """By the place, the velocity and the tangent."""
    U, by_height = current(load, i, at)
    by = drag.tangents(load.still, i, j, relative(at, U))
    K = outer(times(-1.0, transform(by.C, by_height)), vector(load.up, 0))
    return Tangents(K, by.C, None, by.by_T, None, None, None)


@inner
def carrier(load: Record, i: int, j: int, at: Point) -> Any:
    """The current there."""
    return current(load, i, at)[0]
