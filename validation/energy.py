"""Energy of an undamped rod that nothing drives: with rho_inf = 1 it must stay what it was at the start."""

from __future__ import annotations

from math import pi

import numpy as np
from scipy.interpolate import CubicSpline

from solver import End, Frame, Initial, Scene, simulate
from solver.arrays import Array
from validation.cantilever import BENDING, bent, vibration
from validation.rods import LENGTH, fixed_steps, rod_R
from validation.row import Row, at_most


def curled() -> Initial:
    """A rod whose tangent turns by 2 rad one way and 1 rad the other, its curvature fading at the tip."""
    fine = np.linspace(0.0, 1.0, 2001)
    fade = 1.5 * (fine - fine**3 / 3)
    polar, azimuth = 2.0 * fade, 1.0 * fade
    tangent = np.stack([np.sin(polar) * np.cos(azimuth), np.sin(polar) * np.sin(azimuth), np.cos(polar)], axis=1)
    curve = CubicSpline(LENGTH * fine, tangent).antiderivative()

    def centreline(s: Array) -> Array:
        return np.asarray(curve(s), dtype=float)

    return Initial(centreline=centreline)


def release(intervals: int, dt: float, t_end: float) -> Scene:
    """The curled rod, straight when at rest, clamped at its start and let go."""
    return Scene(
        rod=rod_R(), initial=curled(), start=End.clamp(), end=End.free(), t_end=t_end, output_interval=10 * dt,
        numerics=fixed_steps(intervals, dt), topology=False,
    )  # fmt: skip


def total(frame: Frame) -> float:
    """Bending, torsion and kinetic energy."""
    return frame.energy_bending + frame.energy_torsion + frame.energy_kinetic


def largest_change(scene: Scene) -> float:
    """The largest change of the energy, relative to what it was at t = 0."""
    energies = np.array([total(frame) for frame in simulate(scene)])
    return float(np.abs(energies / energies[0] - 1.0).max())


def rows() -> list[Row]:
    """Small vibration over six periods of 100 steps; large motion in three dimensions for 10 s of 2.5 ms steps."""
    small = vibration(bent(0), 2 * pi / BENDING[0], 100, 100)
    return [
        at_most("energy, linear cantilever, 6 periods, T/100", largest_change(small), 4e-7),
        at_most("energy, large 3-D motion, 10 s, dt 2.5 ms, N=200", largest_change(release(200, 2.5e-3, 10.0)), 2.6e-4),
    ]
