"""Rods in 3-D, each on a panel of its own with what is around it: one scale, equal axes, a grid and a shadow below."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import ceil
from textwrap import fill
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.colors import to_rgba_array
from matplotlib.figure import Figure
from matplotlib.text import Text
from mpl_toolkits.mplot3d import proj3d  # type: ignore[import-untyped]
from mpl_toolkits.mplot3d.art3d import Poly3DCollection  # type: ignore[import-untyped]
from mpl_toolkits.mplot3d.axes3d import Axes3D  # type: ignore[import-untyped]
from numpy.typing import NDArray

from hockle.ground import Ground
from hockle.obstacles import Box, surfaces
from hockle.tube import Tube, radius
from hockle.view import View

Array = NDArray[np.float64]

THICKNESS = 0.005
"""The least radius of a tube, as a fraction of the shapes' extent: thinner ones are drawn thicker than they are."""

MARGIN = 0.94
"""The part of a panel's width that is filled."""

ELEVATION, AZIMUTH = 18.0, -62.0
TOWARDS = np.array([np.cos(np.radians(ELEVATION)) * np.cos(np.radians(AZIMUTH)),
                    np.cos(np.radians(ELEVATION)) * np.sin(np.radians(AZIMUTH)), np.sin(np.radians(ELEVATION))])
"""Where the eye is."""

PANEL = 5.5
"""Width of a panel in inches, and the most of its height."""

HEADING = 0.45
"""Height of a panel's heading in inches."""

TITLE, CAPTION = 11, 14
"""Letters to an inch."""

STEPS = (0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0)
SHADOW, GHOST = "#b9c0c9", "#93a1b3"


class Stage:
    """Panels to one scale, for tubes in a view's axes (right, back, up)."""

    def __init__(
        self, cases: Sequence[Mapping[str, Any]], views: Sequence[View], points: Array, note: str = ""
    ) -> None:
        """`cases` and `views`: those of each panel; `points` (m, 3): all that a rod ever reaches, in the views' axes;
        `note`: what else the caption says.
        """
        rod = (points.min(axis=0), points.max(axis=0))
        self._solids = [surfaces(case, view.axes, rod, TOWARDS) for case, view in zip(cases, views, strict=True)]
        points = np.vstack([points, *(quads.reshape(-1, 3) for quads, _ in self._solids)])
        extent, radii = float(np.ptp(points, axis=0).max()), [radius(case) for case in cases]
        self._radii = [max(radius, THICKNESS * extent) for radius in radii]
        self._box = _box(points, extent, max(self._radii))
        self._grounds = [Ground.of(case, view.axes, rod, self._box) for case, view in zip(cases, views, strict=True)]
        low, high = _projected_box(np.vstack([points, *(ground.corners for ground in self._grounds)]), self._box)
        self._size = PANEL * MARGIN / float((high - low).max())
        self._centre = (low + high) / 2
        columns, rows = min(2, len(cases)), ceil(len(cases) / 2)
        row = self._size * float(high[1] - low[1]) + HEADING
        self.figure = Figure(figsize=(columns * PANEL, rows * row + 1.1), facecolor="white")
        step = next((step for step in STEPS if extent / step <= 12), STEPS[-1])
        self._panels = [self._panel(i, columns, row, step) for i in range(len(cases))]
        self._drawn: list[list[Artist]] = [[] for _ in cases]
        around = {"floor brown": any(ground.is_floor for ground in self._grounds),
                  "obstacles grey": any(len(quads) for quads, _ in self._solids),
                  "tubes thicker than the rod": 1.01 * min(radii) < THICKNESS * extent}  # fmt: skip
        words = ", ".join([*(name for name, there in around.items() if there), "stripe along a1"])
        caption = fill(f"grid {step:g} m, {views[0].directions}{note}; {words}", int(columns * PANEL * CAPTION))
        self.figure.text(0.5, 0.1 / self.figure.get_figheight(), caption, ha="center", color="#6b7280", fontsize=9)

    def draw(self, panel: int, tube: Tube, title: str, ghost: Array | None = None) -> None:
        """Show a tube on a panel in place of what it showed; `ghost` (n, 3): a line to compare it with."""
        (axes, heading), shown = self._panels[panel], self._drawn[panel]
        for artist in shown:
            artist.remove()
        heading.set_text(title)
        surface = _surface(tube.facets(self._radii[panel]), self._solids[panel])
        axes.add_collection3d(surface)
        shadow = self._grounds[panel].foot(tube.r)
        shown[:] = [surface, *axes.plot(*shadow.T, color=SHADOW, linewidth=2.2, zorder=1)]
        if ghost is not None:
            shown += axes.plot(*ghost.T, color=GHOST, linewidth=1.0, linestyle=(0, (4, 3)), zorder=1)

    def _panel(self, place: int, columns: int, row: float, step: float) -> tuple[Axes3D, Text]:
        """Square axes (what 3-D axes are) with what is seen amid a panel, and a heading; empty parts overlap."""
        width, height = self.figure.get_size_inches()
        top = height - 0.6 - (place // columns) * row
        middle = np.array([(place % columns + 0.5) * PANEL, top - (row + HEADING) / 2])
        left, bottom = (middle - self._size * self._centre) / (width, height)
        axes: Axes3D = self.figure.add_axes(
            (left, bottom, self._size / width, self._size / height), projection="3d"
        )
        _prepare(axes, self._box)
        self._grounds[place].draw(axes, step, TOWARDS)
        heading = self.figure.text(middle[0] / width, top / height - 0.01, "", ha="center", va="top", fontsize=11)
        return axes, heading

    def title(self, text: str) -> None:
        """Name the whole."""
        self.figure.suptitle(fill(text, int(self.figure.get_figwidth() * TITLE)), fontsize=12)


def _surface(*parts: tuple[Array, Array]) -> Poly3DCollection:
    """Facets (m, 4, 3) with colours, in one collection: each hides what is behind it."""
    quads, colours = (np.concatenate(one) for one in zip(*((q, to_rgba_array(c)) for q, c in parts), strict=True))
    edges = np.where(colours[:, 3:] < 1.0, 0.0, colours)  # edges would be seen through facets that are not opaque
    return Poly3DCollection(list(quads), facecolors=colours, edgecolors=edges, linewidths=0.2, zorder=2)


def _projected_box(points: Array, box: Box) -> tuple[Array, Array]:
    """Where points (m, 3) are seen in square axes of width 1: left below, right above."""
    axes: Axes3D = Figure(figsize=(1.0, 1.0)).add_axes((0.0, 0.0, 1.0, 1.0), projection="3d")
    _prepare(axes, box)
    x, y, _ = proj3d.proj_transform(*points.T, axes.get_proj())
    projected = axes.transAxes.inverted().transform(axes.transData.transform(np.column_stack([x, y])))
    return projected.min(axis=0), projected.max(axis=0)


def _box(points: Array, extent: float, radius: float) -> Box:
    """Lowest and highest corner of the box that is drawn: room for the tubes, and a floor of some depth."""
    low, high = points.min(axis=0), points.max(axis=0)
    least = np.array([0.0, 0.3, 0.1]) * extent
    room = np.maximum(0.0, least - (high - low)) / 2 + 2 * radius
    return low - room, high + room


def _prepare(axes: Axes3D, box: Box) -> None:
    """Equal scales, and nothing drawn by the axes themselves."""
    low, high = box
    axes.computed_zorder = False
    axes.set_proj_type("persp", focal_length=0.8)
    axes.view_init(elev=ELEVATION, azim=AZIMUTH)
    axes.set_xlim(low[0], high[0])
    axes.set_ylim(low[1], high[1])
    axes.set_zlim(low[2], high[2])
    axes.set_box_aspect(high - low)
    axes.set_axis_off()
    axes.patch.set_visible(False)
