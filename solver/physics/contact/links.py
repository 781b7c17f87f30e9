"""Whether strands slipped through each other between their contact points.

The points keep the rod apart where they are. Between them it is taken for straight links, from each point to the next.
Two links whose ends move on straight paths cannot have met in a step if they are farther apart after it than any end of
the one has moved relative to an end of the other: all other relative motions lie between these.
"""

from __future__ import annotations

import numpy as np

from solver.arrays import Array
from solver.kernels.kernel import kernel
from solver.physics.contact.points import Points
from solver.physics.contact.search import Pairs, largest_displacement, longest_spacing

SLIPPED = 0.25
"""In D: links nearer than that are within each other. The force has its pole at D/2."""


def links_reach(points: Points) -> float:
    """How near (m) two points must be for the links that begin at them to be looked at.

    Twice the length of a link beyond SLIPPED D, and one more spacing for links that are longer than the arc is spaced.
    """
    return SLIPPED * float(points.diameter.max()) + 3.0 * points.spacing


@kernel
def link_distance(p: Array, a: int, b: int) -> float:
    """The distance (m) of the straight links from point a to a + 1 and from b to b + 1 of p (M, 3)."""
    uu, vv, uv, du, dv, dd = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for k in range(3):
        u, v, d = p[a + 1, k] - p[a, k], p[b + 1, k] - p[b, k], p[a, k] - p[b, k]
        uu, vv, uv, du, dv, dd = uu + u * u, vv + v * v, uv + u * v, du + d * u, dv + d * v, dd + d * d
    square = uu * vv - uv * uv
    # the nearest place on the first line, then on the second link, then on the first link
    x = min(max((uv * dv - du * vv) / square, 0.0), 1.0) if square > 1e-12 * uu * vv else 0.0
    y = min(max((dv + uv * x) / vv, 0.0), 1.0)
    x = min(max((uv * y - du) / uu, 0.0), 1.0)
    apart = dd + x * (x * uu + 2.0 * du) + y * (y * vv - 2.0 * dv) - 2.0 * x * y * uv
    return float(np.sqrt(max(apart, 0.0)))


@kernel
def links_meet(points: Points, pairs: Pairs) -> bool:
    """Whether two links that begin at a listed pair may have met in the step, or are within each other.

    Those with no more than D of the rod between them are neighbours, and do not count.
    """
    M, pitch = len(points.p), longest_spacing(points)
    moved = largest_displacement(points.p, points.start)
    for pair in range(pairs.counts[0]):
        a, b = pairs.first[pair], pairs.second[pair]
        D = 0.5 * (points.diameter[a] + points.diameter[b])
        if b + 1 == M or (b - a - 1) * points.spacing <= D:
            continue
        x, y, z = points.p[a, 0] - points.p[b, 0], points.p[a, 1] - points.p[b, 1], points.p[a, 2] - points.p[b, 2]
        near = max(SLIPPED * D, 2.0 * moved) + 2.0 * pitch
        if x * x + y * y + z * z > near * near:  # most pairs
            continue
        relative = 0.0
        for i in range(a, a + 2):
            for j in range(b, b + 2):
                square = 0.0
                for k in range(3):
                    square += (points.p[i, k] - points.p[j, k] - points.start[i, k] + points.start[j, k]) ** 2
                relative = max(relative, square)
        if link_distance(points.p, a, b) <= max(SLIPPED * D, np.sqrt(relative)):
            return True
    return False
