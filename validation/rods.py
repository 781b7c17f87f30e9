"""Rod R of the reference data, and what several scenes share."""

from __future__ import annotations

from math import pi, sqrt

import numpy as np

from solver import FIXED, Condition, Curve, End, Numerics, Rod
from solver.arrays import Array

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


def trefoil(length: float, knotted: float) -> Array:
    """Points (n, 3) of a straight rod of a length along e3 with a loose overhand knot in its middle, which takes up a
    part of it: a trefoil, cut where it is farthest out, its ends drawn apart."""
    t = np.linspace(pi, 3.0 * pi, 1201)
    x, y, z = np.sin(t) + 2.0 * np.sin(2.0 * t), np.cos(t) - 2.0 * np.cos(2.0 * t), -np.sin(3.0 * t)
    knot = np.stack([y, (z - x) / sqrt(2.0) + np.sin(0.5 * (t - 2.0 * pi)), (z + x) / sqrt(2.0)], axis=1)
    steps = np.diff(knot, axis=0)
    knot *= knotted * length / np.linalg.norm(steps, axis=1).sum()
    tail = np.linspace(0.5 * (1.0 - knotted) * length, 0.0, 200, endpoint=False)[:, None]
    before, behind = (step / np.linalg.norm(step) for step in (steps[0], steps[-1]))
    return np.vstack([knot[0] - tail * before, knot, knot[-1] + tail[::-1] * behind])
