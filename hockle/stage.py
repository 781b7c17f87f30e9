"""Rods in 3-D, each on a panel of its own: one scale, equal axes, a grid and a shadow below."""

from __future__ import annotations

from math import ceil

import numpy as np
from matplotlib.artist import Artist
from matplotlib.figure import Figure
from matplotlib.text import Text
from mpl_toolkits.mplot3d.art3d import Poly3DCollection  # type: ignore[import-untyped]
from mpl_toolkits.mplot3d.axes3d import Axes3D  # type: ignore[import-untyped]
from numpy.typing import NDArray

from hockle.tube import Tube

Array = NDArray[np.float64]

THICKNESS = 0.005
"""The tube's radius as a fraction of the shapes' extent."""

MARGIN = 0.92
"""The part of a panel that the shapes may take; perspective makes what is near larger than the box says."""

ELEVATION, AZIMUTH = 18.0, -62.0
PANEL = 5.5
"""Width of a panel in inches."""

STEPS = (0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0)
GRID, SHADOW, GHOST = "#e3e6ea", "#b9c0c9", "#93a1b3"


class Stage:
    """Panels to one scale, for tubes in a view's axes (right, back, up)."""

    def __init__(self, panels: int, points: Array, told: str) -> None:
        """`points` (m, 3): all that is ever drawn; `told`: where the lab axes point."""
        self._extent = float(np.ptp(points, axis=0).max())
        self._low, self._high = _box(points, self._extent)
        width, height = _seen(self._high - self._low)
        self._zoom = MARGIN * float(np.linalg.norm(self._high - self._low)) / max(width, height)
        columns, rows = min(2, panels), ceil(panels / 2)
        row = PANEL * min(1.0, height / width) + 0.3
        self.figure = Figure(figsize=(columns * PANEL, rows * row + 1.0), facecolor="white")
        step = next((step for step in STEPS if self._extent / step <= 12), STEPS[-1])
        self._panels = [self._panel(i, columns, row, step) for i in range(panels)]
        self._drawn: list[list[Artist]] = [[] for _ in range(panels)]
        caption = f"grid {step:g} m, {told}; tubes thicker than the rod, stripe along a1"
        self.figure.text(0.5, 0.1 / self.figure.get_figheight(), caption, ha="center", color="#6b7280", fontsize=9)

    def draw(self, panel: int, tube: Tube, title: str, ghost: Array | None = None) -> None:
        """Show a tube on a panel in place of what it showed; `ghost` (n, 3): a line to compare it with."""
        (axes, heading), shown = self._panels[panel], self._drawn[panel]
        for artist in shown:
            artist.remove()
        heading.set_text(title)
        floor = float(self._low[2])
        quads, colours = tube.facets(THICKNESS * self._extent)
        surface = Poly3DCollection(list(quads), facecolors=colours, edgecolors=colours, linewidths=0.2, zorder=2)
        axes.add_collection3d(surface)
        shown[:] = [surface, *axes.plot(tube.r[:, 0], tube.r[:, 1], floor, color=SHADOW, linewidth=2.2, zorder=1)]
        if ghost is not None:
            shown += axes.plot(*ghost.T, color=GHOST, linewidth=1.0, linestyle=(0, (4, 3)), zorder=1)

    def _panel(self, place: int, columns: int, row: float, step: float) -> tuple[Axes3D, Text]:
        """Square axes (what 3-D axes are) centred on a row, and their heading; what is empty overlaps the other row."""
        height = self.figure.get_figheight()
        top = 1.0 - (0.5 + (place // columns) * row) / height
        left, centre = (place % columns) / columns, top - row / 2 / height
        axes: Axes3D = self.figure.add_axes(
            (left, centre - PANEL / 2 / height, 1 / columns, PANEL / height), projection="3d"
        )
        _prepare(axes, self._low, self._high, self._zoom)
        _floor(axes, self._low, self._high, step)
        heading = self.figure.text(left + 0.5 / columns, top - 0.01, "", ha="center", va="top", fontsize=11)
        return axes, heading

    def title(self, text: str) -> None:
        """Name the whole."""
        self.figure.suptitle(text, fontsize=12)


def _seen(size: Array) -> tuple[float, float]:
    """Width and height of a box of that size as it is seen."""
    elevation, azimuth = np.radians(ELEVATION), np.radians(AZIMUTH)
    along, aside = abs(np.cos(azimuth)), abs(np.sin(azimuth))
    width = aside * size[0] + along * size[1]
    height = np.cos(elevation) * size[2] + np.sin(elevation) * (along * size[0] + aside * size[1])
    return float(width), float(height)


def _box(points: Array, extent: float) -> tuple[Array, Array]:
    """Lowest and highest corner of the box that is drawn: room for the tubes, and a floor of some depth."""
    low, high = points.min(axis=0), points.max(axis=0)
    least = np.array([0.0, 0.3, 0.1]) * extent
    room = np.maximum(0.0, least - (high - low)) / 2 + 2 * THICKNESS * extent
    return low - room, high + room


def _prepare(axes: Axes3D, low: Array, high: Array, zoom: float) -> None:
    """Equal scales, and nothing drawn by the axes themselves."""
    axes.computed_zorder = False
    axes.set_proj_type("persp", focal_length=0.8)
    axes.view_init(elev=ELEVATION, azim=AZIMUTH)
    axes.set_xlim(low[0], high[0])
    axes.set_ylim(low[1], high[1])
    axes.set_zlim(low[2], high[2])
    axes.set_box_aspect(high - low, zoom=zoom)
    axes.set_axis_off()
    axes.patch.set_visible(False)


def _floor(axes: Axes3D, low: Array, high: Array, step: float) -> None:
    """A grid of squares of `step` below the tube."""
    for x in np.arange(np.ceil(low[0] / step) * step, high[0], step):
        axes.plot([x, x], [low[1], high[1]], low[2], color=GRID, linewidth=0.8, zorder=0)
    for y in np.arange(np.ceil(low[1] / step) * step, high[1], step):
        axes.plot([low[0], high[0]], [y, y], low[2], color=GRID, linewidth=0.8, zorder=0)
