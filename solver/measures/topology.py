"""Writhe of a centreline: the exact Gauss integral of its polygon.

The direction from a point of one straight segment to a point of another sweeps a spherical
quadrilateral; its signed area is the pair's Gauss integral (Klenin & Langowski, Biopolymers 54
(2000) 307, method 1a). With a, b, c, d the vectors from the ends of segment i to the ends of segment j,

    a = r_j - r_i,  b = r_j+1 - r_i,  c = r_j+1 - r_i+1,  d = r_j - r_i+1,

the area is that of the triangles (a, b, c) and (a, c, d), each by the formula of van Oosterom &
Strackee (IEEE Trans. Biomed. Eng. 30 (1983) 125): area / 2 = arg(D + i V), V = a . (b x c),
D = |a||b||c| + (a.b)|c| + (b.c)|a| + (c.a)|b|. Both triangles have the same V, so the pair's area is
2 arg((D1 + i V)(D2 + i V)), free of cancellation however far apart the segments are.
"""

from __future__ import annotations

from math import isnan, pi, sqrt
from typing import Any

import numpy as np

from solver.arrays import Array
from solver.kernels.kernel import allocating, inlined, inner, kernel
from solver.kernels.rotation import tangent_of
from solver.kernels.vectors import Vector, dot, minus, norm, times, vector, vector_product
from solver.measures.shortening import shorten
from solver.measures.spherical import angle, half_area

FLAT = 1e-10
"""Part of its size by which a curve may leave a plane and is taken to lie in it."""
MEET, ALIGNED = 0.02, 0.1
"""Part of the segments beside them within which a curve's ends meet, and the angle (rad) of their tangents within which
it is taken to go on there: a mesh closes no ring better, and the tangents of one that is given by points differ."""
OPEN, KINKED, CLOSED, JOINED = 0, 1, 2, 3
"""Kinds of a curve: with ends apart, with ends that meet at an angle, closed; and closed by a straight line."""
NO_RAYS = np.empty((0, 3))
"""Tangents of a curve that is closed by the straight line from its end to its start, instead of rays at its ends."""
SMALL_TANGENT = 0.1
"""Below it eight terms of the arctangent's series are exact to rounding: 0.1^16 / 17 = 6e-18."""


@allocating
def writhe(r: Array, tangents: Array) -> float:
    """Writhe (turns) of an open polygon continued by straight rays to infinity; or, of NO_RAYS, closed by a line.

    `r` (n >= 2, 3): the vertices, lab frame, m. The rays leave r[0] along -tangents[0] and r[-1] along tangents[1], of
    unit `tangents` (2, 3). Right-handed crossings count positive. Where two parts of the curve touch exactly the writhe
    jumps by 2; of a curve in a plane, where parts of it and rays may cross, the value is that in the middle of the
    jumps, 0. A curve that is smoothly closed, as a ring is, has no rays: they would lie on each other and on the curve.
    NaN in gives NaN out.
    """
    if is_plane(r, tangents):
        return 0.0
    columns, kind = _transposed(r), kind_of(r, tangents)
    if kind == JOINED:
        return -(segment_pairs(columns, False) + _gap(r)) / pi
    if kind != OPEN:
        return -(segment_pairs(columns, True) + _rays(r, tangents)) / pi
    shorter, quarter = shorten(columns, vector(tangents, 0), vector(tangents, 1))
    return -(quarter + (segment_pairs(shorter, False) + _rays(_transposed(shorter), tangents))) / pi


@allocating
def _transposed(a: Array) -> Array:
    """The rows of `a` (n, m) as columns, in memory too."""
    n, m = a.shape
    turned = np.empty((m, n))
    for i in range(n):
        for k in range(m):
            turned[k, i] = a[i, k]
    return turned


def writhe_shares(r: Array, tangents: Array) -> tuple[float, float]:
    """The parts of `writhe` (turns) that the pairs of segments have in it, and those with a ray, or with the line that
    joins the ends; `tangents` (2, 3), or NO_RAYS."""
    if is_plane(r, tangents):
        return 0.0, 0.0
    touching = kind_of(r, tangents) in (KINKED, CLOSED)
    return -segment_pairs(_transposed(r), touching) / pi, share_of_rays(r, tangents)


@allocating
def share_of_rays(r: Array, tangents: Array) -> float:
    """The part of `writhe` (turns) that the pairs with a ray, or with the line that joins the ends, have in it."""
    unit = np.empty_like(tangents)
    for i in range(len(tangents)):
        length = norm(vector(tangents, i))
        for k in range(3):
            unit[i, k] = tangents[i, k] / length
    if is_plane(r, unit):
        return 0.0
    return -(_rays(r, unit) if len(unit) else _gap(r)) / pi


@kernel
def is_plane(r: Array, tangents: Array) -> bool:
    """Whether a polygon `r` (n, 3) and the unit `tangents` (2 or 0, 3) at its ends lie in a plane but for rounding."""
    n, largest, widest, total = len(r), 0.0, 0.0, 0.0
    far, normal = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    for i in range(n):
        away = minus(vector(r, i), vector(r, 0))
        square = dot(away, away)
        total += square
        if square > largest:
            largest, far = square, away
    size = sqrt(largest)
    for i in range(n + len(tangents)):
        across = vector_product(far, _beside(r, tangents, size, i))
        square = dot(across, across)
        if square > widest:
            widest, normal = square, across
    length = sqrt(widest)
    if not length > FLAT * largest:
        return not isnan(total)  # on a line
    farthest = 0.0
    for i in range(n + len(tangents)):
        farthest = max(farthest, abs(dot(normal, _beside(r, tangents, size, i))))
    return bool(farthest <= FLAT * size * length and not isnan(total))


@kernel
def kind_of(r: Array, tangents: Array) -> int:
    """Whether a polygon `r` (n, 3) with the unit `tangents` (2, 3) at its ends is OPEN, KINKED or CLOSED; or JOINED, if
    they are NO_RAYS."""
    if len(tangents) == 0:
        return JOINED
    beside = norm(minus(vector(r, 1), vector(r, 0))) + norm(minus(vector(r, -1), vector(r, -2)))
    if len(r) < 4 or not norm(minus(vector(r, -1), vector(r, 0))) <= 0.5 * MEET * beside:
        return OPEN
    return CLOSED if norm(minus(vector(tangents, 1), vector(tangents, 0))) <= ALIGNED else KINKED


@inner
def _beside(r: Array, tangents: Array, size: float, i: int) -> Any:
    """The way from the first vertex to vertex i, or one of the tangents, `size` long."""
    n = len(r)
    if i < n:
        return minus(vector(r, i), vector(r, 0))
    return times(size, vector(tangents, i - n))


def writhe_of_rod(r: Array, orientation: Array, ring: bool = False) -> float:
    """Writhe (turns) of a rod's centreline `r` (n, 3), continued along a3 of the `orientation` (n, 4) of its ends; or
    of a ring, closed by a straight line."""
    return float(writhe(r, NO_RAYS if ring else tangents_of_ends(orientation)))


@allocating
def tangents_of_ends(orientation: Array) -> Array:
    """Unit tangents a3 (2, 3), lab, of the first and the last of unit quaternions (n, 4)."""
    tangents = np.empty((2, 3))
    for side in range(2):
        tangents[side, 0], tangents[side, 1], tangents[side, 2] = tangent_of(orientation[-side])
    return tangents


@inner
def _rays(r: Array, tangents: Array) -> float:
    """Half the signed area of all pairs with a ray of the polygon `r` (n, 3): with the one that arrives along the first
    of the unit `tangents` (2, 3), with the one that leaves along the last, and of these two. Where ends meet the rays
    touch each other; of a closed curve they shrink to a point, through which it goes along its tangent: what is left is
    the pair of the segments that meet there."""
    kind, first, last = kind_of(r, tangents), vector(tangents, 0), vector(tangents, 1)
    if kind == CLOSED:
        ahead = minus(vector(r, 1), vector(r, 0))
        return -half_area(minus(vector(r, -1), vector(r, -2)), last, ahead) - half_area(last, first, ahead)
    across = minus(vector(r, -1), vector(r, 0))
    apart = 0.0 if kind == OPEN else 2.0 * norm(across)
    total = _ray(r, vector(r, -1), last, apart) - _ray(r, vector(r, 0), minus((0.0, 0.0, 0.0), first), apart)
    return total - half_area(across, last, first) if kind == OPEN else total


@inner
def _gap(r: Array) -> float:
    """Half the signed area of all segments of `r` (n, 3) with the straight line from its end to its start."""
    start, end, total = vector(r, 0), vector(r, -1), 0.0
    for i in range(1, len(r) - 2):
        a, b = minus(end, vector(r, i)), minus(start, vector(r, i))
        c, d = minus(start, vector(r, i + 1)), minus(end, vector(r, i + 1))
        total += half_area(a, b, c) + half_area(a, c, d)
    return total


@inner
def _ray(r: Array, start: Vector, along: Vector, apart: float) -> float:
    """Half the signed area of all segments of `r` (n, 3) with the ray from one of its ends.

    The quadrilateral's two corners at infinity are one, so it is a triangle. A segment that touches the ray, less than
    `apart` from its start, lies in a plane with it and adds nothing.
    """
    total = 0.0
    for i in range(len(r) - 1):
        a, d = minus(start, vector(r, i)), minus(start, vector(r, i + 1))
        if norm(a) > apart and norm(d) > apart:
            total += half_area(a, along, d)
    return total


@inner
def _distances(r: Array, i: int, out: Array) -> None:
    """Distances of vertex i from all later vertices."""
    x, y, z, later = r[0, i + 1 :], r[1, i + 1 :], r[2, i + 1 :], out[i + 1 :]
    for k in range(len(later)):
        u, v, w = x[k] - r[0, i], y[k] - r[1, i], z[k] - r[2, i]
        later[k] = sqrt(u * u + v * v + w * w)


@inlined
def _pair(start: Vector, end: Vector, first: Vector, last: Vector, other: float,
          a: float, b: float, c: float, d: float) -> tuple[float, float]:  # fmt: skip
    """x, y with arg(x + i y) = half the signed area of two segments (see the module's text).

    From `start` to `end`, and from `first` to `last`, whose length's square is `other`; `a`, `b`, `c`, `d` the lengths
    of the four vectors. D is taken from the lengths, by 2 a . b = a^2 + b^2 - |a - b|^2, which loses digits only where
    the two are nearer to each other than they are long, as many as that makes. V is taken from the segments' vectors,
    so that it keeps its digits when the four are nearly parallel.
    """
    ax, ay, az = first[0] - start[0], first[1] - start[1], first[2] - start[2]
    cx, cy, cz = last[0] - end[0], last[1] - end[1], last[2] - end[2]
    ux, uy, uz = end[0] - start[0], end[1] - start[1], end[2] - start[2]
    wx, wy, wz = last[0] - first[0], last[1] - first[1], last[2] - first[2]
    own = ux * ux + uy * uy + uz * uz
    twice_volume = 2.0 * (ax * (uy * wz - uz * wy) + ay * (uz * wx - ux * wz) + az * (ux * wy - uy * wx))
    twice_ac = 2.0 * (ax * cx + ay * cy + az * cz)
    twice_d1 = c * ((a + b) * (a + b) - other) + a * (b * b + c * c - own) + twice_ac * b
    twice_d2 = a * ((c + d) * (c + d) - other) + c * (d * d + a * a - own) + twice_ac * d
    return twice_d1 * twice_d2 - twice_volume * twice_volume, twice_volume * (twice_d1 + twice_d2)


@inlined
def _arctangent(t: float) -> float:
    """arctan(t) for |t| <= SMALL_TANGENT."""
    p = t * t
    series = 1 / 9 - p * (1 / 11 - p * (1 / 13 - p / 15))
    return t * (1.0 - p * (1 / 3 - p * (1 / 5 - p * (1 / 7 - p * series))))


@kernel
def _row(r: Array, i: int, last: int, squares: Array, from_i: Array, from_next: Array, areas: Array) -> int:
    """Write half the areas of segment i with segments i + 2 ... last - 1; return how many are left out, as 0.

    Left out are the near pairs, whose angle is not small. So the loop has no call and no branch (nor the one that
    would raise for a divisor of 0, hence the error model), runs from 0 along slices, and is vectorised.
    """
    left_out, j = 0, i + 2
    start, end = (r[0, i], r[1, i], r[2, i]), (r[0, i + 1], r[1, i + 1], r[2, i + 1])
    x, y, z, a, d = r[0, j:], r[1, j:], r[2, j:], from_i[j:], from_next[j:]
    x1, y1, z1, b, c = r[0, j + 1 :], r[1, j + 1 :], r[2, j + 1 :], from_i[j + 1 :], from_next[j + 1 :]
    other = squares[j:]
    for k in range(last - j):
        p, q = _pair(start, end, (x[k], y[k], z[k]), (x1[k], y1[k], z1[k]), other[k], a[k], b[k], c[k], d[k])
        small = abs(q) < SMALL_TANGENT * p
        areas[k] = _arctangent(q / p) if small else 0.0
        left_out += 0 if small else 1
    return left_out


@inner
def _sum(values: Array) -> float:
    """Their sum, in an order that is vectorised and yet the same on every CPU."""
    a, b, c, d, e, f, g, h = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    whole = len(values) - len(values) % 8
    for k in range(0, whole, 8):
        a, b, c, d = a + values[k], b + values[k + 1], c + values[k + 2], d + values[k + 3]
        e, f, g, h = e + values[k + 4], f + values[k + 5], g + values[k + 6], h + values[k + 7]
    total = ((a + e) + (b + f)) + ((c + g) + (d + h))
    for k in range(whole, len(values)):
        total += values[k]
    return total


@inner
def _near_pairs(r: Array, i: int, last: int, squares: Array, from_i: Array, from_next: Array) -> float:
    """Half the area of segment i with those segments that `_row` leaves out."""
    total = 0.0
    start, end = (r[0, i], r[1, i], r[2, i]), (r[0, i + 1], r[1, i + 1], r[2, i + 1])
    for j in range(i + 2, last):
        p, q = _pair(start, end, (r[0, j], r[1, j], r[2, j]), (r[0, j + 1], r[1, j + 1], r[2, j + 1]),
                     squares[j], from_i[j], from_i[j + 1], from_next[j + 1], from_next[j])  # fmt: skip
        if not abs(q) < SMALL_TANGENT * p:
            total += angle(p, q)
    return total


@allocating
def segment_pairs(r: Array, closed: bool) -> float:
    """Half the signed area of all pairs of segments of `r` (3, n); neighbours lie in one plane."""
    n = r.shape[1]
    from_i, from_next, squares, areas = np.empty(n), np.empty(n), np.empty(n - 1), np.empty(n)
    for i in range(n - 1):
        squares[i] = (r[0, i + 1] - r[0, i]) ** 2 + (r[1, i + 1] - r[1, i]) ** 2 + (r[2, i + 1] - r[2, i]) ** 2
    _distances(r, 0, from_next)
    total = 0.0
    for i in range(n - 3):
        from_i, from_next = from_next, from_i
        _distances(r, i + 1, from_next)
        last = n - 2 if closed and i == 0 else n - 1
        left_out = _row(r, i, last, squares, from_i, from_next, areas)
        total += _sum(areas[: last - i - 2])
        if left_out > 0:
            total += _near_pairs(r, i, last, squares, from_i, from_next)
    return total
