"""The contact force of a pair of points, eq. (6) of Goyal, Perkins & Lee 2003, with its tangents.

    B = rho_c A (k1 / (d - D/2)^k2 - (k3/d) d_t |d_t|^k4)

along the separation, times a smooth weight for the aperture and the cutoff. The damping opposes d_t (as printed it
would feed an approaching pair). B is a density along the rod that equals the printed sum over grid points at the
paper's ds of 1 mm: a pair's force is B spacing^2 / 1 mm.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from solver.arrays import Array
from solver.kernels.kernel import inlined, inner, kernel
from solver.physics.contact.automatic import automatic_force
from solver.physics.contact.points import Points, square_between
from solver.scene.contact import Contact

PAPER_SPACING = 1e-3
"""The grid of the paper (m), at which the printed sum and the density agree."""
TAPER = 0.3
"""Outer part of the cutoff over which the force fades."""
LINEAR_BELOW = 0.02
"""In D: distance d - D/2 below which the force goes on linearly: so small that a stiff rod, too, is held before it."""


class Law(NamedTuple):
    """Constants of the law: k1 ... k4 of eq. (6), sine of the half aperture, cutoff and skip (m), weight (m); and in D
    the distance at which it has its `pole`.

    Where it is `automatic`, there is no aperture, the weight is in m^2 and the damping by `relaxation` (s).
    """

    k1: float
    k2: float
    k3: float
    k4: float
    sine: float
    cutoff: float
    skip: float
    weight: float
    automatic: bool = False
    relaxation: float = 0.0
    pole: float = 0.5

    @classmethod
    def of(cls, contact: Contact, spacing: float) -> Law:
        """The law of a scene for points `spacing` apart."""
        weight = spacing if contact.sum == "grid_points" else spacing * spacing / PAPER_SPACING
        constants = (contact.k1, contact.k2, contact.k3, contact.k4, np.sin(0.5 * (contact.aperture or 0.0)))
        return cls(*(float(x) for x in (*constants, contact.cutoff, contact.skip, weight)))  # type: ignore[arg-type]

    @classmethod
    def by_itself(cls, contact: Contact, spacing: float, relaxation: float, pole: float) -> Law:
        """The law without constants, between points `spacing` apart: see `automatic`."""
        everywhere = 2.0  # more than any sine
        return cls.of(contact, spacing)._replace(
            sine=everywhere, weight=spacing * spacing, automatic=True, relaxation=relaxation, pole=pole
        )


@inner
def _fade(x: float) -> tuple[float, float]:
    """Smoothstep and its derivative."""
    if x <= 0.0:
        return 0.0, 0.0
    if x >= 1.0:
        return 1.0, 0.0
    return x * x * (3.0 - 2.0 * x), 6.0 * x * (1.0 - x)


@inner
def _repulsion(law: Law, gap: float, floor: float) -> tuple[float, float]:
    """k1 / gap^k2 and its derivative, continued linearly below `floor`."""
    at = max(gap, floor)
    value = law.k1 * at**-law.k2
    slope = -law.k2 * value / at
    return value + slope * (gap - at), slope


@inlined
def sees(law: Law, points: Points, a: int, b: int, square: float) -> bool:
    """Whether points a and b, whose distance has this `square`, are within the cutoff and in each other's aperture."""
    if square >= law.cutoff * law.cutoff:
        return False
    if law.automatic:
        return True
    x, y, z = points.p[a, 0] - points.p[b, 0], points.p[a, 1] - points.p[b, 1], points.p[a, 2] - points.p[b, 2]
    c_a = x * points.t[a, 0] + y * points.t[a, 1] + z * points.t[a, 2]
    c_b = x * points.t[b, 0] + y * points.t[b, 1] + z * points.t[b, 2]
    widest = law.sine * law.sine * square
    return bool(c_a * c_a < widest and c_b * c_b < widest)


@kernel
def pair_force(law: Law, points: Points, a: int, b: int, n: Array, g: Array, k: Array) -> tuple[float, float, float]:
    """Force on point a from point b: elastic part, damping part (N, along n from b to a), and the gap d - D/2 (m).

    Writes n (3,), and the tangents of the force: n g + 1 force/d by the separation, with g (3,); n k[0] n by t_a,
    n k[1] n by t_b and n k[2] n by the relative velocity. Three zeros beyond the cutoff or outside the aperture, where
    nothing is written.
    """
    square = square_between(points.p, a, b)
    if not sees(law, points, a, b, square):
        return 0.0, 0.0, 0.0
    d = np.sqrt(square)
    inverse = 1.0 / d
    for i in range(3):
        n[i] = (points.p[a, i] - points.p[b, i]) * inverse
    D = 0.5 * (points.diameter[a] + points.diameter[b])
    scale = 0.5 * (points.mass[a] + points.mass[b]) * law.weight
    closing = 0.0
    for i in range(3):
        closing += n[i] * (points.w[a, i] - points.w[b, i])
    if law.automatic:
        return automatic_force(law.relaxation, law.pole, scale, d, D, closing, points, a, b, n, g, k)
    c_a = n[0] * points.t[a, 0] + n[1] * points.t[a, 1] + n[2] * points.t[a, 2]
    c_b = n[0] * points.t[b, 0] + n[1] * points.t[b, 1] + n[2] * points.t[b, 2]
    widest = 1.0 / (law.sine * law.sine)
    S_a, dS_a = _fade(1.0 - c_a * c_a * widest)
    S_b, dS_b = _fade(1.0 - c_b * c_b * widest)
    S_d, dS_d = _fade((law.cutoff - d) / (TAPER * law.cutoff))
    dS_a *= -2.0 * c_a * widest
    dS_b *= -2.0 * c_b * widest
    dS_d *= -1.0 / (TAPER * law.cutoff)
    gap = d - 0.5 * D
    push, slope = _repulsion(law, gap, LINEAR_BELOW * D)
    speed = abs(closing) ** law.k4
    drag = -law.k3 / d * closing * speed
    law_value = push + drag
    by_d = scale * S_a * S_b * (S_d * (slope - drag / d) + dS_d * law_value)
    k[0] = scale * dS_a * S_b * S_d * law_value
    k[1] = scale * S_a * dS_b * S_d * law_value
    k[2] = -scale * S_a * S_b * S_d * law.k3 / d * (law.k4 + 1.0) * speed
    force = scale * S_a * S_b * S_d * law_value
    for j in range(3):
        along = by_d * n[j] + k[0] / d * (points.t[a, j] - c_a * n[j]) + k[1] / d * (points.t[b, j] - c_b * n[j])
        along += k[2] / d * (points.w[a, j] - points.w[b, j] - closing * n[j])
        g[j] = along - force / d * n[j]
    return scale * S_a * S_b * S_d * push, scale * S_a * S_b * S_d * drag, gap
