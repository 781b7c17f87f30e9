"""An elastic floor with friction: a plane that pushes back where the rod is below it, and rubs where the rod slides.

With the depth d of the centreline below the plane, its unit normal n and V_t the velocity along the plane,

    B = k d n - mu k d V_t / sqrt(|V_t|^2 + v0^2),

Coulomb's friction, smooth below the slip speed v0.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt
from typing import Any, NamedTuple

import numpy as np

from solver.kernels.kernel import inner
from solver.kernels.vectors import add, dot, identity, outer, plus, scale, times, vector
from solver.physics.loads.load import LOST, Point, Samples, Source, Tangents
from solver.scene.scene import Scene


@dataclass(frozen=True)
class Given:
    """A floor through the lab point `height` normal (m), of stiffness k (N/m^2), friction mu and slip speed v0 (m/s).

    `normal` (lab, of any length > 0) points out of it.
    """

    stiffness: float
    height: float = 0.0
    normal: tuple[float, float, float] = (0.0, 0.0, 1.0)
    friction: float = 0.0
    slip: float = 1e-3

    def __post_init__(self) -> None:
        if not (np.isfinite(self.normal).all() and any(self.normal)):
            raise ValueError(f"floor normal must be finite and not zero, got {self.normal}")
        for name in ("stiffness", "slip"):
            if not (np.isfinite(getattr(self, name)) and getattr(self, name) > 0.0):
                raise ValueError(f"floor {name} must be > 0, got {getattr(self, name)}")
        if not (np.isfinite(self.friction) and self.friction >= 0.0):
            raise ValueError(f"floor friction must be >= 0, got {self.friction}")


class Record(NamedTuple):
    """`normal` (1, 3); `constants` (4,): height (m), k, mu, v0."""

    present: bool
    normal: Any
    constants: Any


def of(scene: Scene, samples: Samples) -> Source:
    """The floor of a scene. Raises ValueError if there are several."""
    floors = [load for load in scene.loads if isinstance(load, Given)]
    if len(floors) > 1:
        raise ValueError(f"a scene has one floor at the most, got {len(floors)}: {floors}")
    floor = floors[0] if floors else Given(1.0)
    normal = np.array([floor.normal], dtype=float)
    constants = np.array([floor.height, floor.stiffness, floor.friction, floor.slip])
    return Source(Record(bool(floors), normal / np.linalg.norm(normal), constants))


@inner
def depth(load: Record, at: Point) -> float:
    """d, or 0 above the floor."""
    return float(max(load.constants[0] - dot(vector(load.normal, 0), at.r), 0.0))


@inner
def sliding(load: Record, at: Point) -> Any:
    """V_t / sqrt(|V_t|^2 + v0^2), and the square root."""
    n, v0 = vector(load.normal, 0), load.constants[3]
    V_t = plus(at.V, times(-dot(n, at.V), n))
    speed = sqrt(dot(V_t, V_t) + v0 * v0)
    return times(1.0 / speed, V_t), speed


@inner
def conservative(load: Record, i: int, j: int, at: Point) -> Any:
    """k d n."""
    return times(load.constants[1] * depth(load, at), vector(load.normal, 0))


@inner
def force(load: Record, i: int, j: int, at: Point) -> Any:
    """B."""
    direction, _ = sliding(load, at)
    rubbed = times(-load.constants[2] * load.constants[1] * depth(load, at), direction)
    return plus(conservative(load, i, j, at), rubbed), None


@inner
def tangents(load: Record, i: int, j: int, at: Point) -> Tangents:
    """By place and by velocity."""
    n, d, k, mu = vector(load.normal, 0), depth(load, at), load.constants[1], load.constants[2]
    direction, speed = sliding(load, at)
    pressed = 1.0 if d > 0.0 else 0.0
    K = outer(plus(times(-k * pressed, n), times(mu * k * pressed, direction)), n)
    along = add(identity(1.0, n), add(outer(times(-1.0, n), n), outer(times(-1.0, direction), direction)))
    return Tangents(K, scale(-mu * k * d / speed, along), None, None, None, None, None)


@inner
def energy(load: Record, i: int, j: int, at: Point) -> float:
    """1/2 k d^2."""
    return float(0.5 * load.constants[1] * depth(load, at) ** 2)


@inner
def account(load: Record) -> int:
    """Friction is lost."""
    return LOST
