"""The law of contact where no constants are given: from the rod's own data, and from what its ends do to it.

How hard strands press on each other is taken from the plectoneme at rest of Clauvelin, Audoly & Neukirch, Biophys. J.
96 (2009) 3716: two strands of bending stiffness B = EJ and radius R, wound at the superhelical angle x, under the
pull F,

    F R^2 / B = sin^3 x (cos x tan 2x - sin x / 2),    p = (8 B / D^3) sin^4 x / cos 2x,
    M = (2 / sin 2x) (B sin^4 x / (2 R) + R F),    2 pi n = M L / GJ + l sin 2x / D,

p the force of one on the other per length. A pull tells x; where the ends are held instead, the turns n do that they
put in, of which the length l that the ends give way by takes up what the twist does not. In motion they rest a few per
cent of D from touching, as the pressure is taken with a margin. As d goes with the log of the pressure, divided by
16 / D, a pressure that is wrong by a factor of 3 moves it by 7 % of D, half as much at rest.
"""

from __future__ import annotations

from math import inf, pi
from typing import NamedTuple

import numpy as np

from solver.arrays import Array
from solver.kernels.rotation import rotate
from solver.physics.contact.automatic import POWER
from solver.physics.elasticity import elasticity_of, principal
from solver.physics.ends import travelled
from solver.scene.contact import Contact
from solver.scene.ends import Component
from solver.scene.layout import nodes_at_rest
from solver.scene.rod import Rod
from solver.scene.scene import Scene

SKIP = 4.0
"""In D: arc below which two points are neighbours."""
ANGLES = np.linspace(1e-3, np.radians(40.0), 2000)
"""Superhelical angles (rad); towards 45 degrees both F and p grow beyond all bounds."""
SLACK = (0.1, 0.8)
"""Part of the rod that winds up, at the least and, if nothing holds the ends, at the most."""
SMALL_PULL = 4.0
"""In pi^2 EJ / L^2: up to there the turns, not the pull, tell how the strands are wound."""
SAMPLES = 201
ALIGNED = 0.9
"""Cosine of the angle at which the two ends of a ring may meet, at the least."""


class Hardness(NamedTuple):
    """How hard the surfaces are: in D where the law has its `pole` and the `spacing` of points, and by what `margin` it
    is stronger than the pressure that is foreseen."""

    pole: float
    spacing: float
    margin: float


IN_MOTION = Hardness(0.5, 0.4, 3.0)


class Foreseen(NamedTuple):
    """What the ends do to the rod: the most turns they put in, the largest pull (N), by what part of its length they
    give way; and, of a ring, the way (m) from its end on to its start, infinite for other rods."""

    turns: float = 0.0
    pull: float = 0.0
    slack: float = SLACK[1]
    closing: float = inf


NOTHING = Foreseen()


class Held(NamedTuple):
    """The law: P (N/m^2) at the points (M,), and its relaxation time (s); see `automatic`."""

    strength: Array
    relaxation: float


def spaced(contact: Contact, rod: Rod, hardness: Hardness = IN_MOTION) -> Contact:
    """The contact with its `skip`, `spacing` and `cutoff`, and no forces of eq. (6)."""
    D = np.asarray(rod.diameter(np.linspace(0.0, rod.length, SAMPLES)))
    skip = contact.skip or min(SKIP * float(D.max()), rod.length)
    reach, spacing = (2.0 - hardness.pole) * float(D.max()), hardness.spacing * float(D.min())
    return Contact(0.0, 0.0, 0.0, 0.0, pi, reach, skip, contact.spacing or spacing)


def held(rod: Rod, foreseen: Foreseen, at: Array, hardness: Hardness = IN_MOTION) -> Held:
    """The law for points at arclengths `at` (M,)."""
    D, mass = np.asarray(rod.diameter(at)), np.asarray(rod.mass(at))
    stiffness = principal(elasticity_of(rod, at))
    B, GJ = stiffness[:, :2].mean(axis=1), stiffness[:, 2]
    euler = pi**2 * B / rod.length**2
    x = np.interp(np.maximum(foreseen.pull, euler) * (D / 2) ** 2 / B, _pull(ANGLES), ANGLES)
    turns = float(np.mean(B / GJ)) * _moment(ANGLES) + foreseen.slack * np.sin(2 * ANGLES)
    wound = np.interp(2 * pi * D * foreseen.turns / rod.length, turns, ANGLES)
    x = np.where(foreseen.pull <= SMALL_PULL * euler, np.maximum(x, wound), x)
    pressure = hardness.margin * 8.0 * B / D**3 * np.sin(x) ** 4 / np.cos(2 * x)
    steepness = 2 * POWER / (1 - hardness.pole) * pressure / D  # by which a strand's pressure falls as it goes
    half_critical = float(np.sqrt(0.5 * mass / steepness).min())
    return Held(pressure / (_width(hardness.pole) * D), half_critical)


def foreseen(scene: Scene) -> Foreseen:
    """What the ends of a scene will have done by its end, as far as it can be known before."""
    if scene.contact is None:
        return NOTHING
    if not scene.contact.automatic:
        return Foreseen(closing=_closing(scene))
    t = np.linspace(0.0, scene.t_end, SAMPLES)
    turns = _turns(scene, t)
    most = SAMPLES - 1 - int(np.argmax(turns[::-1]))  # the last time of all, if they stay
    return Foreseen(float(turns[most]), _largest_pull(scene, t), float(_slack(scene, t)[most]), _closing(scene))


def _closing(scene: Scene) -> float:
    """The way (m) from the end of a ring on to its start; infinite where the rod does not go on there."""
    r, orientation, _ = nodes_at_rest(scene.initial, np.linspace(0.0, scene.rod.length, SAMPLES))
    tangents = rotate(orientation[[0, -1]], np.tile([0.0, 0.0, 1.0], (2, 1)))
    way, D = r[0] - r[-1], float(np.asarray(scene.rod.diameter(np.zeros(1)))[0])
    along = float(way @ tangents[1])
    across = float(np.linalg.norm(way - along * tangents[1]))
    goes_on = tangents[0] @ tangents[1] > ALIGNED and across < 0.5 * D and along > -0.5 * D
    return max(along, 0.0) if goes_on else inf


def _pull(x: Array) -> Array:
    """F R^2 / B of the plectoneme at rest."""
    return np.asarray(np.sin(x) ** 3 * (np.cos(x) * np.tan(2 * x) - 0.5 * np.sin(x)))


def _moment(x: Array) -> Array:
    """M D / B of the plectoneme at rest."""
    return np.asarray(2.0 / np.sin(2 * x) * (np.sin(x) ** 4 + 2.0 * _pull(x)))


def _width(pole: float) -> float:
    """The force of a straight strand on a point of another, D apart, over P D: the integral of f cos along it."""
    reach = 2.0 - pole
    s = np.linspace(-reach, reach, 4001)
    d = np.sqrt(1.0 + s * s)
    f = np.where(d < reach, ((reach - d) / (d - pole)) ** POWER, 0.0)
    return float(np.trapezoid(f / d, s))


def _turns(scene: Scene, t: Array) -> Array:
    """The turns that the rod holds at each time: of the ends, by a moment at an end, and at the start."""
    rod = scene.rod
    s = np.linspace(0.0, rod.length, SAMPLES)
    twist = np.asarray(scene.initial.twist(s)) + np.zeros_like(s)
    at_start = twist[-1] - twist[0] - float(np.trapezoid(np.asarray(rod.kappa0[2](s)) + np.zeros_like(s), s))
    turned = at_start + _travel(scene.end.rotation[2], t) - _travel(scene.start.rotation[2], t)
    moment = np.maximum(*(np.abs(_loads(end.rotation[2], t)) for end in (scene.start, scene.end)))
    GJ = float(principal(elasticity_of(rod, s))[:, 2].min())
    return np.asarray(np.maximum(np.abs(turned), moment * rod.length / GJ) / (2 * pi))


def _slack(scene: Scene, t: Array) -> Array:
    """By what part of the rod's length the ends give way at each time."""
    ends = scene.start, scene.end
    if any(condition.kind == "load" for end in ends for component in end.translation for condition in component):
        return np.full(len(t), SLACK[1])
    from_, to = (np.stack([_travel(component, t) for component in end.translation]) for end in ends)
    places = np.asarray(scene.initial.centreline(np.array([0.0, scene.rod.length])))
    chord = np.linalg.norm((places[1] - places[0])[:, None] + to - from_, axis=0)
    return np.asarray(np.clip(1.0 - chord / scene.rod.length, *SLACK))


def _travel(component: Component, t: Array) -> Array:
    """How far an end has gone, or turned, until each time, as far as it is prescribed."""
    return np.array([travelled(component, x) for x in t])


def _loads(component: Component, t: Array) -> Array:
    """The force or moment that is given for a component at each time; 0 where its motion is."""
    load = np.zeros_like(t)
    for condition in component:
        if condition.kind == "load":
            load = np.where(t >= condition.since, condition.curve(t), load)
        else:
            load = np.where(t > condition.since, 0.0, load)
    return load


def _largest_pull(scene: Scene, t: Array) -> float:
    """The largest force (N) at an end, in a point or along the rod, its weight or a current's drag."""
    forces = [np.linalg.norm([_loads(c, t) for c in end.translation], axis=0).max() for end in (scene.start, scene.end)]
    forces += [np.linalg.norm([c(t) for c in load.force], axis=0).max() for load in scene.points]
    s = np.linspace(0.0, scene.rod.length, SAMPLES)

    def along(density: Array) -> float:
        return float(np.trapezoid(density + np.zeros_like(s), s))

    forces += [along(np.linalg.norm([p(s) + np.zeros_like(s) for p in load.force], axis=0))
               * np.abs(load.schedule(t)).max() for load in scene.distributed]  # fmt: skip
    if scene.fluid:
        fluid, speed, diameter = scene.fluid, scene.fluid.fastest, scene.rod.diameter(s) + 0.0 * s
        drag = 0.5 * fluid.density * (fluid.drag_normal + pi * fluid.drag_tangential) * speed**2 * diameter
        forces.append(along(drag + fluid.creeping_drag(diameter, float(scene.rod.length))[:, 0] * speed))
    weight = along(np.asarray(scene.rod.mass(s))) * float(np.linalg.norm(scene.gravity))
    return float(max([*forces, weight]))
