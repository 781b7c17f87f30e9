"""A polygon of fewer vertices with the same writhe, but for an area that is known.

Let a curve change without passing through itself. Then its writhe changes by the area that its tangent indicatrix, the
path of its unit tangents on the sphere, sweeps: by area / 2 pi (Fuller, PNAS 75 (1978) 3557). A polygon's indicatrix
runs along great circles from the tangent of each segment to that of the next. So the segments t_1 ... t_m of a block
may give way to their chord, of the direction c between the tangents t_0 before and t_m+1 after it, at the price of the
spherical triangles (c, t_i, t_i+1): O(m), where their pairs with all others are O(m n).

This asks that nothing passes through the block's convex hull on the way. That is proved

- for the neighbouring blocks, if all tangents of the three are within a right angle of each other: then a plane across
  the joint separates their hulls, no triangle is large, and the block runs forward along its chord without meeting
  itself;
- for every other block, if the spheres around both are apart.

A ray is the neighbour of the block that it touches, and another one to the rest. A block for which the proof fails
stays as it is: its pairs are summed up as ever.
"""

from __future__ import annotations

from math import sqrt
from typing import Any

import numpy as np
from numpy.typing import NDArray

from solver.arrays import Array
from solver.kernels.copying import copy
from solver.kernels.kernel import allocating, inner
from solver.kernels.vectors import Vector, dot, minus, norm, times, vector
from solver.measures.spherical import half_area

BLOCK = 8
RIGHT_ANGLE = sqrt(2.0)
"""The chord of a right angle on the unit sphere. Chords that sum up to less belong to angles that do so, too: as far as
there an arc is at most pi / 2 sqrt(2) times as long as its chord."""


@allocating
def shorten(r: Array, first: Vector, last: Vector) -> tuple[Array, float]:
    """The polygon `r` (3, n) without the inner vertices of its smooth blocks, and what its pairs add up to the less
    (half areas: Wr = -sum / pi).

    It is continued by rays that arrive along the unit vector `first` and leave along `last`.
    """
    t = _tangents(r, first, last)
    smooth, alone = _smooth(t), _alone(r, first, last)
    shorter, many, area, before = np.empty(r.shape), 1, 0.0, vector(t, 0)
    copy(r[:, 0], shorter[:, 0])
    for block in range(len(smooth)):
        start, end = BLOCK * block, min(BLOCK * (block + 1), r.shape[1] - 1)
        if smooth[block] and alone[block]:
            x, y, z = minus(_vertex(r, end), _vertex(r, start))
            length = norm((x, y, z))
            chord = x / length, y / length, z / length
            area += half_area(before, chord, vector(t, start + 1))
            for i in range(start + 1, end + 1):
                area += half_area(vector(t, i), chord, vector(t, i + 1))
            before = chord
            start = end - 1
        else:
            before = vector(t, end)
        copy(r[:, start + 1 : end + 1], shorter[:, many : many + end - start])
        many += end - start
    polygon = np.empty((3, many))
    copy(shorter[:, :many], polygon)
    return polygon, area


@inner
def _vertex(r: Array, i: int) -> Any:
    """Vertex i of a polygon (3, n), as a vector."""
    return r[0, i], r[1, i], r[2, i]


@allocating
def _tangents(r: Array, first: Vector, last: Vector) -> Array:
    """Unit tangents (n + 1, 3) of the ray, the n - 1 segments and the other ray."""
    t = np.empty((r.shape[1] + 1, 3))
    for k in range(3):
        t[0, k], t[-1, k] = first[k], last[k]
    for i in range(r.shape[1] - 1):
        x, y, z = r[0, i + 1] - r[0, i], r[1, i + 1] - r[1, i], r[2, i + 1] - r[2, i]
        length = sqrt(x * x + y * y + z * z)
        t[i + 1, 0], t[i + 1, 1], t[i + 1, 2] = x / length, y / length, z / length
    return t


@allocating
def _smooth(t: Array) -> NDArray[np.bool_]:
    """Of each block, whether its tangents and those of its neighbours turn by less than a right angle in all."""
    turned, segments = np.zeros(len(t)), len(t) - 2
    for i in range(1, len(t)):
        turned[i] = turned[i - 1] + norm(minus(vector(t, i), vector(t, i - 1)))
    smooth = np.empty((segments + BLOCK - 1) // BLOCK, np.bool_)
    for block in range(len(smooth)):
        start, end = max(BLOCK * (block - 1) + 1, 0), min(BLOCK * (block + 2), segments + 1)
        smooth[block] = turned[end] - turned[start] < RIGHT_ANGLE
    return smooth


@allocating
def _spheres(r: Array) -> tuple[Array, Array]:
    """Centres (blocks, 3) and radii (blocks,) of spheres, each around all vertices of a block."""
    blocks = (r.shape[1] + BLOCK - 2) // BLOCK
    centres, radii = np.empty((blocks, 3)), np.zeros(blocks)
    for block in range(blocks):
        start, end = BLOCK * block, min(BLOCK * (block + 1), r.shape[1] - 1)
        x, y, z = 0.5 * (r[0, start] + r[0, end]), 0.5 * (r[1, start] + r[1, end]), 0.5 * (r[2, start] + r[2, end])
        for i in range(start, end + 1):
            radii[block] = max(radii[block], sqrt((r[0, i] - x) ** 2 + (r[1, i] - y) ** 2 + (r[2, i] - z) ** 2))
        centres[block, 0], centres[block, 1], centres[block, 2] = x, y, z
    return centres, radii


@allocating
def _alone(r: Array, first: Vector, last: Vector) -> NDArray[np.bool_]:
    """Of each block, whether the sphere around it is apart from those of all but its neighbours, and from the rays."""
    centres, radii = _spheres(r)
    blocks = len(radii)
    alone = np.ones(blocks, np.bool_)
    for block in range(blocks):
        arrives, leaves = minus(vector(centres, block), _vertex(r, 0)), minus(vector(centres, block), _vertex(r, -1))
        if block > 0 and not _ray_apart(arrives, radii[block], (-first[0], -first[1], -first[2])):
            alone[block] = False
        if block < blocks - 1 and not _ray_apart(leaves, radii[block], last):
            alone[block] = False
        for other in range(block + 2, blocks):
            way = minus(vector(centres, block), vector(centres, other))
            if not dot(way, way) > (radii[block] + radii[other]) ** 2:
                alone[block] = alone[other] = False
    return alone


@inner
def _ray_apart(centre: Any, radius: float, direction: Any) -> bool:
    """Whether a ray passes by a sphere whose centre lies at `centre` from its beginning."""
    away = minus(centre, times(max(dot(centre, direction), 0.0), direction))
    return bool(dot(away, away) > radius * radius)
