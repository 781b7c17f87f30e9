"""The elastica: a cantilever under a dead load P across its tip, brought to rest by damping.

Bisshopp & Drucker, Quart. Appl. Math. 3 (1945) 272: with alpha = P L^2 / EI, modulus k and sin(phi_1) = 1/(k sqrt 2),

    sqrt(alpha) = K(k) - F(phi_1, k),   tip angle = arcsin(2 k^2 - 1),
    w = 1 - 2 (E(k) - E(phi_1, k)) / sqrt(alpha),   u = 1 - sqrt(2 (2 k^2 - 1) / alpha).
"""

from __future__ import annotations

from math import asin, atan2, nan, sqrt

import numpy as np
from scipy.optimize import brentq
from scipy.special import ellipe, ellipeinc, ellipk, ellipkinc

from solver import Curve, End, Initial, Numerics, PointLoad, RunFailed, Scene, simulate
from solver.kernels.rotation import rotate
from validation.rods import EJ, LENGTH, fixed_steps, rod_R
from validation.row import Row, against, observed_order

ALPHAS = (1.0, 2.0, 5.0, 10.0)
TABLE = {
    1.0: (0.301721, 0.056433, 0.461352),
    2.0: (0.493457, 0.160642, 0.781750),
    5.0: (0.713792, 0.387628, 1.215368),
    10.0: (0.810609, 0.554996, 1.430286),
}
"""w, u and tip angle in rod_benchmarks.json, to six digits."""
NAMES = ("w/L", "u/L", "tip angle")
RAMP, REST = 10.0, 60.0
"""The load grows over 10 s; 50 s more at a damping of 2 / s leave exp(-50) of the motion."""
STEP = 0.25


def exact(alpha: float) -> tuple[float, float, float]:
    """w/L, u/L and tip angle of the elastica."""

    def load_at(m: float) -> float:
        return float(ellipk(m) - ellipkinc(asin(1.0 / sqrt(2.0 * m)), m))

    m = brentq(lambda m: load_at(m) ** 2 - alpha, 0.5 + 1e-12, 1.0 - 1e-12, xtol=1e-16, rtol=1e-15)
    arc = float(ellipe(m) - ellipeinc(asin(1.0 / sqrt(2.0 * m)), m))
    return 1.0 - 2.0 * arc / sqrt(alpha), 1.0 - sqrt(2.0 * (2.0 * m - 1.0) / alpha), asin(2.0 * m - 1.0)


def at_rest(alpha: float, numerics: Numerics) -> tuple[float, float, float]:
    """w/L, u/L and tip angle that the solver comes to rest at."""
    zero = Curve.constant(0.0)
    load = Curve.table([0.0, RAMP], [0.0, alpha * EJ / LENGTH**2], "smoothstep")
    scene = Scene(
        rod=rod_R(), initial=Initial.straight(), start=End.clamp(), end=End.free(),
        t_end=REST, output_interval=REST, points=(PointLoad(LENGTH, force=(load, zero, zero)),),
        damping=2.0, numerics=numerics, topology=False,
    )  # fmt: skip
    *_, last = simulate(scene)
    tangent = rotate(last.orientation[-1:], np.array([[0.0, 0.0, 1.0]]))[0]
    return last.r[-1, 0] / LENGTH, 1.0 - last.r[-1, 2] / LENGTH, atan2(tangent[0], tangent[2])


def rows() -> list[Row]:
    """Each quantity extrapolated from N = 100 and 200 to the six digits of the table, and its order in ds."""
    table = []
    for alpha in ALPHAS:
        runs = {n: at_rest(alpha, fixed_steps(n, STEP, rho_inf=0.5)) for n in (25, 50, 100, 200)}
        reference = exact(alpha)
        for i, name in enumerate(NAMES):
            label = f"elastica alpha={alpha:g} {name}"
            limit = (4 * runs[200][i] - runs[100][i]) / 3
            table.append(against(f"{label}, extrapolated", limit, TABLE[alpha][i], 1e-6))
            errors = [abs(runs[n][i] - reference[i]) for n in (25, 50, 100, 200)]
            for n, coarse, fine in zip((25, 50, 100), errors, errors[1:], strict=False):
                table.append(observed_order(f"{label}, order N={n}/{2 * n}", coarse, fine))
        table.append(_with_step_control(alpha, runs[25][0]))
    return table


def _with_step_control(alpha: float, deflection: float) -> Row:
    """The same rest must be reached by steps that the solver chooses itself; a run that fails is NaN."""
    name = f"elastica alpha={alpha:g} w/L, steps chosen, N=25"
    try:
        return against(name, at_rest(alpha, Numerics(intervals=25, dt_max=2 * STEP))[0], deflection, 1e-8)
    except RunFailed:
        return against(name, nan, deflection, 1e-8)
