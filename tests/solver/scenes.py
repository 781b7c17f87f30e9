"""A rod, its numerics, and how a run is asked for: what the solver's tests share."""

from __future__ import annotations

from dataclasses import replace
from math import pi

import numpy as np

from solver import Condition, Curve, End, Frame, Initial, Numerics, Rod, Scene, simulate
from solver.arrays import Array
from solver.kernels.rotation import rotate
from solver.scene.ends import FIXED

LENGTH, DIAMETER = 1.0, 0.01
YOUNGS_MODULUS, SHEAR_MODULUS, DENSITY = 1.25e7, 5e6, 1500.0
MASS = DENSITY * pi * DIAMETER**2 / 4
EJ = YOUNGS_MODULUS * pi * DIAMETER**4 / 64
GJ = SHEAR_MODULUS * pi * DIAMETER**4 / 32
SPIN_INERTIA = DENSITY * pi * DIAMETER**4 / 32
FIXED_STEPS = 1e9
"""An increment_tolerance that leaves the step at dt_max, after the first few that grow up to it."""

ROD = Rod.circular(LENGTH, DIAMETER, YOUNGS_MODULUS, SHEAR_MODULUS, DENSITY)

BEND = 2.0
"""Angle (rad) by which the arc turns."""
ARC_ROD = replace(ROD, kappa0=(Curve.constant(0.0), Curve.constant(BEND / LENGTH), Curve.constant(0.0)))
"""The same rod, free of stress as an arc: unlike a straight one it may be held or moved at both ends."""


def arc(s: Array) -> Array:
    """A circular arc in the e1-e3 plane that starts along e3."""
    angle, radius = BEND * s / LENGTH, LENGTH / BEND
    return np.column_stack([radius * (1.0 - np.cos(angle)), np.zeros_like(s), radius * np.sin(angle)])


ARC = Initial(arc)

ROPE = Rod.circular(length=1.0, diameter=5e-3, youngs_modulus=2.1e5, shear_modulus=8e4, density=1000.0)
"""Limp: its weight times L^2 is 30,000 times its bending stiffness."""


def rope_let_go() -> Scene:
    """From the horizontal, at a pin, without damping."""
    level = Initial.straight(direction=(1.0, 0.0, 0.0))
    return Scene(ROPE, level, End.pin(), End.free(), t_end=4.0, output_interval=0.1, gravity=(0.0, 0.0, -9.81),
                 numerics=Numerics("staggered", tolerance=1e-3))  # fmt: skip


def fixed_steps(intervals: int, dt: float, rho_inf: float = 0.5) -> Numerics:
    """Numerics with steps of dt."""
    return Numerics(intervals=intervals, dt_max=dt, rho_inf=rho_inf, increment_tolerance=FIXED_STEPS)


def turned_clamp(condition: Condition) -> End:
    """A clamp that a condition turns about its tangent."""
    return End((FIXED, FIXED, FIXED), (FIXED, FIXED, (condition,)))


def moved_clamp(*along: Curve) -> End:
    """A clamp that is displaced along e1, e2, e3."""
    one, two, three = ((Condition("position", curve),) for curve in along)
    return End((one, two, three), (FIXED, FIXED, FIXED), frame="lab")


def last(scene: Scene) -> Frame:
    """The last frame of a run."""
    *_, frame = simulate(scene)
    return frame


def tangents(frame: Frame) -> Array:
    """a3 at the nodes, lab."""
    return rotate(frame.orientation, np.tile([0.0, 0.0, 1.0], (len(frame.r), 1)))


def energy(frame: Frame) -> float:
    """All that is stored."""
    moving = frame.energy_kinetic + frame.energy_added_mass
    strained = frame.energy_bending + frame.energy_torsion + frame.energy_stretching
    return strained + moving + frame.energy_potential + frame.energy_contact
