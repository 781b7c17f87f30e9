"""The parameters of generalized-alpha, in time and in space."""

from __future__ import annotations

from typing import NamedTuple

from solver.kernels.kernel import inlined


class Scheme(NamedTuple):
    """Parameters alpha_m, alpha_f and gamma of one member of the family."""

    alpha_m: float
    alpha_f: float
    gamma: float

    @classmethod
    def of(cls, rho_inf: float) -> Scheme:
        """The second-order member with spectral radius rho_inf at infinite frequency."""
        alpha_m = (3.0 - rho_inf) / (2.0 * (1.0 + rho_inf))
        alpha_f = 1.0 / (1.0 + rho_inf)
        return cls(alpha_m, alpha_f, 0.5 + alpha_m - alpha_f)

    @property
    def left_out(self) -> float:
        """What the displacement of a step lacks where its rate varies, in what the trapezoidal rule lacks; of a member
        of second order: by the series of both for a rate exp(lambda t), to (lambda dt)^2."""
        of_rates, of_aux, of_both = (a * (1.0 - a) for a in (self.alpha_f, self.alpha_m, self.gamma))
        return 6.0 * (of_rates - of_aux + of_both) - 0.5


@inlined
def c0_of(scheme: Scheme, dt: float) -> float:
    """c0 = d(rate)/d(value) at the end of a step dt."""
    return scheme.alpha_m / (scheme.alpha_f * scheme.gamma * dt)


BACKWARD_EULER = Scheme(1.0, 1.0, 1.0)
"""Order 1, for the first tiny step that finds consistent accelerations and forces."""
