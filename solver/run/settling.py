"""Where a rod comes to rest that is let go and braked: what motion finds where no branch of equilibria leads.

A limp rod that lies far from where it will hang has no equilibria between, or too many. In motion it falls, swings out
and rests, and what it rests in is stable. (Dynamic relaxation: Day 1965; Barnes, Int. J. Space Structures 14, 1999.)
It is damped at the rate `BRAKING` w by the frequency of its slowest motion across,

    w^2 = 3.516^2 EJ / (m L^4) + b / (m L),

with m its mass per length and b the mean force per length that holds its initial shape. A rod that turns as a whole, as
nothing holds it against its first loads, bends by far faster: there w is by the second part alone, with b those loads.
"""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from solver.arrays import Array
from solver.methods.staggered import StaggeredMethod
from solver.outcome import Outcome, RunFailed
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
NOTHING = 1e-4
"""Force, in EJ/L^2, that does not turn a rod yet."""
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

    Raises RunFailed where the motion cannot be followed, or a run of motion does not take the scene.
    """
    stiffness = CANTILEVER**2 * equations.stiffness / float(scene.rod.length) ** 2
    return _settled(equations, scene, None, stiffness + _sum_of(equations.holding, equations), 0.0)


def turned(equations: Equations, scene: Scene, point: Point, t: float) -> Rest | None:
    """Where the rod rests with its loads as they are at t, which turn it as a whole from a `point`; None where they are
    next to nothing. Its ends stay.

    Raises RunFailed likewise.
    """
    point = replace(point, q=t / scene.t_end)
    force = _sum_of(equations.residual(point), equations)
    if force < NOTHING * equations.units[-1]:
        return None
    rest = _settled(equations, scene, point, force, t)
    return rest._replace(point=replace(rest.point, q=point.q))


def _sum_of(residual: Array, equations: Equations) -> float:
    """Of all forces (N) on segments and ends, by their size, of what is not balanced."""
    return float(np.linalg.norm(residual[:, X], axis=1).sum() * equations.units[-1])


def _settled(equations: Equations, scene: Scene, begin: Point | None, force: float, t: float) -> Rest:
    """From a point, or the scene's initial shape; `force` (N): by which the rod goes to where it rests."""
    frequency = float(np.sqrt(force / (equations.chain.mass.sum() * scene.rod.length)))
    try:
        moving = _braked(scene, frequency, BRAKING[0], t)
    except ValueError as refusal:
        raise RunFailed(Outcome.NO_CONSISTENT_START, t, 0, str(refusal)) from refusal
    try:
        return _rest(moving, begin)
    except RunFailed:
        return _rest(_braked(scene, frequency, BRAKING[1], t), begin)


def _rest(moving: Scene, begin: Point | None) -> Rest:
    """Where the rod of a scene of motion rests that begins at a point, or in its initial shape."""
    method = StaggeredMethod(moving)
    if begin:
        method.lay_at_rest(begin.quaternion, begin.base, begin.F)
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


def _braked(scene: Scene, frequency: float, braking: float, t: float) -> Scene:
    """The scene as one of motion, whose loads stay as they are at t, and its ends where they are."""
    fluid = scene.fluid and replace(scene.fluid, schedule=_constant(scene.fluid.schedule, t))
    return replace(
        scene, analysis="dynamic", topology=scene.contact is not None, damping=scene.damping + braking * frequency,
        start=_kept(scene.start, t), end=_kept(scene.end, t), t_end=LONGEST / frequency,
        output_interval=LOOKS / frequency, fluid=fluid,
        distributed=tuple(replace(load, schedule=_constant(load.schedule, t)) for load in scene.distributed),
        points=tuple(replace(load, force=_constants(load.force, t), moment=_constants(load.moment, t))
                     for load in scene.points),
        numerics=Numerics(method="staggered", intervals=scene.numerics.intervals, dt_max=LOOKS / frequency,
                          increment_tolerance=LOOSELY),
    )  # fmt: skip


def _constant(curve: Curve, t: float) -> Curve:
    return Curve.constant(curve.value(t))


def _constants(curves: Vector, t: float) -> Vector:
    one, two, three = (_constant(curve, t) for curve in curves)
    return one, two, three


def _kept(end: End, t: float) -> End:
    """An end that is held where it is, and loaded as at t."""

    def component(given: Component) -> Component:
        first = given[0]
        return (Condition("load", _constant(first.curve, t)) if first.kind == "load" else Condition("rate"),)

    (one, two, three), (a, b, c) = end.translation, end.rotation
    return replace(end, translation=(component(one), component(two), component(three)),
                   rotation=(component(a), component(b), component(c)))  # fmt: skip
