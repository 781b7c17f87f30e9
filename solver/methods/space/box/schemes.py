"""The parameters of generalized-alpha in space.

It is the one-step formula of the box scheme's family: with Z = (omega, V, F, q) and Z_s = -G at a node, A an
auxiliary derivative carried along s,

    a Delta Z + h b A_j + h (w_left G_j + w_right G_{j+1}) = 0,   Z_{j+1} = Z_j + h ((1 - gamma) A_j + gamma A_{j+1}),

a = alpha_m / gamma, b = 1 - a, w_right = alpha_f, w_left = 1 - alpha_f; products in G are of weighted means. At
rho_inf = 1 this is the midpoint (Keller box) scheme: a = 1, b = 0, both weights 1/2, and A drops out.

With rho_inf < 1 the formula damps along +s whatever an interval does not resolve, also solutions that grow along +s and
belong to the end at L. So it needs h (m / (EJ dt^2))^(1/4) < 1, that is dt > h^2 sqrt(m / EJ); the symmetric
box scheme has no such limit, which is why it is the default.
"""

from __future__ import annotations

from typing import NamedTuple

from solver.methods.schemes import Scheme


class SpaceScheme(NamedTuple):
    """Coefficients a, b, w_left, w_right and gamma of one member of the family."""

    a: float
    b: float
    w_left: float
    w_right: float
    gamma: float

    @classmethod
    def of(cls, rho_inf: float) -> SpaceScheme:
        """The second-order member with spectral radius rho_inf at infinite wave number."""
        alpha_m, alpha_f, gamma = Scheme.of(rho_inf)
        return cls(alpha_m / gamma, 1.0 - alpha_m / gamma, 1.0 - alpha_f, alpha_f, gamma)


BOX = SpaceScheme(1.0, 0.0, 0.5, 0.5, 0.5)
"""rho_inf = 1: the midpoint scheme, the default and the only one whose solve is tuned."""

MINUS_DIFFERENCE = SpaceScheme(-1.0, 0.0, 0.0, 0.0, 1.0)
"""- Delta Z alone, from the same formulas."""

AT_LEFT_NODE = SpaceScheme(0.0, 0.0, 1.0, 0.0, 1.0)
"""h G of an interval's left node alone, from the same formulas."""
