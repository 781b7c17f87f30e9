"""Whether a rod passed through itself between two states: pairs of intervals that met on the way.

Four points are in one plane where the volume that they span vanishes. Between two states that is sought with every
point on a straight path; two intervals have crossed if they meet at that moment. Those of a coarse mesh are divided
first, along cubic arcs: where a rod turns back within an interval, straight ones meet and the rod does not. It shares
nothing with the solver's contact search.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicHermiteSpline

Array = NDArray[np.float64]
HALVINGS = 40
MEETING = 1e-6
"""In interval lengths: distance at which intervals meet."""
MOST = 100
"""Intervals looked at: of a finer mesh, several in one; of a coarser one, parts."""


class Crossings:
    """Watches the nodes (n, 3) of a rod; intervals nearer than `skip` (m) of arc along it are passed over."""

    def __init__(self, length: float, skip: float) -> None:
        self._length, self._skip = length, skip
        self._before: Array | None = None
        self._pairs: tuple[NDArray[np.int64], NDArray[np.int64]] | None = None

    def passed(self, r: Array) -> bool:
        """Whether an interval passed through another one since the last call."""
        r = _arcs(r[:: -(-(len(r) - 1) // MOST)])
        before, self._before = self._before, r
        if before is None:
            return False
        i, j = self._all_pairs(len(r) - 1)
        start, end = _corners(before, i, j), _corners(r, i, j)
        suspects = _volume(start) * _volume(end) < 0.0
        if not suspects.any():
            return False
        meeting = _at_zero_volume(start[:, suspects], end[:, suspects])
        return bool(_intersect(meeting, self._length / (len(r) - 1)).any())

    def _all_pairs(self, intervals: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        if self._pairs is None:
            apart = 1 + int(np.ceil(self._skip * intervals / self._length))
            self._pairs = np.triu_indices(intervals, max(apart, 2))
        return self._pairs


def _arcs(r: Array) -> Array:
    """Up to MOST intervals along cubic Hermite arcs through `r`, with central slopes."""
    nodes, parts = np.arange(len(r)), max(MOST // (len(r) - 1), 1)
    between = np.linspace(0.0, len(r) - 1, parts * (len(r) - 1) + 1)
    return np.asarray(CubicHermiteSpline(nodes, r, np.gradient(r, axis=0, edge_order=2))(between))


def _corners(r: Array, i: NDArray[np.int64], j: NDArray[np.int64]) -> Array:
    """The four ends (4, pairs, 3) of the intervals i and j."""
    return np.stack([r[i], r[i + 1], r[j], r[j + 1]])


def _volume(corners: Array) -> Array:
    a, b, c, d = corners
    return np.asarray(np.einsum("ni,ni->n", np.cross(b - a, d - c), c - a))


def _at_zero_volume(start: Array, end: Array) -> Array:
    """The corners where the volume vanishes on straight paths, by bisection."""
    low, high = np.zeros(start.shape[1]), np.ones(start.shape[1])
    sign = np.sign(_volume(start))
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        same = np.sign(_volume(start + middle[:, None] * (end - start))) == sign
        low, high = np.where(same, middle, low), np.where(same, high, middle)
    return np.asarray(start + low[:, None] * (end - start))


def _intersect(corners: Array, ds: float) -> NDArray[np.bool_]:
    """Whether pairs of coplanar intervals (4, pairs, 3) meet."""
    a, b, c, d = corners
    u, w, between = b - a, d - c, c - a
    uu, ww, uw = (np.einsum("ni,ni->n", x, y) for x, y in ((u, u), (w, w), (u, w)))
    square = uu * ww - uw * uw
    square = np.where(square > 1e-12 * uu * ww, square, np.inf)  # parallel ones meet only by chance
    bu, bw = np.einsum("ni,ni->n", between, u), np.einsum("ni,ni->n", between, w)
    x, y = (bu * ww - bw * uw) / square, (bu * uw - bw * uu) / square
    apart = np.linalg.norm(a + x[:, None] * u - c - y[:, None] * w, axis=1)
    return np.asarray((x >= 0) & (x <= 1) & (y >= 0) & (y <= 1) & (apart < MEETING * ds) & np.isfinite(square))
