"""Which pairs of points may touch, and when nobody need look.

Three proofs, each cheaper than the next search: an arc of length l and total curvature K has a chord of at least
l cos(K/2) (Schur), so while the rod's total curvature is small no pair can be near; neighbouring points are at most
`longest_spacing` apart, so a search marches by (d - radius) / longest_spacing points; and a gap once measured holds
until somebody has moved by half of it.
"""

from __future__ import annotations

from math import acos
from typing import NamedTuple

import numpy as np

from solver.arrays import Array
from solver.kernels.kernel import inlined, inner, kernel
from solver.physics.contact.law import Law
from solver.physics.contact.members import Members, dismiss, take_in
from solver.physics.contact.points import Points, farthest, neighbours


class Pairs(NamedTuple):
    """Pairs of points that may touch, until the next search.

    `counts` (2,): pairs that are listed, and that did not fit; `first`, `second` (capacity,) their points; `members`
    that take part.
    """

    counts: Array
    first: Array
    second: Array
    members: Members

    @classmethod
    def empty(cls, capacity: int, points: int, nodes: int) -> Pairs:
        """No pairs, with room for `capacity`."""
        return cls(np.zeros(2, np.int64), np.zeros(capacity, np.int64), np.zeros(capacity, np.int64),
                   Members.none(points, nodes))  # fmt: skip


def harmless_bending(distance: float, law: Law) -> float:
    """The total curvature (rad) below which all pairs more than law.skip of arc apart are beyond `distance` (m)."""
    return 2.0 * acos(distance / law.skip) if distance < law.skip else 0.0


@inner
def longest_spacing(points: Points) -> float:
    """The largest distance (m) of two neighbours: how far apart one point farther along may be, at the most."""
    longest = 0.0
    for i in range(len(points.p) - 1):
        longest = max(longest, _distance(points, i + 1, i))
    return longest


@inlined
def _distance(points: Points, a: int, b: int) -> float:
    x, y, z = points.p[a, 0] - points.p[b, 0], points.p[a, 1] - points.p[b, 1], points.p[a, 2] - points.p[b, 2]
    return np.sqrt(x * x + y * y + z * z)  # type: ignore[no-any-return]


@kernel
def smallest_distance(points: Points, skip: float, enough: float) -> float:
    """The smallest distance (m) of two points more than `skip` of arc apart, or `enough` if none are nearer."""
    M, pitch = len(points.p), longest_spacing(points)
    apart = neighbours(points, skip)
    best = enough
    for a in range(M):
        b = farthest(points, skip, a)  # from the far end, so that a rod that is not folded is passed in one leap
        while b >= a + apart:
            d = _distance(points, a, b)
            if d < best:
                best = d
            b -= max(1, int((d - best) / pitch))
    return best


@kernel
def smallest_gap(points: Points, skip: float) -> float:
    """The smallest distance (m) of the surfaces at two points more than `skip` of arc apart; inf if there are none."""
    M, pitch, widest = len(points.p), longest_spacing(points), 0.0
    for i in range(M):
        widest = max(widest, points.diameter[i])
    apart = neighbours(points, skip)
    best = np.inf
    for a in range(M):
        b = farthest(points, skip, a)
        while b >= a + apart:
            d = _distance(points, a, b)
            best = min(best, d - 0.5 * (points.diameter[a] + points.diameter[b]))
            b -= max(1, int((d - widest - best) / pitch))
    return best


@kernel
def largest_displacement(points: Points, since: Array) -> float:
    """How far (m) some point has moved since the points lay at `since` (M, 3)."""
    largest = 0.0
    for i in range(len(points.p)):
        square = 0.0
        for k in range(3):
            square += (points.p[i, k] - since[i, k]) ** 2
        largest = max(largest, square)
    return float(np.sqrt(largest))


@kernel
def find_pairs(points: Points, skip: float, radius: float, pairs: Pairs) -> None:
    """List the pairs nearer than `radius`; counts[1] says how many did not fit."""
    M, pitch = len(points.p), longest_spacing(points)
    apart = neighbours(points, skip)
    count = 0
    for a in range(M):
        b = farthest(points, skip, a)
        while b >= a + apart:
            d = _distance(points, a, b)
            if d < radius:
                if count < len(pairs.first):
                    pairs.first[count] = a
                    pairs.second[count] = b
                count += 1
                b -= 1
            else:
                b -= max(1, int((d - radius) / pitch))
    pairs.counts[0] = min(count, len(pairs.first))
    pairs.counts[1] = count - pairs.counts[0]
    dismiss(pairs.members)
    for pair in range(pairs.counts[0]):
        take_in(pairs.members, points, pairs.first[pair])
        take_in(pairs.members, points, pairs.second[pair])
