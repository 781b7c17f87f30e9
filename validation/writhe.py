"""Writhe of curves whose writhe is known: the exact polygon formula converges with order 2 in N.

Klenin & Langowski, Biopolymers 54 (2000) 307; the curves and their values from rod_benchmarks.json.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from solver.arrays import Array
from solver.measures import topology
from validation.row import Row, against, observed_order

OPEN, TREFOIL = 0.120679172516, -3.518239231
TREFOIL_POLYGONS = {200: -3.516726147, 400: -3.517860454, 800: -3.518144505}


def writhe(r: ArrayLike, start_tangent: ArrayLike, end_tangent: ArrayLike) -> float:
    """Writhe of an open polygon (n, 3), continued by rays along tangents of any length."""
    tangents = np.array([start_tangent, end_tangent], dtype=float)
    tangents /= np.linalg.norm(tangents, axis=1)[:, None]
    return float(topology.writhe(np.ascontiguousarray(r, dtype=float), tangents))


def writhe_closed(r: ArrayLike) -> float:
    """Writhe of the closed polygon with vertices (n >= 3, 3), the last joined to the first."""
    vertices = np.array(r, dtype=float)
    columns = np.ascontiguousarray(np.vstack([vertices, vertices[:1]]).T)
    return float(-topology.segment_pairs(columns, True) / np.pi)


def open_curve(intervals: int) -> Array:
    """(a w cos 2 pi s, a w sin 2 pi s, s), w = (4 s (1 - s))^3, a = 0.1."""
    s = np.linspace(0.0, 1.0, intervals + 1)
    w = 0.1 * (4.0 * s * (1.0 - s)) ** 3
    return np.stack([w * np.cos(2 * np.pi * s), w * np.sin(2 * np.pi * s), s], axis=1)


def trefoil(vertices: int) -> Array:
    """((2 + cos 3u) cos 2u, (2 + cos 3u) sin 2u, sin 3u)."""
    u = 2 * np.pi * np.arange(vertices) / vertices
    return np.stack([(2 + np.cos(3 * u)) * np.cos(2 * u), (2 + np.cos(3 * u)) * np.sin(2 * u), np.sin(3 * u)], axis=1)


def rows() -> list[Row]:
    """Polygons to the digits of the reference; order in N of both curves; their limits by extrapolation."""
    e3 = (0.0, 0.0, 1.0)
    straight = {n: writhe(open_curve(n), e3, e3) for n in (100, 200, 400, 800)}
    knot = {n: writhe_closed(trefoil(n)) for n in (100, 200, 400, 800)}
    table = [against(f"writhe trefoil, polygon of {n}", knot[n], w, 5e-10) for n, w in TREFOIL_POLYGONS.items()]
    for name, runs, exact in (("open curve", straight, OPEN), ("trefoil", knot, TREFOIL)):
        for n in (100, 200, 400):
            errors = abs(runs[n] - exact), abs(runs[2 * n] - exact)
            table.append(observed_order(f"writhe {name}, order N={n}/{2 * n}", *errors))
        limit = (4 * runs[800] - runs[400]) / 3
        table.append(against(f"writhe {name}, extrapolated", limit, exact, 1e-6))
    return table
