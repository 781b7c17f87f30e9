"""Contact points: samples of the centreline with a spacing of their own, on cubic arcs through the nodes.

Nodes are not contact points: where they lie wider apart than the standoff, the rod would pass through itself. The
arc from node j to j + 1 is the cubic Hermite arc with the slopes (r_j+1 - r_j-1)/2 and (r_j+2 - r_j)/2 by node (Catmull
& Rom 1974), so a point's place, tangent and velocity are fixed combinations of those of four neighbouring nodes, and a
force on it acts on these nodes with the same weights, whatever the method.
"""

from __future__ import annotations

from math import inf
from typing import NamedTuple

import numpy as np

from solver.arrays import Array
from solver.kernels.kernel import inlined, kernel
from solver.scene.contact import Contact
from solver.scene.rod import Rod

REACH = 4
"""Nodes that a point hangs on."""
ARC = 16
"""Points that lie within one ball of a search."""


class Points(NamedTuple):
    """M points at even arclengths.

    Fixed: `first` (M,), the first of the four nodes a point hangs on; `weights`, `slopes` (M, 4), their shares in its
    position and in its tangent; `mass` (M,), rho_c A in kg/m, or P in N/m^2 where the law is automatic;
    `diameter` (M,); `spacing` (m); `closing` (m), the way from the last point on to the first, infinite but for a
    ring. At the current iterate, lab: `p` position, `t` tangent, `w` velocity, each (M, 3).
    `start` and `checked` (M, 3): positions at the start of the step, and at the last search, and `slack` (M,) how far
    (m) each may go from there. Of a search, for each arc of ARC points: `balls` (arcs, 4), centre and radius of one
    that holds it, and the arcs `near` (arcs,) another.
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
    start: Array
    checked: Array
    slack: Array
    balls: Array
    near: Array
    closing: float = inf

    @classmethod
    def none(cls) -> Points:
        """Those of a scene without contact: one, that meets nobody."""
        (weights, slopes), (mass, diameter) = np.zeros((2, 1, REACH)), np.zeros((2, 1))
        p, t, w, start, checked = np.zeros((5, 1, 3))
        return cls(np.zeros(1, dtype=np.int64), weights, slopes, mass, diameter, 1.0, p, t, w, start, checked,
                   *unsearched(1))  # fmt: skip


@inlined
def neighbours(points: Points, skip: float) -> int:
    """How many points on from one the first is that is `skip` (m) of arc away."""
    return int(np.ceil(skip / points.spacing))


@inlined
def farthest(points: Points, skip: float, a: int) -> int:
    """The last point that is `skip` (m) of arc away from point a also by the way around a ring."""
    around = int(np.ceil(max(skip - points.closing, 0.0) / points.spacing))
    return len(points.p) - 1 - max(around - a, 0)


def contact_points(contact: Contact, rod: Rod, s: Array, closing: float = inf) -> Points:
    """The points of a rod with evenly spaced nodes `s` (n >= 4,); `closing`: see `Points`."""
    count = max(2, round(float(s[-1]) / (contact.spacing or float(s[-1]))) + 1)
    at = np.linspace(0.0, float(s[-1]), count)
    h, last = float(s[1] - s[0]), len(s) - 1
    interval = np.minimum((at / h).astype(np.int64), last - 1)
    first = np.clip(interval - 1, 0, last + 1 - REACH)
    x = at / h - interval
    place = ((1 + 2 * x) * (1 - x) ** 2, x * (1 - x) ** 2, x**2 * (3 - 2 * x), x**2 * (x - 1))
    along = (6 * x * (x - 1), (1 - x) * (1 - 3 * x), 6 * x * (1 - x), x * (3 * x - 2))
    weights, slopes = (_shares(interval, first, last, *hermite) for hermite in (place, along))
    p, t, w, start, checked = (np.zeros((count, 3)) for _ in range(5))
    return Points(first, weights, slopes / h, np.asarray(rod.mass(at)), np.asarray(rod.diameter(at)), float(at[1]),
                  p, t, w, start, checked, *unsearched(count), closing)  # fmt: skip


def unsearched(count: int) -> tuple[Array, Array, Array]:
    """`slack`, `balls` and `near` of `count` points."""
    arcs = -(-count // ARC)
    return np.zeros(count), np.zeros((arcs, 4)), np.zeros(arcs, dtype=np.int64)


def _shares(interval: Array, first: Array, last: int, start: Array, leave: Array, end: Array, arrive: Array) -> Array:
    """Shares (M, 4) of the nodes from `first` on, where those of the interval's ends and of the slopes there are known.

    The derivative by node at a node is central, and of second order at the ends of the rod too.
    """
    shares, rows = np.zeros((len(interval), REACH)), np.arange(len(interval))
    for node, own, slope in ((interval, start, leave), (interval + 1, end, arrive)):
        shares[rows, node - first] += own
        middle = np.clip(node, 1, last - 1)  # at x = -1, 0 or 1 from the middle of a parabola
        at = node - middle
        for k, part in ((-1, at - 0.5), (0, -2.0 * at), (1, at + 0.5)):
            shares[rows, middle + k - first] += slope * part
    return shares


@inlined
def square_between(p: Array, a: int, b: int) -> float:
    """The square of the distance of rows a and b of p (M, >= 3)."""
    x, y, z = p[a, 0] - p[b, 0], p[a, 1] - p[b, 1], p[a, 2] - p[b, 2]
    return x * x + y * y + z * z  # type: ignore[no-any-return]


@inlined
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


@inlined
def move_point(points: Points, i: int, nodes: Array, moved: Array) -> None:
    """Write the change of p of point i into the first columns of `moved`, from those of the nodes (n, 3)."""
    first, w = points.first[i], points.weights
    for k in range(3):
        moved[i, k] = (w[i, 0] * nodes[first, k] + w[i, 1] * nodes[first + 1, k] + w[i, 2] * nodes[first + 2, k]
                       + w[i, 3] * nodes[first + 3, k])  # fmt: skip


@inlined
def turn_point(points: Points, i: int, nodes: Array, moved: Array) -> None:
    """Write the change of t of point i into the next columns of `moved`, from those of the nodes (n, 3)."""
    first, w = points.first[i], points.slopes
    for k in range(3):
        moved[i, 3 + k] = (w[i, 0] * nodes[first, k] + w[i, 1] * nodes[first + 1, k] + w[i, 2] * nodes[first + 2, k]
                           + w[i, 3] * nodes[first + 3, k])  # fmt: skip


@kernel
def place_points(points: Points, r: Array, velocity: Array) -> None:
    """Place all points."""
    for i in range(len(points.p)):
        place_point(points, i, r, velocity)
