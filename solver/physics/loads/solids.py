"""Elastic solids with friction: a floor, and rounded bars and balls, which push the rod out, and rub where it slides.

With the depth d of the centreline below a solid's surface, its unit normal n outwards there, and the velocity V_t along
the surface,

    B = k d n - mu k d V_t / sqrt(|V_t|^2 + v0^2),

Coulomb's friction, smooth below the slip speed v0. A floor is all below a plane. An obstacle is all that is nearer than
its radius to a segment: a bar with round ends, or a ball where both ends are one point. With c the segment's point
nearest to the place r, n = (r - c) / |r - c|, d = radius - |r - c|, and

    dn/dr = (I - n n^t - a a^t) / |r - c|,

a the direction of the segment where c lies within it, and nothing beyond its ends.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt
from typing import Any, NamedTuple

import numpy as np

from solver.arrays import Array
from solver.kernels.kernel import inner
from solver.kernels.vectors import add, dot, identity, outer, plus, times
from solver.physics.loads import blows
from solver.physics.loads.load import Point, Samples, Source, Tangents, as_lost
from solver.physics.loads.surfaces import Near, near, turning
from solver.scene.checks import require_finite, unit_vector
from solver.scene.scene import Scene

account = as_lost

FOLLOWED = 2.0
"""By how much (rad) a swing in a blow goes on in a step, at a tolerance of 1: times its 4th root, so that the error of
order 5 falls somewhat faster than it."""
SMALLEST = 1e-300
ASLANT = 0.1
"""Sine of the angle between a rod and an obstacle that it lies along, at the least, as the rod will bend."""


@dataclass(frozen=True)
class Floor:
    """A floor through the lab point `height` normal (m), of stiffness k (N/m^2), friction mu and slip speed v0 (m/s).

    `normal` (lab, of any length > 0) points out of it.
    """

    stiffness: float
    height: float = 0.0
    normal: tuple[float, float, float] = (0.0, 0.0, 1.0)
    friction: float = 0.0
    slip: float = 1e-3

    def __post_init__(self) -> None:
        unit_vector("floor normal", self.normal)
        _check("floor", self, "stiffness", "slip")

    @property
    def up(self) -> Array:
        """The unit vector (3,) along `normal`."""
        return unit_vector("floor normal", self.normal)

    def depth(self, r: Array) -> Array:
        """How deep (m) below its surface places r (n, 3) are; negative outside."""
        return np.asarray(self.height - r @ self.up)


@dataclass(frozen=True)
class Obstacle:
    """An obstacle about the segment from `start` to `end` (lab, m), of stiffness k (N/m^2), friction mu and slip speed
    v0 (m/s). `radius` (m): that at which the centreline of the rod feels it.
    """

    start: tuple[float, float, float]
    end: tuple[float, float, float]
    radius: float
    stiffness: float
    friction: float = 0.0
    slip: float = 1e-3

    def scale(self, tangents: Array) -> float:
        """Nodes farther apart (m) than this, of a rod with `tangents` (n, 3), may lie on both sides of it."""
        axis = np.array(self.end) - np.array(self.start)
        across = np.linalg.norm(np.cross(tangents, axis), axis=1).max() / max(float(np.linalg.norm(axis)), SMALLEST)
        return self.radius / max(float(across), ASLANT) if axis.any() else self.radius

    def __post_init__(self) -> None:
        require_finite("obstacle start", self.start)
        require_finite("obstacle end", self.end)
        _check("obstacle", self, "radius", "stiffness", "slip")

    def depth(self, r: Array) -> Array:
        """How deep (m) below its surface places r (n, 3) are; negative outside."""
        away, axis = r - np.array(self.start), np.array(self.end) - np.array(self.start)
        part = np.clip(away @ axis / max(float(axis @ axis), SMALLEST), 0.0, 1.0)
        return np.asarray(self.radius - np.linalg.norm(away - part[:, None] * axis, axis=1))


Given = Floor | Obstacle


def deepest_within(scene: Scene, s: Array, r: Array) -> float:
    """How deep (m) below the surface of a solid the rod's centreline is, with nodes at `s` (n,) in places r (n, 3),
    where that is deeper than its diameter; 0 elsewhere."""
    depths = [load.depth(r) for load in scene.loads if isinstance(load, Given)]
    if not depths:
        return 0.0
    depth = np.max(depths, axis=0)
    return float(np.max(np.where(depth > scene.rod.diameter(s), depth, 0.0)))


def _check(name: str, solid: Given, *positive: str) -> None:
    for field in positive:
        if not (np.isfinite(getattr(solid, field)) and getattr(solid, field) > 0.0):
            raise ValueError(f"{name} {field} must be > 0, got {getattr(solid, field)}")
    if not (np.isfinite(solid.friction) and solid.friction >= 0.0):
        raise ValueError(f"{name} friction must be >= 0, got {solid.friction}")


class Record(NamedTuple):
    """A line for each solid: `flat`, whether it is a floor; `start`, and `axis` to its other end (m, 3), of a floor 0
    and its unit normal; `radius`, of a floor its height, `stiffness`, `friction`, `slip` (m,)."""

    present: bool
    flat: Any
    start: Any
    axis: Any
    radius: Any
    stiffness: Any
    friction: Any
    slip: Any


class Solids(Source):
    """Those of a scene: a step may leap over no obstacle, and ends where a blow begins and ends."""

    strikes = True

    def __init__(self, record: Record) -> None:
        super().__init__(record)
        self.bars = not record.flat.all()

    def longest_step(self, r: Array, V: Array) -> float:
        """See `blows`."""
        return float(blows.longest_step(self.record, r, np.ascontiguousarray(V)))

    def missed(self, r: Array, mass: Array, dt: float) -> float:
        """See `blows`."""
        return float(blows.missed(self.record, r, mass, dt))

    def next_blow(self, motion: Array, mass: Array, tolerance: float) -> float:
        """See `blows`."""
        r, V, A = motion
        return float(blows.next_blow(self.record, r, V, A, mass, FOLLOWED * tolerance**0.25))

    def compile(self) -> None:
        """Have the kernels compiled that ask where a rod comes to solids."""
        motion, mass = np.zeros((3, 1, 3)), np.ones(1)
        self.longest_step(motion[0], motion[1])
        self.missed(motion, mass, 0.0)
        self.next_blow(motion, mass, 1.0)


def of(scene: Scene, samples: Samples) -> Source:
    """The solids of a scene."""
    solids = [load for load in scene.loads if isinstance(load, Given)]
    lines = [(np.zeros(3), solid.up, solid.height) if isinstance(solid, Floor)
             else (solid.start, np.subtract(solid.end, solid.start), solid.radius) for solid in solids]  # fmt: skip
    start, axis = (np.array([line[i] for line in lines], dtype=float).reshape(-1, 3) for i in range(2))
    radius = np.array([line[2] for line in lines], dtype=float)
    stiffness, friction, slip = (np.array([getattr(solid, name) for solid in solids], dtype=float)
                                 for name in ("stiffness", "friction", "slip"))  # fmt: skip
    flat = np.array([isinstance(solid, Floor) for solid in solids], dtype=bool)
    return Solids(Record(bool(solids), flat, start, axis, radius, stiffness, friction, slip))


@inner
def depth(by: Near) -> float:
    """d (m), 0 outside."""
    return max(-by.height, 0.0)


@inner
def sliding(v0: float, n: Any, at: Point) -> Any:
    """V_t / sqrt(|V_t|^2 + v0^2), and the square root."""
    V_t = plus(at.V, times(-dot(n, at.V), n))
    speed = sqrt(dot(V_t, V_t) + v0 * v0)
    return times(1.0 / speed, V_t), speed


@inner
def conservative(load: Record, i: int, j: int, at: Point) -> Any:
    """The sum of k d n."""
    total = times(0.0, at.r)
    for m in range(len(load.radius)):
        by = near(load, m, at.r)
        total = plus(total, times(load.stiffness[m] * depth(by), by.n))
    return total


@inner
def force(load: Record, i: int, j: int, at: Point) -> Any:
    """The sum of B."""
    total = conservative(load, i, j, at)
    for m in range(len(load.radius)):
        by = near(load, m, at.r)
        w, _ = sliding(load.slip[m], by.n, at)
        total = plus(total, times(-load.friction[m] * load.stiffness[m] * depth(by), w))
    return total, None


@inner
def tangents(load: Record, i: int, j: int, at: Point) -> Tangents:
    """By place and by velocity.

    With w = V_t / sqrt(...): dd = -n . dr, dV_t = (I - n n^t) dV - (n V^t + (n . V) I) dn, and dw by place as
    (I - w w^t) dV_t / sqrt(...). By velocity as dV_t / sqrt(...), a secant to where the rod sticks: where it slides
    nothing resists a change along w, and an iteration with that tangent leaps over sticking, to and fro.
    """
    K, C = identity(0.0, at.r), identity(0.0, at.r)
    for m in range(len(load.radius)):
        by = near(load, m, at.r)
        d = depth(by)
        if d > 0.0:
            k, n, (w, speed) = load.stiffness[m], by.n, sliding(load.slip[m], by.n, at)
            pressed, rubbed, leaving = k * d, load.friction[m] * k * d / speed, dot(by.n, at.V)
            turned = by.curvature * (pressed + rubbed * leaving)
            K = add(K, identity(turned, n))
            K = add(K, outer(plus(times(-k - turned, n), times(load.friction[m] * k, w)), n))
            K = add(K, outer(times(-turned, by.a), by.a))
            K = add(K, outer(times(rubbed, n), turning(by, at.V)))
            K = add(K, outer(times(-rubbed * leaving, w), turning(by, w)))
            C = add(C, add(identity(-rubbed, n), outer(times(rubbed, n), n)))
    return Tangents(K, C, None, None, None, None, None)


@inner
def energy(load: Record, i: int, j: int, at: Point) -> float:
    """The sum of 1/2 k d^2."""
    total = 0.0
    for m in range(len(load.radius)):
        total += 0.5 * load.stiffness[m] * depth(near(load, m, at.r)) ** 2
    return total
