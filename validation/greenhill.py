"""The torque at which a straight rod between clamps buckles, without thrust.

Greenhill 1883; for clamps M L / EJ = 8.98681892, twice the first root of tan x = x (rod_benchmarks.json). The rod's
static response to a small force across it grows like 1 / (M_c - M) and changes sign at M_c. (The critical
mode is double for a round rod, so the determinant only touches zero.)
"""

from __future__ import annotations

from scipy.optimize import brentq

from solver import Curve, DistributedLoad, End, Initial, Numerics, Scene, constant_vector
from solver.methods.box import BoxMethod
from validation.rods import EJ, GJ, LENGTH, rod_R
from validation.row import Row, against, observed_order

CRITICAL = 8.98681892
STATIC = 1e9
"""A step (s) so long that inertia is below rounding."""
FORCE = 1e-13
"""In EJ / L^3: so small that the first Newton increment, which is the linear response, ends the iteration."""


def stiffness(torque: float, intervals: int) -> float:
    """Force over mid-span displacement of the rod twisted by `torque` (in EJ / L): zero at the critical torque."""
    twist = torque * EJ / GJ
    scene = Scene(
        rod=rod_R(), initial=Initial.straight(twist=Curve.table([0.0, LENGTH], [0.0, twist])),
        start=End.clamp(), end=End.slider(), t_end=STATIC, output_interval=STATIC,
        distributed=(DistributedLoad(force=constant_vector((FORCE * EJ / LENGTH**3, 0.0, 0.0))),),
        numerics=Numerics(intervals=intervals, dt_max=STATIC), topology=False,
    )  # fmt: skip
    method = BoxMethod(scene)
    method.try_step(0.0, STATIC)
    return float(FORCE / method.trial.r[intervals // 2, 0])


def critical_torque(intervals: int) -> float:
    """M L / EJ at which the rod of so many intervals buckles."""
    return float(brentq(stiffness, 8.8, 9.2, args=(intervals,), xtol=1e-9))


def rows() -> list[Row]:
    """The critical torque: its error at N = 100 and 200, 0.0120 and 0.0030 (solver.md 6), and its order."""
    coarse, fine = critical_torque(100), critical_torque(200)
    return [
        against("Greenhill M L/EJ, N=100", coarse, CRITICAL, 0.0120),
        against("Greenhill M L/EJ, N=200", fine, CRITICAL, 0.0030),
        observed_order("Greenhill order in ds", abs(coarse - CRITICAL), abs(fine - CRITICAL)),
        against("Greenhill M L/EJ, extrapolated", (4 * fine - coarse) / 3, CRITICAL, 1e-6),
    ]

