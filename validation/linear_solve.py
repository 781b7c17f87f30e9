"""The two linear solves: block elimination's backward error, and where shooting agrees with it and where it fails.

Backward error of A x = b, row by row: the largest |b - A x|_i / (|A_i|_1 |x|_max + |b|_i), which no scaling of the
equations flatters (the normwise one of Rigal & Gaches 1967 is smaller still).
Shooting loses as many digits as its homogeneous solutions grow by.
"""

from __future__ import annotations

import numpy as np

from solver import Curve, Numerics, Outcome, PointLoad, RunFailed, Scene, simulate
from solver.arrays import Array
from solver.methods.box import BoxMethod
from solver.scene.ends import End
from solver.scene.initial import Initial
from validation.free_flight import curled
from validation.rods import LENGTH, YOUNGS_MODULUS, rod_R
from validation.row import Row, at_most
from validation.system import NewtonSystem

DIAMETERS = (0.5e-3, 0.67e-3, 2e-3, 10e-3)
STEPS = (1e-4, 1e-3, 1e-2, 1e-1)
INTERVALS = (100, 400, 1000, 2000)
GROWTH = 1e8
"""Below it shooting keeps about eight of sixteen digits; hence the aim of 1e-7 for its difference."""


def disturbed(diameter: float, intervals: int, dt: float, ends: tuple[End, End]) -> NewtonSystem:
    """The assembled system of a curled rod with random rates, curvatures and forces of natural size."""
    scene = Scene(
        rod=rod_R(diameter), initial=Initial(centreline=curled), start=ends[0], end=ends[1], t_end=1.0,
        output_interval=1.0, numerics=Numerics(intervals=intervals, dt_max=dt), topology=False,
    )  # fmt: skip
    method = BoxMethod(scene)
    noise = np.random.default_rng(intervals).standard_normal(method.state.Y.shape)
    stiffness = YOUNGS_MODULUS * np.pi * diameter**4 / 64
    natural = np.repeat([0.01, 0.01, 0.1 / LENGTH, stiffness / LENGTH**2], 3)
    method.state.Y[:] += natural * noise
    system = NewtonSystem(method, dt)
    system.assemble()
    return system


def backward_error(system: NewtonSystem) -> float:
    """Of block elimination on an assembled system."""
    A, b = system.as_sparse()
    if not system.factor():
        return float("nan")
    x = system.solve()
    norms = np.asarray(abs(A).sum(axis=1)).ravel()
    return float(np.max(np.abs(b - A @ x) / (norms * np.abs(x).max() + np.abs(b))))


def shooting_difference(system: NewtonSystem) -> tuple[float, float]:
    """Difference of shooting's solution from block elimination's, relative to the largest, and shooting's growth."""
    shot, growth = system.shoot()
    system.factor()
    x: Array = system.solve()
    return float(np.abs(shot - x).max() / np.abs(x).max()), growth


def pushed(diameter: float, dt: float, solver: str, t_end: float) -> Scene:
    """A cantilever pushed across at its tip, solved by either solve."""
    zero = Curve.constant(0.0)
    push = Curve.table([0.0, t_end], [0.0, 2 * YOUNGS_MODULUS * np.pi * diameter**4 / 64 / LENGTH**2], "smoothstep")
    return Scene(
        rod=rod_R(diameter), initial=Initial.straight(), start=End.clamp(), end=End.free(), t_end=t_end,
        output_interval=t_end, points=(PointLoad(LENGTH, force=(push, zero, zero)),),
        numerics=Numerics(intervals=100, dt_max=dt, linear_solver=solver), topology=False,
    )  # fmt: skip


def runs_differ(diameter: float, dt: float) -> Row:
    """A whole run by each solve. Shooting refuses some steps, so the two may differ as by halving dt."""
    name = f"shooting, whole run, D {1e3 * diameter:g} mm, dt {dt:g} s, difference (m)"
    block, finer = (list(simulate(pushed(diameter, step, "block_elimination", 40 * dt)))[-1].r for step in (dt, dt / 2))
    aim = float(np.abs(block - finer).max())
    try:
        *_, shot = simulate(pushed(diameter, dt, "shooting", 40 * dt))
    except RunFailed as failure:
        print(f"{name}: {failure}")
        return at_most(name, float("nan"), aim)
    return at_most(name, float(np.abs(block - shot.r).max()), aim)


def missed_outcome(diameter: float, dt: float) -> float:
    """0 if the run by shooting ends with `shooting_lost_digits`, else 1."""
    try:
        list(simulate(pushed(diameter, dt, "shooting", 40 * dt)))
    except RunFailed as failure:
        return float(failure.outcome != Outcome.SHOOTING_LOST_DIGITS)
    return 1.0


def rows() -> list[Row]:
    """The worst backward error for each N, shooting's worst difference, and its failure where growth is 1e71."""
    clamped = (End.clamp(), End.free())
    table = []
    for N in INTERVALS:
        worst = max(backward_error(disturbed(D, N, dt, clamped)) for D in DIAMETERS for dt in STEPS)
        table.append(at_most(f"block elimination, backward error, N={N}, D .5-10 mm, dt 1e-4-.1 s", worst, 1e-14))
    compared = [shooting_difference(disturbed(D, 100, dt, clamped)) for D in DIAMETERS for dt in STEPS]
    agreeing = [difference for difference, growth in compared if growth < GROWTH]
    table.append(at_most(f"shooting, difference where growth < 1e8 ({len(agreeing)} systems)", max(agreeing), 1e-7))
    table.append(runs_differ(10e-3, 0.1))
    table.append(at_most("shooting fails by name, D .67 mm, dt 3 ms", missed_outcome(0.67e-3, 3e-3), 0.0))
    return table


