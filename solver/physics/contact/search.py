"""Which pairs of points may touch, and when nobody need look.

Three proofs, each cheaper than the next search: an arc of length l and total curvature K has a chord of at least
l cos(K/2) (Schur), so while the rod's total curvature is small no pair can be near, and while that of every arc of some
length is, no pair can that is so near along the rod; neighbouring points are at most
`longest_spacing` apart, so a search marches by (d - radius) / longest_spacing points, first from arc to arc of ARC
points, each within a ball, as in a coil all points are near; and a gap once measured holds until somebody has moved by
half of it.
"""

from __future__ import annotations

from math import acos
from typing import NamedTuple

import numpy as np

from solver.arrays import Array
from solver.kernels.kernel import inlined, inner, kernel
from solver.physics.contact.law import Law
from solver.physics.contact.members import Members, dismiss, take_in
from solver.physics.contact.points import ARC, Points, farthest, neighbours


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


@kernel
def straight_arc(r: Array, bending: float) -> float:
    """How long an arc, in intervals between the nodes at `r` (n, 3), bends by at most `bending` (rad), wherever along
    the rod it lies; where that is none from node to node, within an interval."""
    bent, first, fewest = 0.0, 0, len(r) - 1
    for last in range(len(r) - 1):
        bent += _bend(r, last)
        while bent > bending:
            fewest = min(fewest, last - first)
            bent -= _bend(r, first)
            first += 1
    if fewest > 1:
        return fewest - 1.0  # an arc that lies between nodes is part of one interval more
    return min(bending / _sharpest(r), 1.0)


@kernel
def most_bent(r: Array, arc: float) -> float:
    """The largest bending (rad) of an arc so long, in intervals between the nodes at `r` (n, 3): one, or less, or so
    many."""
    if arc < 1.0:
        return _sharpest(r) * arc
    bent, largest, many = 0.0, 0.0, int(arc + 0.5) + 1
    for last in range(len(r) - 1):
        bent += _bend(r, last)
        if last >= many:
            bent -= _bend(r, last - many)
        largest = max(largest, bent)
    return largest


@inner
def _sharpest(r: Array) -> float:
    """The largest curvature (rad for each interval) of the curve through the nodes at `r` (n, 3), wherever it is.

    No more than 3.2 x / cos(x/2), times the longest chord by the shortest, for an angle x between the chords at a node:
    of 40,000 intervals that were drawn, with a smaller angle at their other node, it is 3 x where x is small, 3.4 x at
    1.2, 5.3 x at 2.2.
    """
    x, shortest, longest = 0.0, np.inf, 0.0
    for i in range(len(r)):
        x = max(x, _angle(r, i))
        if i > 0:
            chord = _distance(r, i, i - 1)
            shortest, longest = min(shortest, chord), max(longest, chord)
    return 3.2 * x / np.cos(0.5 * x) * longest / shortest  # type: ignore[no-any-return]


@inner
def _bend(r: Array, i: int) -> float:
    """The bending (rad) of the arc from node i to the next: half of the angles of the chords at both."""
    return 0.5 * (_angle(r, i) + _angle(r, i + 1))


@inlined
def _angle(r: Array, i: int) -> float:
    """The angle (rad) between the chords at node i; none at the ends."""
    if i == 0 or i == len(r) - 1:
        return 0.0
    before, after, square = _distance(r, i, i - 1), _distance(r, i + 1, i), 0.0
    for k in range(3):
        square += ((r[i + 1, k] - r[i, k]) / after - (r[i, k] - r[i - 1, k]) / before) ** 2
    return 2.0 * np.arcsin(min(0.5 * np.sqrt(square), 1.0))  # type: ignore[no-any-return]


@inner
def longest_spacing(points: Points) -> float:
    """The largest distance (m) of two neighbours: how far apart one point farther along may be, at the most."""
    longest = 0.0
    for i in range(len(points.p) - 1):
        longest = max(longest, _distance(points.p, i + 1, i))
    return longest


@inlined
def _distance(p: Array, a: int, b: int) -> float:
    x, y, z = p[a, 0] - p[b, 0], p[a, 1] - p[b, 1], p[a, 2] - p[b, 2]
    return np.sqrt(x * x + y * y + z * z)  # type: ignore[no-any-return]


@inner
def _enclose(points: Points) -> float:
    """Write the balls around the arcs. Returns the largest radius (m)."""
    p, balls, last, largest = points.p, points.balls, len(points.p) - 1, 0.0
    for arc in range(len(balls)):
        first, radius = ARC * arc, 0.0
        middle = min(first + ARC // 2, last)
        for i in range(first, min(first + ARC, last + 1)):
            radius = max(radius, _distance(p, i, middle))
        balls[arc, 0], balls[arc, 1], balls[arc, 2], balls[arc, 3] = p[middle, 0], p[middle, 1], p[middle, 2], radius
        largest = max(largest, radius)
    return largest


@kernel
def smallest_distance(points: Points, skip: float, enough: float, part: float) -> float:
    """The smallest distance (m) of two points more than `skip` of arc apart, or `enough` if none are nearer; less a
    `part` of their diameters, by half of which their surfaces are nearer."""
    largest, pitch, widest = _enclose(points), longest_spacing(points), 0.0
    for i in range(len(points.p)):
        widest = max(widest, 2.0 * part * points.diameter[i])
    apart, best = neighbours(points, skip), enough
    for one in range(len(points.balls)):
        other = len(points.balls) - 1  # from the far end, so that a rod that is not folded is passed in one leap
        while other >= one:
            d = _distance(points.balls, one, other) - points.balls[one, 3]
            if d - points.balls[other, 3] - widest >= best:
                other -= max(1, int((d - largest - widest - best) / (ARC * pitch)))
                continue
            for a in range(ARC * one, min(ARC * (one + 1), len(points.p))):
                b = min(farthest(points, skip, a), ARC * (other + 1) - 1)
                while b >= max(a + apart, ARC * other):
                    d = _distance(points.p, a, b)
                    best = min(best, d - part * (points.diameter[a] + points.diameter[b]))
                    b -= max(1, int((d - widest - best) / pitch))
            other -= 1
    return best


@kernel
def largest_displacement(p: Array, since: Array) -> float:
    """How far (m) some point, or node, at p (n, >= 3) has moved since they lay at `since` (n, 3); of velocities, since
    0, the largest (m/s)."""
    largest = 0.0
    for i in range(len(since)):
        square = _between(p, since, i)
        largest = max(largest, square)
    return float(np.sqrt(largest))


@kernel
def foresee(w: Array, whole: Array, slack: Array, steps: float, least: float, most: float) -> None:
    """Let each point go as far as it comes within `steps` (s) at its velocity w (M, 3) less that of the rod as a
    `whole` there, but at `least` and at the `most` (m)."""
    for i in range(len(slack)):
        slack[i] = min(max(steps * np.sqrt(_between(w, whole, i)), least), most)


@kernel
def used(p: Array, checked: Array, slack: Array) -> float:
    """The largest part of its `slack` (M,) that a point at p (M, 3) has used up since it was `checked` (M, 3); of
    velocities, since 0, the largest that one uses up in a second."""
    largest = 0.0
    for i in range(len(slack)):
        square = _between(p, checked, i)
        largest = max(largest, square / slack[i] ** 2)
    return float(np.sqrt(largest))


@inlined
def _between(p: Array, q: Array, i: int) -> float:
    x, y, z = p[i, 0] - q[i, 0], p[i, 1] - q[i, 1], p[i, 2] - q[i, 2]
    return x * x + y * y + z * z  # type: ignore[no-any-return]


@kernel
def find_pairs(points: Points, skip: float, reach: float, pairs: Pairs) -> None:
    """List the pairs that may come nearer than `reach` by using up their slack; counts[1] says how many did not fit."""
    pitch, apart = longest_spacing(points), neighbours(points, skip)
    _enclose(points)
    largest, widest = _widen(points)
    count = 0
    for arc in range(len(points.balls)):
        near = _arcs_near(points, arc, reach, largest, ARC * pitch)
        for a in range(ARC * arc, min(ARC * (arc + 1), len(points.p))):
            radius = reach + points.slack[a]
            for k in range(near):
                b = min(farthest(points, skip, a), ARC * (points.near[k] + 1) - 1)
                while b >= max(a + apart, ARC * points.near[k]):
                    d = _distance(points.p, a, b)
                    if d < radius + points.slack[b]:
                        if count < len(pairs.first):
                            pairs.first[count] = a
                            pairs.second[count] = b
                        count += 1
                        b -= 1
                    else:
                        b -= max(1, int((d - radius - widest) / pitch))
    pairs.counts[0] = min(count, len(pairs.first))
    pairs.counts[1] = count - pairs.counts[0]
    dismiss(pairs.members)
    for pair in range(pairs.counts[0]):
        take_in(pairs.members, points, pairs.first[pair])
        take_in(pairs.members, points, pairs.second[pair])


@inner
def _widen(points: Points) -> tuple[float, float]:
    """Have each ball hold also where its points may go. Returns the largest radius (m), and the largest slack (m)."""
    largest, widest = 0.0, 0.0
    for arc in range(len(points.balls)):
        most = 0.0
        for i in range(ARC * arc, min(ARC * (arc + 1), len(points.p))):
            most = max(most, points.slack[i])
        points.balls[arc, 3] += most
        largest, widest = max(largest, points.balls[arc, 3]), max(widest, most)
    return largest, widest


@inner
def _arcs_near(points: Points, one: int, radius: float, largest: float, pitch: float) -> int:
    """List the arcs from `one` on of which a point may be nearer to one of its points than `radius`, the last first.
    `largest` radius of a ball, `pitch` of two neighbours' centres, at the most."""
    many, other = 0, len(points.balls) - 1
    while other >= one:
        d = _distance(points.balls, one, other) - points.balls[one, 3]
        if d - points.balls[other, 3] < radius:
            points.near[many] = other
            many += 1
            other -= 1
        else:
            other -= max(1, int((d - largest - radius) / pitch))
    return many
