"""By how much Tw + Wr of a rod changes as the tangents at its ends move.

Let the frame at one end be swung to the other's tangent by the shortest rotation: the angle chi that is then left about
this tangent is 2 pi (Tw + Wr), but for whole turns, with the rays of `topology.writhe`. In a motion chi changes by what
the ends turn about their tangents, the integral of omega3, and by the area on the unit sphere that the arc between
their tangents sweeps (Fuller, PNAS 75 (1978) 3557).
"""

from __future__ import annotations

from math import atan2, pi, sqrt
from typing import Any

import numpy as np

from solver.arrays import Array
from solver.kernels.kernel import inner, kernel
from solver.kernels.rotation import product, tangent_of
from solver.kernels.vectors import dot, vector_product

STILL = 1e-16
"""Square of the angle (rad) within which a tangent has not moved."""


@inner
def _quaternion(a: Array, i: int) -> Any:
    return a[i, 0], a[i, 1], a[i, 2], a[i, 3]


@inner
def _spin(start: Any, end: Any) -> float:
    """chi (rad) of the orientations at the ends."""
    w, _, _, z = product(start[0], -start[1], -start[2], -start[3], end[0], end[1], end[2], end[3])
    return 2.0 * atan2(z, w)


@inner
def _swung(q: Any, tangent: Any) -> Any:
    """An orientation, swung by the shortest rotation so that its tangent is another."""
    own = tangent_of(q)
    axis, cosine = vector_product(own, tangent), 1.0 + dot(own, tangent)
    scale = 1.0 / sqrt(cosine * cosine + dot(axis, axis)) if cosine > 0.0 else 0.0
    return product(scale * cosine, scale * axis[0], scale * axis[1], scale * axis[2], q[0], q[1], q[2], q[3])


@inner
def _within_half_a_turn(angle: float) -> float:
    return angle - 2.0 * pi * float(np.round(angle / (2.0 * pi)))


@kernel
def swept(before: Array, after: Array, turned: float) -> float:
    """What the ends' tangents, as they moved, have added to Tw + Wr, in turns; 0 where they stood still.

    Quaternions whose first and last are the ends': `before` and `after` (., 4), between which the end has turned by
    `turned` (rad) more than the start about their tangents. The area is that between great circles, which is told from
    what was swept by whole turns only.
    """
    start, end = _quaternion(before, 0), _quaternion(before, -1)
    new_start, new_end = _quaternion(after, 0), _quaternion(after, -1)
    from_start = vector_product(tangent_of(start), tangent_of(new_start))
    from_end = vector_product(tangent_of(end), tangent_of(new_end))
    if dot(from_start, from_start) + dot(from_end, from_end) <= STILL:
        return 0.0
    chi, swung = _spin(start, end), _spin(_swung(start, tangent_of(new_start)), _swung(end, tangent_of(new_end)))
    area = _within_half_a_turn(swung - chi)
    return (area + _within_half_a_turn(_spin(new_start, new_end) - chi - turned - area)) / (2.0 * pi)
