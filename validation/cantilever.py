"""Natural frequencies of a cantilever, from the zero crossings of its free vibration.

Bending: Rayleigh's beam, that is 1.8751041^2 sqrt(EI / rhoA) / L^2 less rotary inertia, to nine digits in
rod_benchmarks.json; torsion (2 n - 1) (pi / 2L) sqrt(GJ / I3); in still water with added mass Ca rho_w A.
"""

from __future__ import annotations

from collections.abc import Callable
from math import pi

import numpy as np
from scipy.interpolate import CubicSpline

from solver import End, Fluid, Frame, Initial, Scene, simulate
from solver.arrays import Array
from validation.rods import LENGTH, fixed_steps, rod_R
from validation.row import Row, relative

BENDING = (0.802405377, 5.0281523458, 14.0769983417)
TORSION = (90.6899682, 272.0699046)
IN_WATER = 0.6215441433
"""rad/s, rod_benchmarks.json; water of 1000 kg/m^3, Ca = 1."""
ROOTS = (1.875104068711961, 4.694091132974175, 7.854757438237613)
"""Of cos x cosh x = -1: the modes' wave numbers times L."""
AMPLITUDE = 1e-4
"""The tip's, in L, or the twist in rad: the frequency's own shift is of its square."""
PERIODS = 6


def mode_slope(number: int, s: Array) -> Array:
    """The slope of a cantilever's bending mode at s (n,), its tip displacement being 1 (Euler-Bernoulli)."""
    x = ROOTS[number]
    ratio = (np.cosh(x) + np.cos(x)) / (np.sinh(x) + np.sin(x))
    z = x * s / LENGTH
    slope = np.sinh(z) + np.sin(z) - ratio * (np.cosh(z) - np.cos(z))
    tip = np.cosh(x) - np.cos(x) - ratio * (np.sinh(x) - np.sin(x))
    return np.asarray(slope * x / LENGTH / tip, dtype=float)


def bent(number: int) -> Initial:
    """A rod along e3, bent towards e1 in the shape of a mode, its length kept."""
    fine = np.linspace(0.0, LENGTH, 2001)
    angle = AMPLITUDE * LENGTH * mode_slope(number, fine)
    across, along = (CubicSpline(fine, f(angle)).antiderivative() for f in (np.sin, np.cos))
    return Initial(centreline=lambda s: np.stack([across(s), np.zeros_like(s), along(s)], axis=1))


def twisted(number: int) -> Initial:
    """A straight rod twisted in the shape of a torsional mode."""
    return Initial.straight(twist=lambda s: AMPLITUDE * np.sin((number + 0.5) * pi * s / LENGTH))


def vibration(initial: Initial, period: float, intervals: int, steps: int, fluid: Fluid | None = None) -> Scene:
    """Six periods of a cantilever let go from `initial`, in so many equal steps a period."""
    dt = period / steps
    return Scene(
        rod=rod_R(), initial=initial, start=End.clamp(), end=End.free(), t_end=PERIODS * period, output_interval=dt,
        fluid=fluid, numerics=fixed_steps(intervals, dt), topology=False,
    )  # fmt: skip


def frequency(scene: Scene, signal: Callable[[Frame], float]) -> float:
    """Circular frequency (rad/s) from the first zero crossing of the signal to the last."""
    frames = list(simulate(scene))
    spline = CubicSpline([f.t for f in frames], [signal(f) for f in frames])
    crossings = spline.roots(extrapolate=False)
    return float(pi * (len(crossings) - 1) / (crossings[-1] - crossings[0]))


def tip(frame: Frame) -> float:
    """Displacement of the tip."""
    return float(frame.r[-1, 0])


def root_twist(frame: Frame) -> float:
    """Twist at the clamp."""
    return float(frame.kappa[0, 2])


def measured(kind: str, intervals: int, steps: int) -> float:
    """The frequency (rad/s) of "bending 1" to "bending 3", "torsion 1", "torsion 2" or "in water"."""
    number = 0 if kind == "in water" else int(kind[-1]) - 1
    if kind.startswith("torsion"):
        return frequency(vibration(twisted(number), 2 * pi / TORSION[number], intervals, steps), root_twist)
    fluid = Fluid(density=1000.0, added_mass=1.0) if kind == "in water" else None
    omega = IN_WATER if fluid else BENDING[number]
    return frequency(vibration(bent(number), 2 * pi / omega, intervals, steps, fluid), tip)


def rows() -> list[Row]:
    """At N = 100 and 100 steps a period: within 3e-4. Extrapolated from 100 and 200 of both: a tenth of that."""
    references = {f"bending {i + 1}": omega for i, omega in enumerate(BENDING)}
    references |= {f"torsion {i + 1}": omega for i, omega in enumerate(TORSION)} | {"in water": IN_WATER}
    table = []
    for kind, omega in references.items():
        coarse, fine = measured(kind, 100, 100), measured(kind, 200, 200)
        if kind in ("bending 1", "in water"):
            table.append(relative(f"cantilever {kind}, rad/s, N=100, T/100", coarse, omega, 3e-4))
        table.append(relative(f"cantilever {kind}, rad/s, extrapolated", (4 * fine - coarse) / 3, omega, 3e-5))
    return table

