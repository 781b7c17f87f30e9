"""Elastic obstacles with friction: rounded bars and balls that push the rod out, and rub where it slides.

An obstacle is all that is nearer than its radius to a segment: a bar with round ends, or a ball where both ends are one
point. With c the segment's point nearest to the place r, n = (r - c) / |r - c|, the depth d = radius - |r - c| and the
velocity V_t across n,

    B = k d n - mu k d V_t / sqrt(|V_t|^2 + v0^2),

the law of the floor, whose plane is replaced by a curved surface: n turns by

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
from solver.kernels.vectors import add, dot, identity, minus, norm, outer, plus, scale, times, transform, vector
from solver.physics.loads.load import LOST, Point, Samples, Source, Tangents
from solver.scene.checks import require_finite
from solver.scene.scene import Scene

LEAP = 0.5
"""Part of the way to an obstacle, or of its radius, that a node may come nearer in a step."""
SMALLEST = 1e-300


@dataclass(frozen=True)
class Given:
    """An obstacle about the segment from `start` to `end` (lab, m), of stiffness k (N/m^2), friction mu and slip speed
    v0 (m/s). `radius` (m): that at which the centreline of the rod feels it.
    """

    start: tuple[float, float, float]
    end: tuple[float, float, float]
    radius: float
    stiffness: float
    friction: float = 0.0
    slip: float = 1e-3

    @property
    def scale(self) -> float:
        """Nodes farther apart than this may lie on both sides of it."""
        return self.radius

    def __post_init__(self) -> None:
        for name in ("start", "end"):
            require_finite(f"obstacle {name}", getattr(self, name))
        for name in ("radius", "stiffness", "slip"):
            if not (np.isfinite(getattr(self, name)) and getattr(self, name) > 0.0):
                raise ValueError(f"obstacle {name} must be > 0, got {getattr(self, name)}")
        if not (np.isfinite(self.friction) and self.friction >= 0.0):
            raise ValueError(f"obstacle friction must be >= 0, got {self.friction}")


class Record(NamedTuple):
    """A line for each obstacle: `start`, and `axis` to its other end (m, 3); `constants` (m, 4): radius, k, mu, v0."""

    present: bool
    start: Any
    axis: Any
    constants: Any


class Obstacles(Source):
    """Those of a scene: a step may not leap over one."""

    def __init__(self, record: Record) -> None:
        super().__init__(record)
        self.bars = record.present

    def longest_step(self, r: Array, V: Array) -> float:
        """In which no node comes nearer by more than LEAP of its gap, or of the radius where that is more."""
        start, axis, (radius, *_) = self.record.start, self.record.axis, self.record.constants.T
        away = r[:, None] - start
        part = np.clip((away * axis).sum(axis=2) / np.maximum((axis * axis).sum(axis=1), SMALLEST), 0.0, 1.0)
        way = away - part[:, :, None] * axis
        distance = np.linalg.norm(way, axis=2)
        closing = -(way * V[:, None]).sum(axis=2) / np.maximum(distance, SMALLEST)
        allowed = LEAP * np.maximum(distance - radius, radius)
        return float(1.0 / max(np.max(closing / allowed), SMALLEST))


class Near(NamedTuple):
    """A place beside an obstacle: the normal n, its derivative by the place, and the depth d, 0 outside."""

    n: Any
    turning: Any
    d: float


def of(scene: Scene, samples: Samples) -> Source:
    """The obstacles of a scene."""
    obstacles = [load for load in scene.loads if isinstance(load, Given)]
    start, end = (np.array([getattr(o, name) for o in obstacles], dtype=float).reshape(-1, 3)
                  for name in ("start", "end"))  # fmt: skip
    constants = np.array([[o.radius, o.stiffness, o.friction, o.slip] for o in obstacles]).reshape(-1, 4)
    return Obstacles(Record(bool(obstacles), start, end - start, constants))


@inner
def near(load: Record, k: int, at: Point) -> Near:
    """How a place lies to obstacle k. On its axis, where no side is the nearest, nothing pushes."""
    axis, away = vector(load.axis, k), minus(at.r, vector(load.start, k))
    square, along = dot(axis, axis), dot(away, axis)
    within = 0.0 < along < square
    part = along / square if within else (1.0 if along > 0.0 else 0.0)
    way = minus(away, times(part, axis))
    distance = norm(way)
    d = max(load.constants[k, 0] - distance, 0.0) if distance > 0.0 else 0.0
    inverse = 1.0 / distance if distance > 0.0 else 0.0
    n = times(inverse, way)
    turning = add(identity(inverse, n), outer(times(-inverse, n), n))
    if within:
        turning = add(turning, outer(times(-inverse / square, axis), axis))
    return Near(n, turning, d)


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
    for m in range(len(load.start)):
        n, _, d = near(load, m, at)
        total = plus(total, times(load.constants[m, 1] * d, n))
    return total


@inner
def force(load: Record, i: int, j: int, at: Point) -> Any:
    """The sum of B."""
    total = conservative(load, i, j, at)
    for m in range(len(load.start)):
        n, _, d = near(load, m, at)
        direction, _ = sliding(load.constants[m, 3], n, at)
        total = plus(total, times(-load.constants[m, 2] * load.constants[m, 1] * d, direction))
    return total, None


@inner
def tangents(load: Record, i: int, j: int, at: Point) -> Tangents:
    """By place and by velocity.

    With w = V_t / sqrt(...): dd = -n . dr, dw = (I - w w^t) dV_t / sqrt(...), and
    dV_t = (I - n n^t) dV - (n V^t + (n . V) I) dn.
    """
    K, C = identity(0.0, at.r), identity(0.0, at.r)
    for m in range(len(load.start)):
        n, turning, d = near(load, m, at)
        if d > 0.0:
            k, mu = load.constants[m, 1], load.constants[m, 2]
            w, speed = sliding(load.constants[m, 3], n, at)
            rubbed = mu * k * d / speed
            K = add(K, add(scale(k * d, turning), outer(plus(times(-k, n), times(mu * k, w)), n)))
            turned = add(turning, outer(times(-1.0, w), transform(turning, w)))
            K = add(K, scale(rubbed, add(outer(n, transform(turning, at.V)), scale(dot(n, at.V), turned))))
            across = add(identity(1.0, n), add(outer(times(-1.0, n), n), outer(times(-1.0, w), w)))
            C = add(C, scale(-rubbed, across))
    return Tangents(K, C, None, None, None, None, None)


@inner
def energy(load: Record, i: int, j: int, at: Point) -> float:
    """The sum of 1/2 k d^2."""
    total = 0.0
    for m in range(len(load.start)):
        total += 0.5 * load.constants[m, 1] * near(load, m, at).d ** 2
    return total


@inner
def account(load: Record) -> int:
    """Friction is lost."""
    return LOST
