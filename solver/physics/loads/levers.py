"""What forces within the rod do besides acting on a rigid segment: they turn it, for they act beside its middle.

A force F (lab) at a way l from the middle along the segment has the moment l T x F about it: a point force, or a part
of a density that is not even. Where a method knows no rigid segments there are none, see `Samples.weights`.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from solver.kernels.kernel import inner
from solver.kernels.vectors import lever, lever_by_rotation, times, vector
from solver.physics.loads.given import is_steady, levers_of, points_within, turns_segments
from solver.physics.loads.load import Point, Samples, Source, Tangents, as_given
from solver.scene.loads import DistributedLoad, PointLoad
from solver.scene.scene import Scene

account = as_given


class Record(NamedTuple):
    """`arm`: the sum of l F per length at each time of a step (times, n, 3), N m/m, lab."""

    present: bool
    arm: Any


class Levers(Source):
    """The levers of a scene's forces that keep their direction."""

    def __init__(self, scene: Scene, samples: Samples) -> None:
        given: list[DistributedLoad | PointLoad] = [*scene.distributed, *points_within(scene)]
        turning = [(load, levers_of(load, samples)) for load in given
                   if samples.rigid and load.frame == "lab" and turns_segments(load)]  # fmt: skip
        turning = [(load, of_load) for load, of_load in turning if any(levers.any() for levers, _ in of_load)]
        self._levers = [of_load for _, of_load in turning]
        super().__init__(Record(bool(turning), np.zeros((samples.times, len(samples.s), 3))))
        self._arm = np.zeros(len(samples.s))
        self.steady = all(is_steady(load) for load, _ in turning)
        for i in range(samples.times):
            self.set_time(0.0, i)

    def set_time(self, t: float, i: int) -> None:
        """Write the levers at time t."""
        self.record.arm[i] = 0.0
        for of_load in self._levers:
            for k, (levers, curve) in enumerate(of_load):
                self.record.arm[i, :, k] += np.multiply(levers, curve.value(t), out=self._arm)


of = Levers


def about(record: Record, axis: Any) -> Record:
    """In the plane of an axis."""
    return Record(record.present, record.arm @ axis.lab)


@inner
def force(load: Record, i: int, j: int, at: Point) -> Any:
    """The moment l T x F, and no force more."""
    arm = vector(load.arm[i], j)
    return times(0.0, arm), lever(arm, at.R)


@inner
def tangents(load: Record, i: int, j: int, at: Point) -> Tangents:
    """By rotation."""
    return Tangents(None, None, None, None, None, lever_by_rotation(vector(load.arm[i], j), at.R), None)
