"""Parts of a rod, and what a property that varies along the rod counts for in them.

Where a property is smooth its value in the middle counts, by which a mesh is right to second order. What lies between
is not seen there, as a load on a hundredth of the rod, or a step: in cells with corners the mean counts, unless the
property is near the parabola through its values at the start, in the middle and at the end.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from solver.arrays import Array
from solver.scene.rod import Profile

POINTS, WEIGHTS = np.array([0.5 - 0.15**0.5, 0.5, 0.5 + 0.15**0.5]), np.array([5.0, 8.0, 5.0]) / 18.0
"""Gauss's, of a part of length 1."""
APART = 1e-9
"""Part of a cell within which a corner is on its edge."""
SMOOTH = 0.01
"""Part of its largest value by which a property that is smooth in a cell may be beside that parabola."""

NOWHERE = (np.zeros(0), np.zeros(0), np.zeros(0), np.zeros(0, np.int64), np.zeros(0, np.int64))
"""What there is besides own points where no cell is crossed."""


class Cells(NamedTuple):
    """n parts of a rod, of which k are `crossed` (k,) by corners.

    `points`: where properties are looked at: at the cells' own (n,), within the crossed cells at m of Gauss's, and at
    their starts, middles and ends (k,) each; their `offsets` from the own point of their cell. Of Gauss's: `within`
    (m,), the part of the crossed cell before them; `weights` (m,), which sum to 1 in each cell, whose points are those
    from number `first` (k,) on.
    """

    points: Array
    offsets: Array
    within: Array
    weights: Array
    first: NDArray[np.int64]
    crossed: NDArray[np.int64]

    @classmethod
    def at(cls, s: Array, edges: Array, corners: Sequence[float]) -> Cells:
        """Those of own points `s` (n,) between `edges` (n + 1,), for properties that are smooth between `corners`."""
        if not corners:
            return cls(s, *NOWHERE)
        lengths = np.diff(edges)
        inside = np.array([corner for corner in corners if edges[0] < corner < edges[-1]])
        cell = np.searchsorted(edges, inside, side="right") - 1
        beside = np.minimum(inside - edges[cell], edges[cell + 1] - inside) <= APART * lengths[cell]
        inside, crossed = inside[~beside], np.unique(cell[~beside])
        starts, ends = edges[crossed], edges[crossed + 1]
        cuts = np.union1d(np.union1d(starts, ends), inside)
        parts, cell = np.diff(cuts), np.searchsorted(edges, cuts[:-1] + APART * lengths.min(), side="right") - 1
        here = np.isin(cell, crossed)  # not what lies between two crossed cells
        cuts, parts, cell = cuts[:-1][here], parts[here], cell[here]
        points = cuts[:, None] + np.outer(parts, POINTS)
        within = (points - edges[cell][:, None]) / lengths[cell][:, None]
        looked_at = np.concatenate([s, points.ravel(), starts, 0.5 * (starts + ends), ends])
        own = np.concatenate([s, np.repeat(s[cell], len(POINTS)), np.tile(s[crossed], 3)])
        first = len(POINTS) * np.searchsorted(cell, crossed)
        weights = np.outer(parts / lengths[cell], WEIGHTS)
        return cls(looked_at, looked_at - own, within.ravel(), weights.ravel(), first, crossed)

    def mean(self, values: Array) -> Array:
        """What `values` (points, ...) count for in the cells (n, ...)."""
        m, k = len(self.weights), len(self.crossed)
        n = len(self.points) - m - 3 * k
        counted = np.array(values[:n], dtype=float)
        if k == 0:
            return counted
        inside, at_three = values[n : n + m].reshape(m, -1), values[n + m :].reshape(3, k, -1)
        mean = np.add.reduceat(self.weights[:, None] * inside, self.first)
        u, many = self.within, np.diff(self.first, append=m)
        through = np.array([(1.0 - u) * (1.0 - 2.0 * u), 4.0 * u * (1.0 - u), u * (2.0 * u - 1.0)])
        off = np.abs(inside - np.einsum("pm,pmc->mc", through, np.repeat(at_three, many, axis=1))).max(axis=1)
        steps = np.maximum.reduceat(off - SMOOTH * np.abs(inside).max(axis=1), self.first) > 0.0
        counted[self.crossed[steps]] = mean[steps].reshape(-1, *values.shape[1:])
        return counted

    def mean_of(self, profile: Profile) -> Array:
        """What a property counts for in the cells (n,)."""
        return self.mean(np.asarray(profile(self.points), dtype=float))

    def arms_of(self, profile: Profile) -> Array:
        """How far (n,) from their own points a density acts in the cells, times its mean."""
        if len(self.crossed) == 0:
            return np.zeros(len(self.points))
        return self.mean(np.asarray(profile(self.points), dtype=float) * self.offsets)

    def placed_mean_of(self, profile: Profile, lengths: Array, apart: float) -> Array:
        """What a property counts for in cells of `lengths` (n,), so that its place counts too.

        What lies beside a cell's own point is shared with the next one, `apart` from it, as hat functions share it.
        """
        means, arms = self.mean_of(profile), self.arms_of(profile)
        passed, onwards = arms * lengths / apart, means * arms >= 0.0
        onwards[0], onwards[-1] = True, False
        ahead, back = np.where(onwards, passed, 0.0), np.where(onwards, 0.0, -passed)
        placed = means * lengths - ahead - back
        placed[1:] += ahead[:-1]
        placed[:-1] += back[1:]
        return np.asarray(placed / lengths)


def around_nodes(s: Array, corners: Sequence[float]) -> Cells:
    """Those that nodes `s` (n,) stand for: up to halfway to the next."""
    return Cells.at(s, np.concatenate([s[:1], 0.5 * (s[1:] + s[:-1]), s[-1:]]), corners)


def between_nodes(s: Array, corners: Sequence[float]) -> Cells:
    """The intervals between nodes `s` (n + 1,)."""
    return Cells.at(0.5 * (s[1:] + s[:-1]), s, corners)
