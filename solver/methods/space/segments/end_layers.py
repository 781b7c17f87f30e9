"""The curvature at an end that is held at an angle, where a taut rod bends within less than an interval.

There, as in a wire at its clamp, kappa = (theta / lambda) exp(-s / lambda), lambda = sqrt(EJ / T), by the angle theta
between the end and the direction in which the rod goes off (of large ones, 2 sin(theta / 2) instead: the elastica). A
chain with intervals h longer than that shows all of theta in its first joint, 2 theta / h, which says how fine the mesh
is. The same chain solved in closed form, x = h / lambda, tells what its joints show of such a layer:

    psi_j+1 - 2 psi_j + psi_j-1 = x^2 psi_j,   h kappa_0 = 2 (1 - psi_1) theta,   h kappa_2 = rho (1 - rho) psi_1 theta,

rho = psi_2 / psi_1, psi_1 = 2 / (x^2 + 3 - rho). So theta follows from what its joints 0 and 2 show, and then what is
missing at the end; of order h^2 where the mesh resolves the layer.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import pi, sin, sqrt
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from solver.arrays import Array
from solver.kernels.rotation import rotation_of
from solver.measures.frame import Fields
from solver.physics.elasticity import Coupling, Stretch, TwistStretch, Viscosity
from solver.scene.rod import Rod

LINEAR = (Coupling, Stretch, TwistStretch, Viscosity)
"""Laws with which bending stays proportional to curvature."""
RESOLVED = 0.05
"""Of h / lambda: below it nothing is missing that rounding would not blur."""


class EndLayers(NamedTuple):
    """Intervals `h` (m), and the bending stiffness `EJ` (2, 2) in N m^2 about a1 and a2 at start and end; none of a rod
    whose moment is not proportional to its curvature."""

    h: float
    EJ: Array

    @classmethod
    def of(cls, rod: Rod, s: Array) -> EndLayers:
        """Those of a rod with nodes at `s` (n,)."""
        ends = s[[0, -1]]
        EJ = np.stack([np.asarray(profile(ends)) for profile in rod.stiffness[:2]], axis=1)
        return cls(float(s[1] - s[0]), EJ if all(isinstance(law, LINEAR) for law in rod.laws) else EJ[:0])

    def complete(self, fields: Fields, held: Sequence[NDArray[np.bool_]]) -> Fields:
        """Add what is missing to kappa at both ends; `held`: whether each is held about a1 and a2.

        q stays: it is what the end bears in the balances of this mesh.
        """
        for (end, inner, third), EJ, about in zip(((0, 1, 2), (-1, -2, -3)), self.EJ, held, strict=False):
            x = self.h * np.sqrt(max(float(fields.f[inner, 2]), 0.0) / EJ)
            lacking = about & (x > RESOLVED)
            if lacking.any() and len(fields.f) > 3:
                _complete(fields, end, third, self.h, x.tolist(), EJ, lacking)
        return fields


def _complete(fields: Fields, end: int, third: int, h: float, x: list[float], EJ: Array,
              lacking: NDArray[np.bool_]) -> None:  # fmt: skip
    """Add what is missing at an end, about the axes that lack it; `third`: the joint after the next one."""
    Q = fields.orientation[[end, third]]
    q = rotation_of(Q[0]).T @ (rotation_of(Q[1]) @ fields.q[third])
    shown = [_shown(value) for value in x]
    theta = [(fields.q[end, k] - q[k]) * h / (EJ[k] * (first - later)) if lacking[k] else 0.0
             for k, (first, later) in enumerate(shown)]  # fmt: skip
    half = 0.5 * min(sqrt(theta[0] ** 2 + theta[1] ** 2), pi)
    shape = sin(half) / half if half > 0.0 else 1.0
    for k, (first, _) in enumerate(shown):
        fields.kappa[end, k] += shape * theta[k] * (x[k] - first) / h


def _shown(x: float) -> tuple[float, float]:
    """h kappa over theta in joints 0 and 2 of a chain."""
    rho = 1.0 / (1.0 + 0.5 * x * x + x * sqrt(1.0 + 0.25 * x * x))
    psi = 2.0 / (x * x + 3.0 - rho)
    return 2.0 * (1.0 - psi), rho * (1.0 - rho) * psi
