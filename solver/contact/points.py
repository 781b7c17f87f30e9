"""Contact points: samples of the centreline with a spacing of their own, on cubic arcs through the nodes.

Nodes are not contact points: where they lie wider apart than the standoff, the rod would pass through itself. The
arc from node j to j + 1 is the cubic Hermite arc with the slopes (r_j+1 - r_j-1)/2 and (r_j+2 - r_j)/2 by node (Catmull
& Rom 1974), so a point's place, tangent and velocity are fixed combinations of those of four neighbouring nodes, and a
force on it acts on these nodes with the same weights, whatever the method.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from solver.kernel import kernel
from solver.rod import Array, Rod
from solver.scene import Contact

REACH = 4
"""Nodes that a point hangs on."""


class Points(NamedTuple):
    """M points at even arclengths.

    Fixed: `first` (M,), the first of the four nodes a point hangs on; `weights`, `slopes` (M, 4), their shares in its
    position and in its tangent; `mass` rho_c A and `diameter` (M,); `spacing` (m). At the current iterate, lab: `p`
    position, `t` tangent, `w` velocity, each (M, 3). `checked` (M, 3): positions at the last search.
    """

    first: Array
    weights: Array
    slopes: Array
    mass: Array
    diameter: Array
    spacing: float
    p: Array
    t: Array
    w: Array
    checked: Array


def contact_points(contact: Contact, rod: Rod, s: Array) -> Points:
    """The points of a rod with evenly spaced nodes `s` (n >= 4,)."""
    count = max(2, round(float(s[-1]) / contact.spacing) + 1)
    at = np.linspace(0.0, float(s[-1]), count)
    h, last = float(s[1] - s[0]), len(s) - 1
    interval = np.minimum((at / h).astype(np.int64), last - 1)
    first = np.clip(interval - 1, 0, last + 1 - REACH)
    weights, slopes = np.zeros((count, REACH)), np.zeros((count, REACH))
    for i, (j, x) in enumerate(zip(interval, at / h - interval, strict=True)):
        place = ((1 + 2 * x) * (1 - x) ** 2, x * (1 - x) ** 2, x**2 * (3 - 2 * x), x**2 * (x - 1))
        along = (6 * x * (x - 1), (1 - x) * (1 - 3 * x), 6 * x * (1 - x), x * (3 * x - 2))
        for row, (start, leave, end, arrive) in ((weights[i], place), (slopes[i], along)):
            row[j - first[i]] += start
            row[j + 1 - first[i]] += end
            for node, share in ((j, leave), (j + 1, arrive)):
                for k, part in _slope_at(int(node), last):
                    row[k - first[i]] += share * part
    vectors = [np.zeros((count, 3)) for _ in range(4)]
    return Points(first, weights, slopes / h, np.asarray(rod.mass(at)), np.asarray(rod.diameter(at)), float(at[1]),
                  *vectors)  # fmt: skip


def _slope_at(node: int, last: int) -> tuple[tuple[int, float], ...]:
    """Nodes and their shares in the derivative by node at a node: central, of second order at the ends too."""
    if node == 0:
        return ((0, -1.5), (1, 2.0), (2, -0.5))
    if node == last:
        return ((last, 1.5), (last - 1, -2.0), (last - 2, 0.5))
    return ((node - 1, -0.5), (node + 1, 0.5))


@kernel
def place_point(points: Points, i: int, r: Array, velocity: Array) -> None:
    """Write p, t and w of point i from the nodes' positions (n, 3) and lab velocities (n, >= 3)."""
    for k in range(3):
        place, along, speed = 0.0, 0.0, 0.0
        for m in range(REACH):
            node = points.first[i] + m
            place += points.weights[i, m] * r[node, k]
            along += points.slopes[i, m] * r[node, k]
            speed += points.weights[i, m] * velocity[node, k]
        points.p[i, k], points.t[i, k], points.w[i, k] = place, along, speed


@kernel
def place_points(points: Points, r: Array, velocity: Array) -> None:
    """Place all points."""
    for i in range(len(points.p)):
        place_point(points, i, r, velocity)
