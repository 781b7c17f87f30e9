"""Loads that are given: weight and buoyancy, distributed and point loads, as densities at the nodes."""

from __future__ import annotations

from math import pi
from typing import NamedTuple

import numpy as np

from solver.arrays import Array
from solver.physics.ends import DrivenEnd
from solver.physics.section import Section
from solver.scene.curve import Curve
from solver.scene.loads import DistributedLoad, PointLoad
from solver.scene.scene import Scene

NO_LOAD = np.zeros(6)


class Loads(NamedTuple):
    """Loads per length at n arclengths, at one time.

    `lab` and `material` (n, 6): force and moment; `follows`: whether `material` is not zero; `turns`: whether
    `lab` has moments;
    `damping` c (1/s); `added_mass`, `drag_normal`, `drag_tangential` (n,): Ca rho_w A, 0.5 rho_w D Cdn,
    0.5 rho_w pi D Cdt; `current` (3,); `wet`: whether there is a fluid.
    """

    lab: Array
    material: Array
    follows: bool
    turns: bool
    damping: float
    added_mass: Array
    drag_normal: Array
    drag_tangential: Array
    current: Array
    wet: bool


class AppliedLoads:
    """The loads of a scene at any time, as densities at arclengths `s` (n,).

    The density at s[i] acts on a length `lengths[i]` about `centres[i]`; by default that of a node of the box scheme.
    """

    def __init__(self, scene: Scene, section: Section, s: Array, acting: tuple[Array, Array] | None = None) -> None:
        n, fluid = len(s), scene.fluid
        centres, lengths = acting or nodes_act(s)
        self.weight = effective_weight(scene, section)
        """(rho_c - rho_w) A g (n, 3), N/m, lab."""
        self._distributed = [(load, _profiles(load, s)) for load in scene.distributed]
        at_ends = tuple(load for load in scene.points if load.s in (0.0, scene.rod.length))
        inside = tuple(load for load in scene.points if load not in at_ends)
        self._points = [(load, point_weights(load.s, centres, lengths)) for load in inside]
        self._at_ends = at_ends
        self._given = scene.distributed + inside
        self._density = np.zeros((n, 6))
        area = 0.25 * pi * section.diameter**2
        density = fluid.density if fluid else 0.0
        self._loads = Loads(
            lab=np.zeros((n, 6)),
            material=np.zeros((n, 6)),
            follows=any(load.frame == "material" for load in self._given),
            turns=any(load.frame == "lab" and not _is_moment_free(load) for load in self._given),
            damping=float(scene.damping),
            added_mass=density * area * (fluid.added_mass if fluid else 0.0),
            drag_normal=0.5 * density * section.diameter * (fluid.drag_normal if fluid else 0.0),
            drag_tangential=0.5 * density * pi * section.diameter * (fluid.drag_tangential if fluid else 0.0),
            current=np.array(fluid.current if fluid else (0.0, 0.0, 0.0), dtype=float),
            wet=fluid is not None,
        )
        self.steady = all(_is_steady(load) for load in self._given)
        """Whether the loads are the same at all times."""
        self._fill(0.0)

    def corners(self) -> list[float]:
        """Times to which steps must be aligned."""
        curves = [load.schedule for load, _ in self._distributed]
        for point in (*self._at_ends, *(point for point, _ in self._points)):
            curves += [*point.force, *point.moment]
        return [corner for curve in curves for corner in curve.corners]

    def at_end(self, t: float, s: float, frame: str) -> Array:
        """Point loads (6,) at an end in a frame, as what they add to the internal f and q there."""
        total = np.zeros(6)
        for load in self._at_ends:
            if load.s == s and load.frame == frame:
                total += [c.value(t) for c in (*load.force, *load.moment)]
        return total if s > 0.0 else -total

    def driving(self, end: DrivenEnd, s: float, t: float, dt: float, gain: float) -> tuple[Array, Array]:
        """What drives the end at s at t + dt: values (6,) of its conditions, loads added, and dead lab loads (6,)."""
        values, dead = end.values(t, dt, gain), NO_LOAD
        if self._at_ends:
            following, dead = (self.at_end(t + dt, s, frame) for frame in ("material", "lab"))
            values += np.where(end.kinds % 2 == 1, following, 0.0)
        return values, dead

    def at(self, t: float) -> Loads:
        """The loads at time t; the arrays are the same ones at every call."""
        if not self.steady:
            self._fill(t)
        return self._loads

    def _fill(self, t: float) -> None:
        self._loads.lab[:] = 0.0
        self._loads.material[:] = 0.0
        self._loads.lab[:, :3] = self.weight
        for load, density in self._distributed:
            self._add(load, np.multiply(density, load.schedule.value(t), out=self._density))
        for point, weights in self._points:
            for k, component in enumerate((*point.force, *point.moment)):
                np.multiply(weights, component.value(t), out=self._density[:, k])
            self._add(point, self._density)

    def _add(self, load: DistributedLoad | PointLoad, density: Array) -> None:
        target = self._loads.material if load.frame == "material" else self._loads.lab
        target += density


def effective_weight(scene: Scene, section: Section) -> Array:
    """Weight less buoyancy per length, (rho_c A - rho_w A) g, at the nodes (n, 3)."""
    mass = section.mass.copy()
    if scene.fluid:
        mass -= scene.fluid.density * 0.25 * pi * section.diameter**2
    return np.outer(mass, np.array(scene.gravity, dtype=float))


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


def _profiles(load: DistributedLoad, s: Array) -> Array:
    return np.stack([p(s) for p in (*load.force, *load.moment)], axis=1)


def _is_steady(load: DistributedLoad | PointLoad) -> bool:
    if isinstance(load, DistributedLoad):
        return load.schedule.is_constant
    return all(c.is_constant for c in (*load.force, *load.moment))


def _is_moment_free(load: DistributedLoad | PointLoad) -> bool:
    return all(isinstance(c, Curve) and c.is_zero for c in load.moment)
