"""Localised helical buckling of a rod that is twisted by 27 turns and shortened by 3 %: PyElastica's own case.

Gazzola et al., R. Soc. Open Sci. 5 (2018) 171628, 3.4.1. The envelope is that of the homoclinic solution, van der
Heijden & Thompson, Nonlinear Dynamics 21 (2000) 71, with M L/B and T L^2/B that satisfy the end rotation and the end
shortening of van der Heijden et al., Int. J. Mech. Sci. 45 (2003) 161. MuJoCo's cable is a tree and could hold its far
end by soft constraints only: not run. The hump forms of two that creep together, which the box method's errors pin
where they are on all meshes but the finest (docs/decisions/0002).
"""

from __future__ import annotations

from functools import partial
from math import acos, pi, sqrt

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.optimize import fsolve

from benchmarks.work_precision.measure import AS_IT_COMES, PYELASTICA, Measured, Run, Stopwatch
from benchmarks.work_precision.peers import pyelastica_helix
from benchmarks.work_precision.scenes.ladder import box, hockle_runs, staggered
from solver import FIXED, Condition, Curve, End, Initial, Numerics, Rod, Scene, simulate
from solver.arrays import Array

SCENE = "helical buckling"
LENGTH, RADIUS = 100.0, 0.35
B, C = 1.345, 0.789
TURNS, SLACK = 27.0, 3.0
RAMP, REST, DAMPING = 500.0, 1000.0, 0.05
"""s, s, 1/s: at rest to 1e-6 of the energy."""
SEED, SEED_WIDTH, SEED_WAVE = 0.2, 10.0, 0.5
"""rad, m, rad/m: a wavelet at mid-span, since a straight rod that cannot stretch cannot be shortened. It is even in the
slope, as the hump is: a seed that is odd leads to two humps, an equilibrium that is not stable."""


def _loads() -> tuple[float, float]:
    """M L/B and T L^2/B."""

    def mismatch(x: Array) -> list[float]:
        M, T = x
        shortening = sqrt(16.0 / T * (1.0 - M * M / (4.0 * T)))
        rotation = M * B / C + 4.0 * acos(M / (2.0 * sqrt(T)))
        return [shortening - SLACK / LENGTH, rotation - 2 * pi * TURNS]

    M, T = fsolve(mismatch, [98.5, 2901.0], xtol=1e-13)
    return float(M), float(T)


def envelope(s: Array) -> Array:
    """(cos theta - cos theta_max) / (1 - cos theta_max) at arclengths s (n,), theta between tangent and axis."""
    M, T = _loads()
    return np.asarray(1.0 - 1.0 / np.cosh((s / LENGTH - 0.5) * sqrt(T - 0.25 * M * M)) ** 2)


def judge(r: Array, first: float, cpu: float) -> dict[str, Measured]:
    """Root mean square error of the envelope, from nodes (n, 3) of which the first is at arclength `first`."""
    steps = np.diff(r, axis=0)
    lengths = np.linalg.norm(steps, axis=1)
    cosine = steps[:, 2] / lengths
    s = first + np.cumsum(lengths) - 0.5 * lengths
    inside = (s >= 0.0) & (s <= LENGTH)
    shape = (cosine - cosine.min()) / (1.0 - cosine.min())
    error = np.sqrt(np.mean((shape - envelope(s))[inside] ** 2))
    return {"envelope": Measured(cpu, float(error), float(cosine.min()))}


def _wavelet() -> tuple[Initial, float]:
    """The rod at the start, and by how much the wavelet shortens it (m)."""
    fine = np.linspace(0.0, LENGTH, 2001)
    x = fine - 0.5 * LENGTH
    angle = SEED * np.cos(SEED_WAVE * x) * np.exp(-0.5 * (x / SEED_WIDTH) ** 2)
    across, along = (CubicSpline(fine, f(angle)).antiderivative() for f in (np.sin, np.cos))
    shape = Initial(lambda s: np.stack([across(s), np.zeros_like(s), along(s)], axis=1))
    return shape, LENGTH - float(along(LENGTH))


def _scene(numerics: Numerics) -> Scene:
    """Both ends are driven, each by half: the hump then stays in the middle, where the formula has it."""
    shape, shortened = _wavelet()

    def driven(sign: float) -> End:
        slack = Curve.table([0.0, RAMP], [0.0, sign * 0.5 * (SLACK - shortened)], "smoothstep")
        turn = Curve.table([0.0, RAMP], [0.0, -sign * pi * TURNS], "smoothstep")
        return End((FIXED, FIXED, (Condition("position", slack),)), (FIXED, FIXED, (Condition("position", turn),)),
                   frame="lab")  # fmt: skip

    constant = Curve.constant
    about = RADIUS**2 / 4
    rod = Rod(LENGTH, (constant(B), constant(B), constant(C)), constant(1.0),
              (constant(about), constant(about), constant(2 * about)), constant(2 * RADIUS))  # fmt: skip
    return Scene(rod, shape, driven(1.0), driven(-1.0), REST, 0.5 * REST, damping=DAMPING, numerics=numerics,
                 topology=False)  # fmt: skip


def _by_us(numerics: Numerics) -> dict[str, Measured]:
    watch = Stopwatch()
    *_, last = simulate(_scene(numerics))
    return judge(last.r, 0.0, watch.read())


def _by_pyelastica(elements: int, corrected: bool) -> dict[str, Measured]:
    r, cpu = pyelastica_helix.solve(elements, corrected, LENGTH, RADIUS, (B, B, C), TURNS, SLACK, RAMP, REST, DAMPING)
    first = -0.5 * LENGTH / (elements - 1) if corrected else 0.0
    return judge(r, first, cpu)


def runs() -> list[Run]:
    """By hockle and PyElastica."""
    boxes = [box(n, 100.0 / n, 0.5, 0.1) for n in (100, 200, 400, 800, 1600)]
    resolutions = [(50, True), (100, True), (200, True), (100, False)]
    peers = [Run(SCENE, PYELASTICA + ("" if corrected else AS_IT_COMES), f"{n} elements",
                 partial(_by_pyelastica, n, corrected)) for n, corrected in resolutions]  # fmt: skip
    return [*hockle_runs(SCENE, boxes, [staggered(n, 100.0, 1e-2) for n in (50, 100, 200, 400, 800)], _by_us), *peers]
