"""Loads that are given as functions of arclength and time: distributed ones, and point loads within the rod."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from solver.arrays import Array
from solver.physics.loads.load import Samples, Source
from solver.scene.curve import Curve
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
        inside = tuple(load for load in scene.points if load.s not in (0.0, scene.rod.length))
        n, arrays = len(samples.s), (np.zeros((samples.times, len(samples.s), 3)) for _ in range(2))
        loads: list[DistributedLoad | PointLoad] = [*scene.distributed, *inside]
        self._following = following
        acting = [load for load in loads if any(not _is_zero(c) for c in self._part(load))]
        super().__init__(kind(bool(acting), *arrays))
        self._distributed = [(load, np.stack([p(samples.s) for p in self._part(load)], axis=1))
                             for load in acting if isinstance(load, DistributedLoad)]  # fmt: skip
        self._points = [(load, point_weights(load.s, samples.centres, samples.lengths))
                        for load in acting if isinstance(load, PointLoad)]  # fmt: skip
        self._density = np.zeros((n, 3))
        self.steady = all(_is_steady(load) for load in acting)
        self.corners = tuple(corner for load in acting for curve in _schedules(load) for corner in curve.corners)
        for i in range(samples.times):
            self.set_time(0.0, i)

    def set_time(self, t: float, i: int) -> None:
        """Write the loads at time t."""
        self.record.force[i] = 0.0
        self.record.moment[i] = 0.0
        for load, density in self._distributed:
            self._target(load)[i] += np.multiply(density, load.schedule.value(t), out=self._density)
        for point, weights in self._points:
            for k, component in enumerate(self._part(point)):
                np.multiply(weights, component.value(t), out=self._density[:, k])
            self._target(point)[i] += self._density

    def _acts_by_force(self, load: DistributedLoad | PointLoad) -> bool:
        """Whether it is the load's force, not its moment, that is of this kind."""
        return (load.frame == "material") == self._following

    def _part(self, load: DistributedLoad | PointLoad) -> Any:
        return load.force if self._acts_by_force(load) else load.moment

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


def point_weights(at: float, centres: Array, lengths: Array) -> Array:
    """Densities (n,) in 1/m that act like a unit point load at arclength `at`.

    Two neighbours are weighted so that force and moment are those of the point.
    """
    i = int(np.clip(np.searchsorted(centres, at) - 1, 0, len(centres) - 2))
    share = (at - centres[i]) / (centres[i + 1] - centres[i])
    weights = np.zeros_like(centres)
    weights[i], weights[i + 1] = (1.0 - share) / lengths[i], share / lengths[i + 1]
    return weights


def _is_steady(load: DistributedLoad | PointLoad) -> bool:
    if isinstance(load, DistributedLoad):
        return load.schedule.is_constant
    return all(c.is_constant for c in (*load.force, *load.moment))


def _schedules(load: DistributedLoad | PointLoad) -> Sequence[Curve]:
    return (load.schedule,) if isinstance(load, DistributedLoad) else (*load.force, *load.moment)


def _is_zero(component: object) -> bool:
    return isinstance(component, Curve) and component.is_zero
