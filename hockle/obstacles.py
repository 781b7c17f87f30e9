"""Obstacles as shaded surfaces: rounded bars and balls, drawn around the rod and faded out where they go on."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise
from math import ceil
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from hockle.tube import LIGHT

Array = NDArray[np.float64]
Box = tuple[Array, Array]
"""Lowest and highest corner."""

ALONG, AROUND = 12, 48
"""Facets along each part of an outline, at least, and around it."""

FINE = 0.03
"""Extents of the rod: a facet is no longer, so that what fades does so without steps."""

FAR, ROOM, FADING = 2.0, 0.5, 0.2
"""Extents of the rod: an obstacle is drawn if it is nearer; so far around; faded over the last of it."""

BODY = np.array([0.44, 0.50, 0.57])
OPAQUE = 0.6


@dataclass(frozen=True)
class Obstacle:
    """All that is nearer than `radius` (m) to the segment from `start` to `end` (3).

    A place on its surface has two coordinates: u (m), along its axis on its outline (a quarter of a circle about the
    start, the length, a quarter about the end; 0 where the length begins), and the angle about the axis.
    """

    start: Array
    end: Array
    radius: float

    @classmethod
    def of(cls, case: Mapping[str, Any], axes: Array) -> list[Self]:
        """Those of a case, in other axes, the rows of `axes` (3, 3)."""
        return [cls(axes @ np.array(one["start"], float), axes @ np.array(one.get("end") or one["start"], float),
                    float(one["radius"])) for one in case.get("loads", {}).get("obstacles", ())]  # fmt: skip

    @property
    def length(self) -> float:
        """Of the segment."""
        return float(np.linalg.norm(self.end - self.start))

    def nearest(self, place: Array) -> Array:
        """The point of its surface that is nearest to a place; on its axis the place itself."""
        way = self.end - self.start
        part = np.clip((place - self.start) @ way / (way @ way), 0.0, 1.0) if way.any() else 0.0
        foot = self.start + part * way
        distance = np.linalg.norm(place - foot)
        return foot + self.radius / distance * (place - foot) if distance > 0 else place

    def facets(self, core: Box, extent: float, towards: Array) -> tuple[Array, Array]:
        """Quadrilaterals (m, 4, 3) of what faces an eye that lies in a direction, around a box, and their colours
        (m, 4), lit; `extent`: that of the rod.
        """
        axes = self._axes((core[0] + core[1]) / 2)
        low, high, half = self._within((core[0] - ROOM * extent, core[1] + ROOM * extent), axes)
        stops = [low, *(u for u in sorted({0.0, self.length}) if low < u < high), high]
        u = np.concatenate([np.linspace(first, last, max(ALONG, ceil((last - first) / (FINE * extent))) + 1)
                            for first, last in pairwise(stops)])  # fmt: skip
        place, normal = self._at(u[:, None], np.linspace(-half, half, AROUND + 1)[None, :], axes)
        quads, outward = (np.stack([x[:-1, :-1], x[1:, :-1], x[1:, 1:], x[:-1, 1:]], axis=2).reshape(-1, 4, 3)
                          for x in (place, normal))  # fmt: skip
        outward = outward.mean(axis=1)
        shown = np.clip((ROOM - outside(quads.mean(axis=1), core) / extent) / FADING, 0.0, 1.0)
        seen = (shown > 0) & (outward @ towards > 0)
        light = 0.6 + 0.5 * np.clip(outward[seen] @ LIGHT, 0.0, 1.0)
        return quads[seen], np.column_stack([np.clip(BODY * light[:, None], 0.0, 1.0), OPAQUE * shown[seen]])

    def _axes(self, towards: Array) -> Array:
        """Its own (3, 3): along the segment, and two across it, the first towards a place."""
        way, away = self.end - self.start, towards - self.start
        axis = _unit(way) if way.any() else _across(_unit(away) if away.any() else np.eye(3)[2])
        aside = away - (away @ axis) * axis
        first = _unit(aside) if np.linalg.norm(aside) > 1e-9 * np.linalg.norm(away) else _across(axis)
        return np.array([axis, first, np.cross(axis, first)])

    def _within(self, box: Box, axes: Array) -> tuple[float, float, float]:
        """What lies in a box: u from and to, and the largest angle."""
        middle = axes @ ((box[0] + box[1]) / 2 - self.start)
        reach = np.abs(axes) @ (box[1] - box[0]) / 2
        low, high = (self._u(middle[0] + sign * reach[0]) for sign in (-1, 1))
        narrowest = self.radius * float(np.cos([self._bend(low), self._bend(high)]).min())
        wide = abs(middle[2]) + reach[2]
        half_is_seen = wide < narrowest and middle[1] - reach[1] > 0
        return low, high, float(np.arcsin(wide / narrowest)) if half_is_seen else np.pi

    def _u(self, z: float) -> float:
        """By the place along the axis."""
        along = np.clip(z, 0.0, self.length)
        return float(along + self.radius * np.arcsin(np.clip((z - along) / self.radius, -1.0, 1.0)))

    def _bend(self, u: Any) -> Any:
        """The angle of the normal out of the plane across the axis."""
        return (u - np.clip(u, 0.0, self.length)) / self.radius

    def _at(self, u: Array, angle: Array, axes: Array) -> tuple[Array, Array]:
        """Places and the normals there."""
        bend = self._bend(u)
        parts = np.broadcast_arrays(np.sin(bend), np.cos(bend) * np.cos(angle), np.cos(bend) * np.sin(angle))
        normal = np.stack(parts, axis=-1) @ axes
        return self.start + np.clip(u, 0.0, self.length)[..., None] * axes[0] + self.radius * normal, normal


def surfaces(case: Mapping[str, Any], axes: Array, rod: Box, towards: Array) -> tuple[Array, Array]:
    """Quadrilaterals (m, 4, 3) and their colours (m, 4) of the obstacles of a case that are near its rod: what faces an
    eye that lies in a direction, in the view's `axes` (3, 3).
    """
    extent, centre = float((rod[1] - rod[0]).max()), (rod[0] + rod[1]) / 2
    near = [one for one in Obstacle.of(case, axes) if outside(one.nearest(centre), rod) < FAR * extent]
    corners = np.array([*rod, *(one.nearest(centre) for one in near)])
    core = (corners.min(axis=0), corners.max(axis=0))
    parts = [(np.empty((0, 4, 3)), np.empty((0, 4))), *(one.facets(core, extent, towards) for one in near)]
    return np.concatenate([quads for quads, _ in parts]), np.concatenate([colours for _, colours in parts])


def outside(place: Array, box: Box) -> Any:
    """How far places (..., 3) are out of a box (m), along the axis where it is the most."""
    return np.maximum(0.0, np.maximum(box[0] - place, place - box[1])).max(axis=-1)


def _unit(vector: Array) -> Array:
    return vector / np.linalg.norm(vector)


def _across(unit: Array) -> Array:
    """A unit vector normal to a unit vector."""
    axis = np.eye(3)[int(np.argmin(np.abs(unit)))]
    return _unit(axis - (axis @ unit) * unit)
