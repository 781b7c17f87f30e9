"""The loads of a scene as a method has them: their records at the times of a step, and those at the ends."""

from __future__ import annotations

from collections.abc import Sequence
from math import inf
from typing import Any

import numpy as np

from solver.arrays import Array
from solver.physics.ends import DrivenEnd
from solver.physics.loads.given import nodes_act
from solver.physics.loads.load import Samples
from solver.physics.loads.registry import Loads, about_axis, entrained_mass, records_about, sources_of
from solver.physics.section import Section
from solver.scene.scene import Scene


class AppliedLoads:
    """The loads of a scene at arclengths `s` (n,), at as many `times` within a step as a method asks for.

    They are nodes of the box scheme, or the middles of rigid `segments` of these lengths (n,).
    `records`: what kernels read, in space, or in the plane of an `axis`.
    """

    def __init__(self, scene: Scene, section: Section, s: Array, segments: Array | None = None,
                 times: int = 1, axis: Any = None) -> None:  # fmt: skip
        acting = nodes_act(s) if segments is None else (s, segments)
        samples = Samples(s, section, *acting, times, rigid=segments is not None)
        self._sources, self._axis = sources_of(scene, samples), axis
        self.records = (Loads(*(source.record for source in self._sources)) if axis is None
                        else records_about(axis, self._sources))  # fmt: skip
        self._at_ends = tuple(load for load in scene.points if load.s in (0.0, scene.rod.length))
        self._weights = np.outer([scene.start.mass, scene.end.mass], scene.gravity)
        self.at_ends = bool(self._at_ends) or bool(self._weights.any())
        """Whether there are point loads, or bodies with a weight, at an end."""
        self._moving = tuple(source for source in self._sources if not source.steady)
        in_plane = [] if axis is None else about_axis(self._sources, self.records)
        self._projected = [(load.about, source, mine) for load, source, mine in in_plane if not source.steady]
        self._barring = tuple(source for source in self._sources if source.bars)
        self._striking = tuple(source for source in self._sources if source.strikes and source.record.present)
        self.entrained = np.zeros(len(s)) + entrained_mass(self._sources)
        """Mass per length (n,) that the rod takes along across its tangent, kg/m."""

    def next_blow(self, motion: Array, mass: Array, tolerance: float) -> float:
        """In what time (s) the next step is to end: see `Source.next_blow`."""
        return min((source.next_blow(motion, mass, tolerance) for source in self._striking), default=inf)

    @property
    def strikes(self) -> bool:
        """Whether loads may set in all of a sudden: see `missed`."""
        return bool(self._striking)

    def corners(self) -> list[float]:
        """Times to which steps must be aligned."""
        at_ends = (corner for load in self._at_ends for c in (*load.force, *load.moment) for corner in c.corners)
        return [*(corner for source in self._sources for corner in source.corners), *at_ends]

    def at_end(self, t: float, s: float, frame: str) -> Array:
        """Point loads (6,) at an end in a frame, the weight of its body among them, as what they add to the internal f
        and q there."""
        total = np.zeros(6)
        if frame == "lab":
            total[:3] = self._weights[int(s > 0.0)]
        for load in self._at_ends:
            if load.s == s and load.frame == frame:
                total += [c.value(t) for c in (*load.force, *load.moment)]
        return total if s > 0.0 else -total

    def driving(self, end: DrivenEnd, s: float, t: float, later: Sequence[float], gain: float) -> tuple[Array, Array]:
        """What drives the end at s at the times t + dt, `later` being these dt: values (times, 6) of its conditions,
        loads added, and dead lab loads (times, 6)."""
        values, dead = end.values(t, later, gain), np.zeros((len(later), 6))
        if self.at_ends:
            for k, dt in enumerate(later):
                following, dead[k] = (self.at_end(t + dt, s, frame) for frame in ("material", "lab"))
                values[k] += np.where(end.kinds % 2 == 1, following, 0.0)
        return values, dead

    def set_time(self, t: float, later: Sequence[float] = (0.0,)) -> None:
        """Let the records say what acts at the times t + dt of a step, `later` being these dt."""
        for source in self._moving:
            for i, dt in enumerate(later):
                source.set_time(t + dt, i)
        for about, source, mine in self._projected:
            _write(mine, about(source.record, self._axis))

    def longest_step(self, r: Array, V: Array) -> float:
        """The longest step (s) from places r (n, 3) with velocities V (n, 3), lab, that passes over no load."""
        return min((source.longest_step(r, V) for source in self._barring), default=inf)

    def missed(self, r: Array, mass: Array, dt: float) -> float:
        """By how much (m) a step of dt may be off where loads set in, or cease, within it: see `Source.missed`."""
        return max((source.missed(r, mass, dt) for source in self._striking), default=0.0)

    def compile(self) -> None:
        """Have every kernel compiled that a load alone needs."""
        for source in self._sources:
            source.compile()

    def check(self) -> None:
        """Raise what a load could not say to the kernel that asked it."""
        for source in self._moving:
            source.check()


def _write(record: Any, new: Any) -> None:
    """Write the arrays of one record into another's, which kernels have a reference to."""
    for mine, other in zip(record, new, strict=True):
        if isinstance(mine, np.ndarray):
            mine[:] = other
