"""A viscosity of the rod's material that damps waves which are too short for a mesh.

A limp rope that falls or whips bends within ever shorter parts of itself, until a fold is shorter than the intervals of
any mesh. What is shown then is no rod. With a retardation time tau (see `physics.elasticity.Viscosity`) bending waves
of the wavenumber k, of frequency k^2 sqrt(EJ / m), are damped within one period where tau k^2 sqrt(EJ / m) = 2. So

    tau = 8^grade h^2 sqrt(m / EJ),

which falls with h^2 as the mesh's own error does, damps waves of some few intervals at grade 0, and longer ones at
higher grades: those of a taut rope are faster than by bending alone. Waves as long as the rod are hardly damped: tau is
at most L^2 sqrt(m / EJ) / 4. (As von Neumann & Richtmyer, J. Appl. Phys. 21 (1950) 232, spread shocks over a few
intervals of a mesh.)
"""

from __future__ import annotations

from dataclasses import replace
from math import floor, log, pi

import numpy as np

from solver.arrays import Array
from solver.physics.elasticity import Viscosity
from solver.scene.rod import Derived, Rod
from solver.scene.scene import Scene

BY_GRADE = 8.0
"""How many times longer the retardation time is for each grade: waves are damped that are twice as long, where the
rope's tension makes them run."""
MOST = 0.25
"""Of the retardation time in L^2 sqrt(m / EJ)."""
SETTLED, DENSE = 2.0, 0.05
"""Damping (1/s) in that by which a motion falls to 1/e within a run; and a fluid's density, times its drag, in the
rod's, from which on it brakes."""
DAMPED_ALREADY = 2.0
"""Damping (1/s), in the angular frequency of a bending wave, with which that wave is none."""


def with_viscosity(rod: Rod, intervals: int, grade: int) -> Rod:
    """The rod, its material with an artificial viscosity of a `grade` from 0 on besides its own, for a mesh."""
    scale = BY_GRADE**grade * (float(rod.length) / intervals) ** 2

    def time(mass: Array, EJ1: Array, EJ2: Array) -> Array:
        return np.asarray(scale * np.sqrt(mass / np.sqrt(EJ1 * EJ2)))

    return replace(rod, laws=(*rod.laws, Viscosity(Derived(time, rod.mass, *rod.stiffness[:2]))))


def has_waves(scene: Scene, intervals: int) -> bool:
    """Whether bending waves of two intervals, the shortest of a mesh, are more than the scene's own damping lets be."""
    s = np.linspace(0.0, float(scene.rod.length), 101)
    stiffness = np.sqrt(scene.rod.stiffness[0](s) * scene.rod.stiffness[1](s))
    k = pi * intervals / float(scene.rod.length)
    return bool(scene.damping_rate < DAMPED_ALREADY * k**2 * np.sqrt(np.max(stiffness / scene.rod.mass(s))))


def is_damped(scene: Scene) -> bool:
    """Whether most of what moves at some time has come to rest long before the end, by damping or in a fluid."""
    rod, fluid = scene.rod, scene.fluid
    if scene.damping_rate * scene.t_end > SETTLED or fluid is None:
        return scene.damping_rate * scene.t_end > SETTLED
    s = np.linspace(0.0, float(rod.length), 101)
    taken_along = 0.25 * pi * fluid.density * np.asarray(rod.diameter(s)) ** 2 * fluid.drag_normal
    return bool(np.mean(taken_along) > DENSE * np.mean(rod.mass(s) + 0.0 * s))


def highest_grade(intervals: int) -> int:
    """That a mesh may have."""
    return max(floor(log(MOST * intervals**2) / log(BY_GRADE) + 1e-9), 0)


def retardation_time(rod: Rod) -> float:
    """The longest along the rod (s), of all its laws."""
    s = np.linspace(0.0, float(rod.length), 101)
    return float(sum(np.max(law.time(s)) for law in rod.laws if isinstance(law, Viscosity)))
