"""What a load is to a method: forces and moments per length at points of the rod, with their tangents.

A load is a module of this folder, entered in `registry.LOADS`, with

    Given       what a scene's `loads` hold, if it is no other part of a scene that gives the load; its `scale`, if it
                has one, gives the length (m) of an interval that may be too long to feel it, by the rod's tangents;
    Record      a NamedTuple of `present` and arrays, a line for each point: what its kernels read;
    of          makes the `Source` of a scene: its record, and how that changes with time;
    force       kernel: force (lab) and moment (material) per length at point j at the i-th time within a step;
    account     kernel: the `Account` of what becomes of its power, unless that is stored (`as_given`, `as_lost`);

and, if it has one, `tangents`, `energy`, `conservative`, `carrier`, `entrained` (see below), and `about`, which gives
its record in the plane of an axis: without it a scene with this load turns in space. The kernels are written with
`kernels.vectors`, so that one text holds in space and in a plane. Each method says in one place what a point is to it,
and what it makes of tangents.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum
from math import inf
from typing import Any, NamedTuple

import numpy as np
from numba import types

from solver.arrays import Array
from solver.kernels.dispatch import dispatched, for_each, has_variant
from solver.kernels.kernel import by_type, inner
from solver.kernels.vectors import dot, middle
from solver.physics.cells import Cells
from solver.physics.section import Section
from solver.scene.curve import corners_of
from solver.scene.rod import Profile

ON_NODE = 1e-9
"""Part of a segment by which a point may be beside a node and is still taken to be there."""


class Account(IntEnum):
    """What becomes of the power of a load."""

    STORED = 0
    """It has an `energy`, which is potential energy."""
    GIVEN = 1
    """All of it is work of the loads."""
    LOST = 2
    """What it does against the motion relative to its `carrier` is dissipated, but for its `conservative` part; what is
    done by the carrier is work of the loads."""
    VISCOUS = 3
    """All of it is dissipated, and proportional to the velocity: counted by what the rod has moved in a step."""


STORED, GIVEN, LOST, VISCOUS = (int(account) for account in Account)


class Point(NamedTuple):
    """A point of the rod: place `r`, velocity `V`, acceleration `A` and tangent `T` (lab), rotation `R`, angular
    velocity `omega` (material); see `kernels.vectors`."""

    r: Any
    V: Any
    A: Any
    T: Any
    R: Any
    omega: Any


class Tangents(NamedTuple):
    """Derivatives of a load's force by place (K), velocity (C), acceleration (M), by the tangent T, and by a rotation
    d psi that T does not tell (E); of its moment by rotation and by the angular velocity. None for those that vanish.
    """

    K: Any
    C: Any
    M: Any
    by_T: Any
    E: Any
    moment_E: Any
    moment_omega: Any


class Source:
    """A load of a scene, sampled where a method wants it: its `record`, and how this changes with time."""

    bars = False
    """Whether a step that is too long may pass over where the load acts: then `longest_step` says so."""
    strikes = False
    """Whether it sets in all of a sudden where the rod comes to it: see `missed` and `next_blow`."""
    corners: tuple[float, ...] = ()
    """Times to which steps must be aligned."""

    def __init__(self, record: Any) -> None:
        self.record = record
        self.steady = type(self).set_time is Source.set_time
        """Whether the record is the same at all times."""

    def set_time(self, t: float, i: int) -> None:
        """Write what acts at time t, the i-th time of a step, into the record."""

    def longest_step(self, r: Array, V: Array) -> float:
        """The longest step (s) from places r (n, 3) with velocities V (n, 3), lab."""
        return inf

    def missed(self, r: Array, mass: Array, dt: float) -> float:
        """By how much (m) a step of dt may be off where the load begins, or ceases, to act on points that bear `mass`
        (n,) per length; `r` (times, n, 3): where they are at its start and at its stages."""
        return 0.0

    def next_blow(self, motion: Array, mass: Array, tolerance: float) -> float:
        """In what time (s) a step is to end, so that the load sets in, or ceases, between two; `motion` (3, n, 3):
        places, velocities and accelerations of points that bear `mass` (n,) per length; `tolerance` of a step's error
        relative to its motion."""
        return inf

    def check(self) -> None:
        """Raise what the load could not say to the kernel that asked it."""

    def compile(self) -> None:
        """Have every kernel compiled that only this load needs, be it there or not."""


@dataclass(frozen=True)
class Samples:
    """Where a method wants loads: at arclengths `s` (n,), each density acting on `lengths` about `centres` (n,), at so
    many `times` within a step; the `section` there. `rigid`: these are segments, on which a force may act anywhere."""

    s: Array
    section: Section
    centres: Array
    lengths: Array
    times: int
    rigid: bool = False

    def mean(self, profile: Profile) -> Array:
        """What a density along the rod counts for (n,) in the segments, or around the nodes."""
        return self._cells(profile).mean_of(profile)

    def placed_mean(self, profile: Profile) -> Array:
        """The same of moments, which act on rigid segments: see `Cells.placed_mean_of`."""
        if not self.rigid:
            return self.mean(profile)
        return self._cells(profile).placed_mean_of(profile, self.lengths, float(self.lengths[0]))

    def arms(self, profile: Profile) -> Array:
        """How far (n,) from their middles a density acts on rigid segments, times its mean."""
        return self._cells(profile).arms_of(profile)

    def _cells(self, profile: Profile) -> Cells:
        half = 0.5 * self.lengths
        edges = np.append(self.centres - half, self.centres[-1] + half[-1])
        return Cells.at(self.s, edges, corners_of(profile))

    def weights(self, at: float) -> Array:
        """Densities (n,) in 1/m that act like a unit point force at arclength `at`, together with its `levers`: on the
        segments that are there, else as `shares`."""
        if not self.rigid:
            return self.shares(at)
        weights, segments = np.zeros_like(self.centres), self._segments(at)
        weights[segments] = 1.0 / (len(segments) * self.lengths[segments])
        return weights

    def shares(self, at: float) -> Array:
        """Densities (n,) in 1/m of a unit at arclength `at`, shared by two neighbours so that its place counts."""
        shares = np.zeros_like(self.centres)
        i = int(np.clip(np.searchsorted(self.centres, at) - 1, 0, len(self.centres) - 2))
        share = (at - self.centres[i]) / (self.centres[i + 1] - self.centres[i])
        shares[i], shares[i + 1] = (1.0 - share) / self.lengths[i], share / self.lengths[i + 1]
        return shares

    def levers(self, at: float) -> Array:
        """How far (n,) from their middles a unit point force at arclength `at` acts on rigid segments, per length."""
        levers: Array = self.weights(at) * (at - self.centres) if self.rigid else np.zeros_like(self.centres)
        return levers

    def _segments(self, at: float) -> Any:
        """The segment that has the point, or the two that meet there."""
        beside = np.abs(at - self.centres) / self.lengths
        return np.flatnonzero(beside <= max(0.5 * (1.0 + ON_NODE), float(beside.min())))


@dispatched
def force(load: Any, i: int, j: int, at: Point) -> Any:
    """Force and moment per length at point j; None for a moment that the load never has."""


@dispatched
def tangents(load: Any, i: int, j: int, at: Point) -> Any:
    """Their `Tangents`."""


@dispatched
def prepare(load: Any, i: int, motion: Any, linearise: bool) -> Any:
    """What a load does once for all points, before it is asked for each."""


@dispatched
def energy(load: Any, i: int, j: int, at: Point) -> float:
    """Potential energy per length at point j."""
    return 0.0


@dispatched
def carrier(load: Any, i: int, j: int, at: Point) -> Any:
    """The velocity of what the load's source moves with at point j, None if it rests."""


@dispatched
def entrained(load: Any, j: int, at: Point) -> Any:
    """The mass per length that the rod takes along at point j, its velocity, and the rate of that; None if there is
    none. Its kinetic energy is that of the added mass."""


@dispatched
def conservative(load: Any, i: int, j: int, at: Point) -> Any:
    """The part of the force whose power is the fall of the load's `energy`; None if it has none beside another part."""


@dispatched
def account(load: Any) -> int:
    """The load's `Account`."""
    return STORED


@inner
def as_given(load: Any) -> int:
    """The `account` of a load whose power is all work of the loads."""
    return GIVEN


@inner
def as_lost(load: Any) -> int:
    """The `account` of a load that takes energy for good, but for what its carrier gives."""
    return LOST


@dispatched
def point(motion: Any, j: int) -> Any:
    """Of a method's motion: its point j."""


@dispatched
def take_force(balance: Any, j: int, at: Any, force: Any, moment: Any) -> None:
    """Of a method's balance: subtract force and moment per length at point j."""


@dispatched
def take_tangents(balance: Any, j: int, at: Any, tangents: Any) -> None:
    """Of a method's balance: subtract their tangents, as derivatives by its own unknowns."""


@inner
def _add_force(load: Any, i: int, motion: Any, balance: Any) -> None:
    prepare(load, i, motion, False)
    for j in range(len(motion.r)):
        at = point(motion, j)
        lab, moment = force(load, i, j, at)
        take_force(balance, j, at, lab, moment)


@inner
def _add_tangents(load: Any, i: int, motion: Any, balance: Any) -> None:
    prepare(load, i, motion, True)
    for j in range(len(motion.r)):
        at = point(motion, j)
        take_tangents(balance, j, at, tangents(load, i, j, at))


def add_forces(loads: Any, i: int, motion: Any, balance: Any) -> None:
    """Let every load that is present act on a method's balance, at the i-th time of a step."""


def add_tangents(loads: Any, i: int, motion: Any, balance: Any) -> None:
    """Let every load that is present add its tangents to those of a method's balance."""


@inner
def _add_powers(load: Any, i: int, motion: Any, out: Array) -> None:
    """Add the sums over all points of the power given by a load, and lost to it (W/m), to `out` (2,)."""
    what, given, lost = account(load), 0.0, 0.0
    if what == STORED:
        return
    prepare(load, i, motion, False)
    for j in range(len(motion.r)):
        at = point(motion, j)
        lab, moment = force(load, i, j, at)
        power = total_power(lab, moment, at.V, at.omega)
        if what == GIVEN:
            given += power
        else:
            through = carried_power(lab, carrier(load, i, j, at))
            given += through
            stored = entrained_power(entrained(load, j, at)) - carried_power(conservative(load, i, j, at), at.V)
            lost += through - power - stored
    out[0] += given
    out[1] += lost


def add_powers(loads: Any, i: int, motion: Any, out: Array) -> None:
    """Add the sums over all points of what loads give, and what they take for good (W/m), to `out` (2,)."""


@inner
def _add_energies(load: Any, i: int, motion: Any, out: Array) -> None:
    """Add the sums of a load's potential energy, and of that of the mass it lets the rod take along (J/m), to `out`."""
    stored, kinetic = 0.0, 0.0
    prepare(load, i, motion, False)
    for j in range(len(motion.r)):
        at = point(motion, j)
        stored += energy(load, i, j, at)
        kinetic += entrained_energy(entrained(load, j, at))
    out[0] += stored
    out[1] += kinetic


def add_energies(loads: Any, i: int, motion: Any, out: Array) -> None:
    """Add the sums over all points of potential energy and of the kinetic energy of added mass (J/m) to `out` (2,)."""


@inner
def total_power(force: Any, moment: Any, V: Any, omega: Any) -> float:
    """force . V + moment . omega."""
    if moment is None:
        return float(dot(force, V))
    return float(dot(force, V) + dot(moment, omega))


@by_type
def carried_power(force: Any, velocity: Any) -> Any:
    """force . velocity, of which either may not be there."""
    if isinstance(force, types.NoneType) or isinstance(velocity, types.NoneType):
        return lambda force, velocity: 0.0
    return lambda force, velocity: dot(force, velocity)


@inner
def entrained_power(taken: Any) -> float:
    """The rate of the kinetic energy of entrained mass."""
    if taken is None:
        return 0.0
    return float(taken[0] * dot(taken[1], taken[2]))


@inner
def entrained_energy(taken: Any) -> float:
    """The kinetic energy of entrained mass."""
    if taken is None:
        return 0.0
    return float(0.5 * taken[0] * dot(taken[1], taken[1]))


@by_type
def mean_entrained(one: Any, other: Any) -> Any:
    """The mean of what is entrained at two points; None of None."""
    if isinstance(one, types.NoneType):
        return lambda one, other: None
    return lambda one, other: (0.5 * (one[0] + other[0]), middle(one[1], other[1]), middle(one[2], other[2]))


def has_tangents(record: type) -> bool:
    """Whether a load's force depends on how the rod lies and moves."""
    return has_variant(tangents, record)


def has_power(record: type) -> bool:
    """Whether the power of a load is anything but a change of its potential energy."""
    return has_variant(account, record)


def has_energy(record: type) -> bool:
    """Whether a load stores energy, or entrains mass."""
    return has_variant(energy, record) or has_variant(entrained, record)


def _always(_record: type) -> bool:
    return True


for_each(add_forces, _add_force, _always)
for_each(add_tangents, _add_tangents, has_tangents)
for_each(add_powers, _add_powers, has_power)
for_each(add_energies, _add_energies, has_energy)
