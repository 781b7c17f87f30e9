"""What a rod is drawn above, and throws its shadow on: the floor of its scene where it lies, else a plane below."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Self

import numpy as np
from mpl_toolkits.mplot3d.art3d import Poly3DCollection  # type: ignore[import-untyped]
from mpl_toolkits.mplot3d.axes3d import Axes3D  # type: ignore[import-untyped]
from numpy.typing import NDArray

from hockle.obstacles import Box, outside

Array = NDArray[np.float64]

GRID, FLOOR = "#e3e6ea", "#c7b09a"
OPAQUE = 0.3


@dataclass(frozen=True)
class Ground:
    """Below a box, the plane of the points at `height` (m) along a unit `normal` (3)."""

    normal: Array
    height: float
    box: Box
    is_floor: bool = False

    @classmethod
    def of(cls, case: Mapping[str, Any], axes: Array, rod: Box, box: Box) -> Self:
        """The floor of a case, in the view's `axes` (3, 3), if it is nearer to the rod than the rod is long; else the
        bottom of the box.
        """
        floor = case.get("loads", {}).get("floor")
        if floor:
            normal = axes @ np.array(floor.get("normal", (0, 0, 1)), float)
            ground = cls(normal / np.linalg.norm(normal), float(floor.get("height", 0.0)), box, True)
            if outside(ground.foot((rod[0] + rod[1]) / 2), rod) < (rod[1] - rod[0]).max():
                return ground
        return cls(np.array([0.0, 0.0, 1.0]), float(box[0][2]), box)

    def foot(self, r: Array) -> Array:
        """Where places (..., 3) throw their shadow."""
        return r + (self.height - r @ self.normal)[..., None] * self.normal

    @property
    def corners(self) -> Array:
        """Of what is drawn (4, 3), one after the other around it."""
        (left, near), (right, far) = self._span()
        return self._at(np.array([[left, near], [right, near], [right, far], [left, far]]))

    def draw(self, axes: Axes3D, step: float, towards: Array) -> None:
        """A grid of squares of `step` (m), and a sheet where it is a floor; `towards` (3): where the eye is."""
        (left, near), (right, far) = self._span()
        order, colour = (0 if self.normal @ towards >= 0 else 4), FLOOR if self.is_floor else GRID
        if self.is_floor:
            axes.add_collection3d(Poly3DCollection([self.corners], facecolors=[colour], alpha=OPAQUE, zorder=order))
        lines = [((x, near), (x, far)) for x in np.arange(np.ceil(left / step) * step, right, step)]
        lines += [((left, y), (right, y)) for y in np.arange(np.ceil(near / step) * step, far, step)]
        for line in lines:
            axes.plot(*self._at(np.array(line)).T, color=colour, linewidth=0.8, zorder=order)

    def _axes(self) -> Array:
        """Two unit vectors (2, 3) in the plane, the first to the right where it can be."""
        right = np.eye(3)[0 if abs(self.normal[0]) < 0.9 else 1]
        first = right - (right @ self.normal) * self.normal
        first /= np.linalg.norm(first)
        return np.array([first, np.cross(self.normal, first)])

    def _span(self) -> tuple[Array, Array]:
        """From where to where along its axes the box lies above it."""
        axes, (low, high) = self._axes(), self.box
        middle, half = axes @ (low + high) / 2, np.abs(axes) @ (high - low) / 2
        return middle - half, middle + half

    def _at(self, places: Array) -> Array:
        return self.height * self.normal + places @ self._axes()
