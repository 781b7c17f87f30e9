"""How places lie to the surfaces of solids. `load`: a record of `solids`."""

from __future__ import annotations

from math import sqrt
from typing import Any, NamedTuple

from solver.kernels.kernel import inner
from solver.kernels.vectors import dot, minus, norm, plus, times, vector


class Near(NamedTuple):
    """A place beside a solid: its `height` (m) above the surface, negative below; the unit normal n out of it there,
    and what n turns by as the place moves: a, 0 where it turns in all directions, and the `curvature` 1 / |r - c|."""

    height: float
    n: Any
    a: Any
    curvature: float


@inner
def near(load: Any, k: int, r: Any) -> Near:
    """How a place lies to solid k. On an obstacle's axis, where no side is the nearest, n is 0: nothing pushes."""
    axis, away = vector(load.axis, k), minus(r, vector(load.start, k))
    if load.flat[k]:
        return Near(dot(axis, away) - load.radius[k], axis, times(0.0, axis), 0.0)
    square, along = dot(axis, axis), dot(away, axis)
    within = 0.0 < along < square
    part = along / square if within else (1.0 if along > 0.0 else 0.0)
    way = minus(away, times(part, axis))
    distance = norm(way)
    curvature = 1.0 / distance if distance > 0.0 else 0.0
    a = times(1.0 / sqrt(square) if within else 0.0, axis)
    return Near(distance - load.radius[k], times(curvature, way), a, curvature)


@inner
def turning(near: Near, x: Any) -> Any:
    """dn/dr x."""
    across = plus(x, times(-dot(near.n, x), near.n))
    return times(near.curvature, plus(across, times(-dot(near.a, x), near.a)))
