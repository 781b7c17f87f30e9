"""Rods drawn as shaded tubes in 3-D, to one scale, with equal axes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d.art3d import Poly3DCollection  # type: ignore[import-untyped]
from mpl_toolkits.mplot3d.axes3d import Axes3D  # type: ignore[import-untyped]
from numpy.typing import NDArray

Array = NDArray[np.float64]

FACETS = 16
MOST_RINGS = 400
THICKNESS = 0.005
"""The tube's radius as a fraction of the shapes' extent."""

BODY, STRIPE = np.array([0.93, 0.62, 0.20]), np.array([0.13, 0.22, 0.42])
LIGHT = np.array([-0.35, -0.55, 0.76])
ELEVATION, AZIMUTH = 18.0, -62.0
PANEL = 5.5
"""Width of a panel in inches."""

ZOOM = 1.0
"""Brings the box to the width of its panel, in the units of matplotlib's own zoom."""


@dataclass(frozen=True)
class Tube:
    """A centreline `r` (n, 3) and the section's axes `a1`, `a2` (n, 3) along it, lab frame."""

    r: Array
    a1: Array
    a2: Array

    @classmethod
    def of(cls, r: Array, quaternion: Array) -> Self:
        """From positions (n, 3) and unit quaternions (n, 4), thinned out to what can be seen."""
        step = max(1, len(r) // MOST_RINGS)
        w, x, y, z = quaternion[::step].T
        a1 = np.stack([1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)], axis=1)
        a2 = np.stack([2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)], axis=1)
        return cls(r[::step], a1, a2)

    def turned(self, axes: Array) -> Self:
        """The same tube in other axes, the rows of `axes` (3, 3)."""
        return type(self)(self.r @ axes.T, self.a1 @ axes.T, self.a2 @ axes.T)

    def facets(self, radius: float) -> tuple[Array, Array]:
        """Quadrilaterals (m, 4, 3) of the surface and their colours (m, 3): lit, with a stripe along a1."""
        angle = np.arange(FACETS + 1) * 2 * np.pi / FACETS
        normal = np.cos(angle)[:, None] * self.a1[:, None, :] + np.sin(angle)[:, None] * self.a2[:, None, :]
        ring = self.r[:, None, :] + radius * normal
        quads = np.stack([ring[:-1, :-1], ring[1:, :-1], ring[1:, 1:], ring[:-1, 1:]], axis=2)
        outward = normal[:-1, :-1] + normal[1:, 1:]
        outward /= np.linalg.norm(outward, axis=2)[:, :, None]
        light = 0.45 + 0.55 * np.clip(outward @ LIGHT, 0.0, 1.0)
        striped = (np.arange(FACETS) < FACETS // 4)[None, :, None]
        colours = np.where(striped, STRIPE, BODY) * light[:, :, None]
        return quads.reshape(-1, 4, 3), np.clip(colours, 0.0, 1.0).reshape(-1, 3)


UPRIGHT = np.eye(3)
PAPERS = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
"""The paper's view: e3 to the right, e1 downward."""

STEPS = (0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0)


def draw_tubes(tubes: Sequence[Tube], titles: Sequence[str], upright: bool) -> Figure:
    """Draw four tubes to one scale over a grid, e3 up if `upright`, otherwise to the right with e1 down."""
    view, told = (UPRIGHT, "e1 to the right, e3 up") if upright else (PAPERS, "e3 to the right, e1 down")
    turned = [tube.turned(view) for tube in tubes]
    points = np.vstack([tube.r for tube in turned])
    extent = float(np.ptp(points, axis=0).max())
    step = next((step for step in STEPS if extent / step <= 12), STEPS[-1])
    low, high = _box(points, extent)
    width, height = _seen(high - low)
    row = PANEL * min(1.0, height / width) + 0.3
    figure = Figure(figsize=(2 * PANEL, 2 * row + 1.0), facecolor="white")
    for i, (tube, title) in enumerate(zip(turned, titles, strict=True)):
        top = 1.0 - (0.5 + (i // 2) * row) / figure.get_figheight()
        axes = _panel(figure, 0.5 * (i % 2), top, row)
        _prepare(axes, low, high, ZOOM * float(np.linalg.norm(high - low)) / max(width, height))
        _floor(axes, low, high, step)
        _draw(axes, tube, THICKNESS * extent, float(low[2]))
        figure.text(0.5 * (i % 2) + 0.25, top - 0.01, title, ha="center", va="top", fontsize=11)
    caption = f"grid {step:g} m, {told}; tubes thicker than the rod, stripe along a1"
    figure.text(0.5, 0.02, caption, ha="center", color="#6b7280", fontsize=9)
    return figure


def _panel(figure: Figure, left: float, top: float, row: float) -> Axes3D:
    """Square axes (what 3-D axes are) centred on a row; what is empty in them overlaps the other row."""
    height = figure.get_figheight()
    centre = top - row / 2 / height
    axes: Axes3D = figure.add_axes((left, centre - PANEL / 2 / height, 0.5, PANEL / height), projection="3d")
    return axes


def _draw(axes: Axes3D, tube: Tube, radius: float, floor: float) -> None:
    axes.plot(tube.r[:, 0], tube.r[:, 1], floor, color="#b9c0c9", linewidth=2.2, zorder=1)
    quads, colours = tube.facets(radius)
    surface = Poly3DCollection(list(quads), facecolors=colours, edgecolors=colours, linewidths=0.2, zorder=2)
    axes.add_collection3d(surface)


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
        axes.plot([x, x], [low[1], high[1]], low[2], color="#e3e6ea", linewidth=0.8, zorder=0)
    for y in np.arange(np.ceil(low[1] / step) * step, high[1], step):
        axes.plot([low[0], high[0]], [y, y], low[2], color="#e3e6ea", linewidth=0.8, zorder=0)
