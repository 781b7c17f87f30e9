"""What lies hidden within an interval: bends, and loads, that cancel there; and creases.

A mesh counts what is between its nodes by its means. Of a bend to the left and one to the right within an interval
these show nothing, nor of two moments against each other: two meshes that are blind to them agree, as if there were no
error. The first mesh is so fine that the one after it is not blind.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from solver.arrays import Array
from solver.physics.loads.given import is_steady, points_within
from solver.scene.curve import corners_of
from solver.scene.loads import DistributedLoad, PointLoad
from solver.scene.rod import Rod
from solver.scene.scene import Scene

LOOKED_AT = 2049
"""Places at which what is given along the rod is looked at, besides its corners."""
TIMES = 33
"""Times at which loads are looked at."""


class Hidden(NamedTuple):
    """The `parts` (n, k), at `places` (n,), of something that bends the rod: angles (rad), moments or forces.

    What cancels moves the rod, in rod lengths, by a `share` of it times the part of the rod that an interval is, to a
    `power`: 1 of angles and moments, 2 of forces, which need an arm to bend it.
    """

    places: Array
    parts: Array
    power: int
    share: float

    def moves(self, h: float, length: float) -> float:
        """How far (rod lengths) what cancels within intervals of h moves a rod of this length, about."""
        return self.share * cancelled(self.places, self.parts, h) * (h / length) ** self.power


class Creases(NamedTuple):
    """The angles (n, 2), rad, by which a rod is bent by nature at `places` (n,). Two joints share what lies between
    them."""

    places: Array
    angles: Array

    def moves(self, h: float, length: float) -> float:
        """How far (rod lengths) it moves the rod, about, that the sharpest crease is shared by joints h apart."""
        turned = np.append(0.0, np.cumsum(np.linalg.norm(self.angles, axis=1)))
        first, end = np.arange(len(self.places)), np.searchsorted(self.places, self.places + h)
        crease = float((turned[end] - turned[first]).max()) - float(turned[-1]) * h / length
        return 0.125 * crease**2 * h / length


def cancelled(places: Array, parts: Array, h: float) -> float:
    """The most that cancels of `parts` (n, k) at ascending `places` (n,) within any length h: the sum of their sizes
    less the size of their sum."""
    sizes = np.append(0.0, np.cumsum(np.linalg.norm(parts, axis=1)))
    sums = np.vstack([np.zeros(parts.shape[1]), np.cumsum(parts, axis=0)])
    first, end = np.arange(len(places)), np.searchsorted(places, places + h)
    return float((sizes[end] - sizes[first] - np.linalg.norm(sums[end] - sums[first], axis=1)).max(initial=0.0))


def hidden_in(scene: Scene, s: Array, kappa: Array) -> list[Hidden | Creases]:
    """All that an interval of some mesh may hide; `kappa` (n, 3): of the initial shape at `s` (n,)."""
    bends: list[Hidden | Creases] = [Hidden(*_bends(s, kappa[1:]), 1, 0.5)]
    if corners := corners_of(*scene.rod.kappa0):
        grid = _grid(scene.rod, corners)
        middles = 0.5 * (grid[1:] + grid[:-1])
        natural = _bends(grid, np.stack([profile(middles) for profile in scene.rod.kappa0], axis=1))
        bends += [Hidden(*natural, 1, 0.5), Creases(*natural)]
    s = np.linspace(0.0, scene.rod.length, LOOKED_AT)
    softest = min(float(np.min(profile(s))) for profile in scene.rod.stiffness)
    return bends + [load for t in _times(scene) for load in _loads(scene, t, softest)]


def _bends(grid: Array, kappa: Array) -> tuple[Array, Array]:
    """Where, and by what angles (n, 2), the centreline turns; its twist does not."""
    return grid[:-1], kappa[:, :2] * np.diff(grid)[:, None]


def _times(scene: Scene) -> Sequence[float]:
    loads: tuple[DistributedLoad | PointLoad, ...] = (*scene.distributed, *scene.points)
    return [0.0] if all(is_steady(load) for load in loads) else np.linspace(0.0, scene.t_end, TIMES).tolist()


def _loads(scene: Scene, t: float, softest: float) -> Iterator[Hidden]:
    """Forces and moments along lab and material axes at time t, each component for itself; `softest`: the rod's least
    stiffness (N m^2)."""
    length = float(scene.rod.length)
    for part, power, share in (("moment", 1, 0.5 * length / softest), ("force", 2, 0.125 * length**2 / softest)):
        for frame in ("lab", "material"):
            places, values = _along(scene, part, frame, t)
            for component in values.T:
                if component.any():
                    yield Hidden(places, component[:, None], power, share)


def _along(scene: Scene, part: str, frame: str, t: float) -> tuple[Array, Array]:
    """Where (n,), and how much (n, 3), of the given forces (N), or moments (N m), along lab, or material, axes."""
    points = [load for load in points_within(scene) if load.frame == frame]
    spread = [load for load in scene.distributed if load.frame == frame]
    corners = corners_of(*(profile for load in spread for profile in getattr(load, part)))
    places, values = np.array([load.s for load in points]), np.zeros((len(points), 3))
    for row, point in enumerate(points):
        values[row] = [curve.value(t) for curve in getattr(point, part)]
    if corners:  # what is the same all along cancels nothing
        grid = _grid(scene.rod, corners)
        middles = 0.5 * (grid[1:] + grid[:-1])
        density = sum(load.schedule.value(t) * np.stack([profile(middles) for profile in getattr(load, part)], axis=1)
                      for load in spread)  # fmt: skip
        places = np.append(places, middles)
        values = np.vstack([values, density * np.diff(grid)[:, None]])
    order = np.argsort(places, kind="stable")
    return places[order], values[order]


def _grid(rod: Rod, corners: Sequence[float]) -> Array:
    """Arclengths from end to end between which a profile with these corners is nearly a straight line."""
    return np.union1d(np.linspace(0.0, rod.length, LOOKED_AT), [s for s in corners if 0.0 < s < rod.length])
