"""Loads that are given as functions of arclength and time: distributed ones, and point loads within the rod."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from solver.arrays import Array
from solver.physics.loads.load import Samples, Source
from solver.scene.curve import Curve, corners_of
from solver.scene.loads import DistributedLoad, PointLoad
from solver.scene.scene import Scene


class Record(NamedTuple):
    """At each time of a step (times, n, 3): `force` in N/m, `moment` in N m/m."""

    present: bool
    force: Any
    moment: Any


class GivenLoads(Source):
    """The given loads of a scene at any time, in a record of a `kind`.

    The forces along lab axes and the moments along material ones; or, if `following`, the forces along material axes
    and the moments along lab ones.
    """

    def __init__(self, scene: Scene, samples: Samples, kind: type[Record], following: bool) -> None:
        n, arrays = len(samples.s), (np.zeros((samples.times, len(samples.s), 3)) for _ in range(2))
        loads: list[DistributedLoad | PointLoad] = [*scene.distributed, *points_within(scene)]
        self._following = following
        acting = [load for load in loads if self._has_lever(load, samples)
                  or not all(getattr(c, "is_zero", False) for c in self._part(load))]  # fmt: skip
        super().__init__(kind(bool(acting), *arrays))
        self._distributed = [(self._target(load), self._spread(load, samples), load.schedule)
                             for load in acting if isinstance(load, DistributedLoad)]
        self._points = [(self._target(load)[..., k], self._concentrated(load, samples), curve)
                        for load in acting if isinstance(load, PointLoad)
                        for k, curve in enumerate(self._part(load)) if not curve.is_zero]  # fmt: skip
        for load in acting:
            if self._has_lever(load, samples):  # a3 x f: a moment along material axes
                (first, along_1), (second, along_2), _ = levers_of(load, samples)
                self._points += [(self.record.moment[..., 0], -second, along_2),
                                 (self.record.moment[..., 1], first, along_1)]  # fmt: skip
        self._density = np.zeros((n, 3))
        self.steady = all(is_steady(load) for load in acting)
        self.corners = tuple(corner for load in acting for curve in _schedules(load) for corner in curve.corners)
        for i in range(samples.times):
            self.set_time(0.0, i)

    def set_time(self, t: float, i: int) -> None:
        """Write the loads at time t."""
        self.record.force[i] = 0.0
        self.record.moment[i] = 0.0
        for target, density, schedule in self._distributed:
            target[i] += np.multiply(density, schedule.value(t), out=self._density)
        for target, density, curve in self._points:
            target[i] += np.multiply(density, curve.value(t), out=self._density[:, 0])

    def _acts_by_force(self, load: DistributedLoad | PointLoad) -> bool:
        """Whether it is the load's force, not its moment, that is of this kind."""
        return (load.frame == "material") == self._following

    def _has_lever(self, load: DistributedLoad | PointLoad, samples: Samples) -> bool:
        """Whether the moment that its force has about a segment's middle is of this kind; see also `levers`."""
        return samples.rigid and not self._following and load.frame == "material" and turns_segments(load)

    def _part(self, load: DistributedLoad | PointLoad) -> Any:
        return load.force if self._acts_by_force(load) else load.moment

    def _spread(self, load: DistributedLoad, samples: Samples) -> Array:
        mean = samples.mean if self._acts_by_force(load) else samples.placed_mean
        return np.stack([mean(profile) for profile in self._part(load)], axis=1)

    def _concentrated(self, load: PointLoad, samples: Samples) -> Array:
        return samples.weights(load.s) if self._acts_by_force(load) else samples.shares(load.s)

    def _target(self, load: DistributedLoad | PointLoad) -> Array:
        return self.record.force if self._acts_by_force(load) else self.record.moment  # type: ignore[no-any-return]


def nodes_act(s: Array) -> tuple[Array, Array]:
    """Where, and on what length, a density at each of the nodes `s` (n,) acts through the means over its intervals.

    The node itself, or the middle of the first or last interval for an end node.
    """
    centres, lengths = s.copy(), np.gradient(s)
    centres[0], centres[-1] = 0.5 * (s[0] + s[1]), 0.5 * (s[-2] + s[-1])
    lengths[0], lengths[-1] = 0.5 * (s[1] - s[0]), 0.5 * (s[-1] - s[-2])
    return centres, lengths


def points_within(scene: Scene) -> list[PointLoad]:
    """The point loads of a scene, but for those at its ends."""
    return [load for load in scene.points if load.s not in (0.0, scene.rod.length)]


def turns_segments(load: DistributedLoad | PointLoad) -> bool:
    """Whether its force acts beside the middles of segments: in a point, or by a density that is not even."""
    return load.pulls if isinstance(load, PointLoad) else len(corners_of(*load.force)) > 0


def levers_of(load: DistributedLoad | PointLoad, samples: Samples) -> list[tuple[Array, Curve]]:
    """Of each component of its force how far (n,) from their middles it acts on rigid segments, times its density, and
    how that goes in time."""
    if isinstance(load, PointLoad):
        return [(samples.levers(load.s), component) for component in load.force]
    return [(samples.arms(component), load.schedule) for component in load.force]


def is_steady(load: DistributedLoad | PointLoad) -> bool:
    """Whether a load is the same at all times."""
    return all(curve.is_constant for curve in _schedules(load))


def _schedules(load: DistributedLoad | PointLoad) -> Sequence[Curve]:
    return (load.schedule,) if isinstance(load, DistributedLoad) else (*load.force, *load.moment)
