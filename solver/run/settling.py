"""Where a rod comes to rest that is let go and braked: what motion finds where no branch of equilibria leads.

A limp rod that lies far from where it will hang has no equilibria between, or too many. In motion it falls, swings out
and rests, and what it rests in is stable. (Dynamic relaxation: Day 1965; Barnes, Int. J. Space Structures 14, 1999.)
It is damped at the rate `BRAKING` w by the frequency of its slowest motion across,

    w^2 = 3.516^2 EJ / (m L^4) + b / (m L),

with m its mass per length and b the mean force per length that holds its initial shape.
"""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from solver.methods.staggered import StaggeredMethod
from solver.outcome import RunFailed
from solver.run.simulation import Simulation
from solver.scene.curve import Curve, Vector
from solver.scene.ends import Component, Condition, End
from solver.scene.numerics import Numerics
from solver.scene.scene import Scene
from solver.statics.equations import Equations
from solver.statics.point import Point, X

CANTILEVER = 3.516
BRAKING = 10.0, 100.0
"""Damping, in w: a rod that whips so far that its mesh does not say how it lies is braked more."""
LOOKS, LONGEST = 1.0, 1000.0
"""After what time it is seen how fast the rod moves; and for how long it may, both in 1 / w."""
FIRST_LOOKS = 5
"""How often that is seen at the least: what falls from where it is balanced takes its time."""
AT_REST = 1e-10
"""Part of the largest kinetic energy with which the rod rests."""
MOST_STEPS = 5000
"""Steps after which it is taken as it is."""
LOOSELY = 0.1
"""Part of its motion that an error of a step may be: where the rod rests there is none."""


class Rest(NamedTuple):
    """Where a rod rests, the energy (J) that its contact stores there, and what it took to find it (us, as
    `solver.methods.cost` counts)."""

    point: Point
    energy_contact: float
    work: float


def settled(equations: Equations, scene: Scene) -> Rest:
    """Where the rod of a scene rests with loads and ends as they are at t = 0. `equations` hold it where it lies.

    Raises RunFailed where the motion cannot be followed.
    """
    try:
        return _rest(_braked(equations, scene, BRAKING[0]))
    except RunFailed:
        return _rest(_braked(equations, scene, BRAKING[1]))


def _rest(moving: Scene) -> Rest:
    """Where the rod of a scene of motion rests."""
    method = StaggeredMethod(moving)
    run = Simulation(moving, goes_on=True, method=method)
    fastest, stored, looks = 0.0, 0.0, 0
    while not run.finished and run.statistics.steps < MOST_STEPS:
        frame = run.advance()
        if frame is None:
            continue
        looks, fastest = looks + 1, max(fastest, frame.energy_kinetic)
        stored = frame.energy_contact if frame.contacts else 0.0
        if looks > FIRST_LOOKS and frame.energy_kinetic <= AT_REST * fastest:
            break
    state, statistics = method.state, run.statistics
    point = Point(state.quaternion.copy(), state.base[0].copy(), state.F.copy(), 0.0)
    return Rest(point, stored, run.counted(statistics.steps, statistics.newton_iterations))


def _braked(equations: Equations, scene: Scene, braking: float) -> Scene:
    """The scene as one of motion, whose loads and ends stay as they are at t = 0."""
    length, mass = float(scene.rod.length), float(equations.chain.mass.sum())
    holding = np.linalg.norm(equations.holding[1:-1, X], axis=1).sum() * equations.units[-1]
    stiffness = CANTILEVER**2 * equations.stiffness / length**3 + holding / length
    frequency = float(np.sqrt(stiffness / mass))
    return replace(
        scene, analysis="dynamic", topology=scene.contact is not None, damping=scene.damping + braking * frequency,
        start=_at_first(scene.start), end=_at_first(scene.end), t_end=LONGEST / frequency,
        output_interval=LOOKS / frequency,
        distributed=tuple(replace(load, schedule=_constant(load.schedule)) for load in scene.distributed),
        points=tuple(replace(load, force=_constants(load.force), moment=_constants(load.moment))
                     for load in scene.points),
        numerics=Numerics(method="staggered", intervals=scene.numerics.intervals, dt_max=LOOKS / frequency,
                          increment_tolerance=LOOSELY),
    )  # fmt: skip


def _constant(curve: Curve) -> Curve:
    return Curve.constant(curve.value(0.0))


def _constants(curves: Vector) -> Vector:
    one, two, three = (_constant(curve) for curve in curves)
    return one, two, three


def _at_first(end: End) -> End:
    """An end that is held where it is, and loaded as at t = 0."""

    def component(given: Component) -> Component:
        first = given[0]
        return (Condition("load", _constant(first.curve)) if first.kind == "load" else Condition("rate"),)

    (one, two, three), (a, b, c) = end.translation, end.rotation
    return replace(end, translation=(component(one), component(two), component(three)),
                   rotation=(component(a), component(b), component(c)))  # fmt: skip
