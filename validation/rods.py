"""Rod R of the reference data, and what several scenes share."""

from __future__ import annotations

from math import pi

from solver import FIXED, Condition, Curve, End, Numerics, Rod

LENGTH = 1.0
DIAMETER = 0.01
YOUNGS_MODULUS = 1.25e7
SHEAR_MODULUS = 5e6
DENSITY = 1500.0

EJ = YOUNGS_MODULUS * pi * DIAMETER**4 / 64
GJ = SHEAR_MODULUS * pi * DIAMETER**4 / 32
FIXED_STEPS = 1e9
"""An increment_tolerance that leaves the step at dt_max (after the first few, which grow up to it)."""


def rod_R(diameter: float = DIAMETER) -> Rod:
    """Rod R: 1 m long, 10 mm thick unless said, E 12.5 MPa, G 5 MPa, 1500 kg/m^3."""
    return Rod.circular(LENGTH, diameter, YOUNGS_MODULUS, SHEAR_MODULUS, DENSITY)


def fixed_steps(intervals: int, dt: float, rho_inf: float = 1.0) -> Numerics:
    """Numerics with steps of dt."""
    return Numerics(intervals=intervals, dt_max=dt, rho_inf=rho_inf, increment_tolerance=FIXED_STEPS)


def driven_clamp(axial: Curve, turn: Curve) -> End:
    """A clamp that is displaced by `axial`(t) (m) along e3 and turned by `turn`(t) (rad) about the tangent."""
    return End(
        (FIXED, FIXED, (Condition("position", axial),)),
        (FIXED, FIXED, (Condition("position", turn),)),
        frame="lab",
    )

