"""Contact points: samples of the centreline with a spacing of their own, on cubic Hermite arcs between the nodes.

Nodes are not contact points: where they lie wider apart than the standoff, the rod would pass through itself.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from solver.kernel import kernel
from solver.rod import Array, Section
from solver.scene import Contact


class Points(NamedTuple):
    """M points at even arclengths.

    Fixed: `interval` (M,) and `xi` (M,) in [0, 1], where each lies; `hermite` (M, 4), weights of r_j, T_j, r_j+1 and
    T_j+1; `mass` rho_c A and `diameter` (M,); `spacing` (m). At the current iterate, lab: `p` position, `t` tangent,
    `w` velocity, each (M, 3). `checked` (M, 3): positions at the last search.
    """

    interval: Array
    xi: Array
    hermite: Array
    mass: Array
    diameter: Array
    spacing: float
    p: Array
    t: Array
    w: Array
    checked: Array


def contact_points(contact: Contact, section: Section, s: Array) -> Points:
    """The points of a rod with nodes `s` (n,)."""
    count = max(2, round(float(s[-1]) / contact.spacing) + 1)
    at = np.linspace(0.0, float(s[-1]), count)
    h = float(s[1] - s[0])
    interval = np.minimum((at / h).astype(np.int64), len(s) - 2)
    xi = at / h - interval
    hermite = np.stack([(1 + 2 * xi) * (1 - xi) ** 2, h * xi * (1 - xi) ** 2,
                        xi**2 * (3 - 2 * xi), h * xi**2 * (xi - 1)], axis=1)  # fmt: skip
    vectors = [np.zeros((count, 3)) for _ in range(4)]
    return Points(interval, xi, hermite, np.interp(at, s, section.mass), np.interp(at, s, section.diameter),
                  float(at[1]), *vectors)  # fmt: skip


@kernel
def place_point(points: Points, i: int, r: Array, T: Array, velocity: Array) -> None:
    """Write p, t and w of point i from the nodes' positions, tangents and lab velocities (n, >= 3)."""
    j, xi = points.interval[i], points.xi[i]
    for k in range(3):
        points.p[i, k] = (points.hermite[i, 0] * r[j, k] + points.hermite[i, 1] * T[j, k]
                          + points.hermite[i, 2] * r[j + 1, k] + points.hermite[i, 3] * T[j + 1, k])  # fmt: skip
        points.t[i, k] = (1.0 - xi) * T[j, k] + xi * T[j + 1, k]
        points.w[i, k] = (1.0 - xi) * velocity[j, k] + xi * velocity[j + 1, k]
