"""The contact force of a pair where no constants are given: central, smooth, and the same at every scale.

    F = P h^2 (f(d) + tau f'(d) d_t),  f = (((2 - p) D - d) / (d - p D))^4 for p D < d < (2 - p) D, and 0 beyond

along the separation, with h the spacing of the points and P a force per length of each strand (N/m^2). f is 1 at d = D,
where the surfaces touch, and falls by 8 / ((1 - p) D) there. It depends on the distance alone, so that it has a
potential: sampled with h of .8 (1 - p) D or less, its sum along two strands is their line integral to about a part in a
thousand, wherever the points of the one lie beside those of the other. Damping goes with its slope.
"""

from __future__ import annotations

from solver.arrays import Array
from solver.kernels.kernel import inner
from solver.physics.contact.points import Points

POWER = 4
FLOOR = 0.02
"""In D: distance from the pole below which the force goes on linearly."""


@inner
def repulsion(d: float, D: float, pole: float) -> tuple[float, float, float]:
    """f, f' (1/m) and f'' (1/m^2)."""
    gap = d - pole * D
    at = max(gap, FLOOR * D)
    inverse = 1.0 / at
    x = 2.0 * (1.0 - pole) * D * inverse - 1.0
    if x <= 0.0:
        return 0.0, 0.0, 0.0
    slope_of_x, square = -(x + 1.0) * inverse, x * x
    value, slope = square * square, 4.0 * x * square * slope_of_x
    if gap < at:
        return value + slope * (gap - at), slope, 0.0
    return value, slope, square * slope_of_x * (12.0 * slope_of_x - 8.0 * x * inverse)


@inner
def automatic_force(relaxation: float, pole: float, scale: float, d: float, D: float, closing: float, points: Points,
                    a: int, b: int, n: Array, g: Array, k: Array) -> tuple[float, float, float]:  # fmt: skip
    """What `pair_force` says, by this law, of points a distance d apart that approach at `closing` (m/s), along n.

    `relaxation` tau (s), `pole` p, `scale` h^2 P (N).
    """
    f, slope, bend = repulsion(d, D, pole)
    if f == 0.0:
        return 0.0, 0.0, 0.0
    elastic, damping, drag = scale * f, scale * relaxation * slope * closing, scale * relaxation * slope
    turned = drag / d
    along = scale * (slope + relaxation * bend * closing) - (elastic + damping) / d - turned * closing
    k[0], k[1], k[2] = 0.0, 0.0, drag
    for j in range(3):
        g[j] = along * n[j] + turned * (points.w[a, j] - points.w[b, j])
    return elastic, damping, d - pole * D
