"""At what twist a rod buckles, and how a small disturbance of a straight one grows, by what presses or twists it as if
it were at rest."""

from __future__ import annotations

from dataclasses import replace
from math import inf
from typing import Any

import numpy as np

from solver import Initial, Scene
from solver.kernels.rotation import rotate
from solver.measures.buckling import STRAIGHT, Disturbance, Transverse
from solver.physics.elasticity import elasticity_of, principal
from solver.physics.ends import travel
from solver.physics.section import sample
from solver.scene.ends import Component, End
from solver.scene.layout import nodes_at_rest
from solver.scene.rod import NO_CURVATURE

TIMES, PLACES, INTERVALS = 21, 65, 16
"""At which it is looked at, and of what is needed only about."""
NEARLY = 0.9
"""Part of its length that the distance of a rod's ends is at least, if it is nearly straight."""
GREENHILL = 8.987
"""Torque, in EJ/L, at which a straight rod with clamped ends buckles (Greenhill 1883)."""


def growth(scene: Scene, axis: Any) -> float:
    """The logarithm of the factor by which it would grow until t_end, of a rod along the lab's `axis` (3,); of a static
    analysis, in which nothing grows, inf where it is unstable at any time."""
    transverse = Transverse.of(scene)
    if transverse is None or transverse.p != STRAIGHT:
        return 0.0
    s, (dt, *_) = np.linspace(0.0, scene.rod.length, PLACES), np.diff(np.linspace(0.0, scene.t_end, TIMES))
    torsion, disturbance = scene.rod.stiffness[2](s) + 0.0 * s, Disturbance(transverse, scene.damping_rate)
    for t in dt * np.arange(1, TIMES):
        torque = _torque(scene, axis, s, torsion, t)
        stiffness = transverse.straight(s, torque / torsion, torque, _tension(scene, axis, s, t))
        if scene.at_rest and disturbance.grows(stiffness):
            return inf
        disturbance.go_on(dt, stiffness)
    return 0.0 if scene.at_rest else disturbance.growth


def slowest_swing(scene: Scene) -> float:
    """The period (s) of its slowest swing across itself, at first, if it were laid straight from its start to its end;
    0 where it has none."""
    s = np.linspace(0.0, scene.rod.length, PLACES)
    r = nodes_at_rest(scene.initial, s)[0]
    axis = r[-1] - r[0] if np.linalg.norm(r[-1] - r[0]) > NEARLY * scene.rod.length else None
    if axis is None:
        return 0.0
    laid = replace(scene, initial=Initial.straight(direction=tuple(axis)), points=(), distributed=(), loads=(),
                   gravity=(0.0, 0.0, 0.0), fluid=None, rod=replace(scene.rod, kappa0=NO_CURVATURE))  # fmt: skip
    if (transverse := Transverse.of(laid)) is None:
        return 0.0
    tension = _tension(scene, axis / np.linalg.norm(axis), s, 0.0)
    squares = np.linalg.eigvalsh(transverse.straight(s, 0.0 * s, 0.0 * s, tension))
    swings = squares[squares > transverse.slow**2]
    return float(2.0 * np.pi / np.sqrt(swings.min())) if len(swings) else 0.0


def twisted_at_first(scene: Scene) -> float:
    """By how much (rad) the end is turned against the start at t = 0."""
    return float(np.diff(scene.initial.twist(np.array([0.0, scene.rod.length])))[0])


def critical_twist(scene: Scene) -> float:
    """The twist (rad) of its ends at which a rod buckles, if it is straight: its torque, with a tension T in EJ/L^2, is
    2 sqrt(T + (GREENHILL / 2)^2) EJ/L."""
    s = np.linspace(0.0, float(scene.rod.length), INTERVALS + 1)
    bending, torsion = stiffness_and_mass(scene)[0], float(principal(elasticity_of(scene.rod, s))[:, 2].mean())
    torque = 2.0 * np.sqrt(pull(scene) * scene.rod.length**2 / bending + 0.25 * GREENHILL**2)
    return float(torque * bending / torsion)


def pull(scene: Scene) -> float:
    """The force (N) that pulls at an end along the rod as it begins, at the end of the run."""
    _, quaternion, _ = nodes_at_rest(scene.initial, np.linspace(0.0, float(scene.rod.length), INTERVALS + 1))
    tangent = rotate(quaternion[[0, -1]], np.tile([0.0, 0.0, 1.0], (2, 1)))
    ends = zip((scene.start, scene.end), tangent, strict=True)
    return max(0.0, *(_along(end, along, scene.t_end) for end, along in ends))


def stiffness_and_mass(scene: Scene) -> tuple[float, float]:
    """EJ (N m^2) of the softer axis and mass per length (kg/m), their means along the rod."""
    s = np.linspace(0.0, scene.rod.length, INTERVALS + 1)
    softer = principal(elasticity_of(scene.rod, s))[:, :2].min(axis=1)
    return float(softer.mean()), float(sample(scene.rod, s).mass.mean())


def _along(end: End, tangent: Any, t: float) -> float:
    """The force (N) along the rod at an end that it leaves free, at a time."""
    loads = [c[0].curve.value(t) if c[0].kind == "load" else 0.0 for c in end.translation]
    return float(tangent @ loads if end.frame == "lab" else loads[2])


def _tension(scene: Scene, axis: Any, s: Any, t: float) -> Any:
    """f3 (N) at `s`; 0 where neither end gives way along the rod."""
    section, fluid = sample(scene.rod, s), scene.fluid
    mass = section.mass - (fluid.density * section.area if fluid else 0.0)
    pull = mass * float(np.dot(scene.gravity, axis))
    for load in scene.distributed:
        pull = pull + load.schedule.value(t) * sum(a * part(s) for a, part in zip(axis, load.force, strict=True))
    points = [(load.s, float(np.dot([curve.value(t) for curve in load.force], axis))) for load in scene.points]
    weights = [end.mass * float(np.dot(scene.gravity, axis)) for end in (scene.start, scene.end)]
    points += [(place, weight) for place, weight in zip((0.0, s[-1]), weights, strict=True) if weight]
    ends = [_given(_components(end, axis), t) for end in (scene.start, scene.end)]
    return _carried(s, pull, points, ends)


def _torque(scene: Scene, axis: Any, s: Any, torsion: Any, t: float) -> Any:
    """q3 (N m) at `s`."""
    ends = [_given([(1.0, end.rotation[2])], t) for end in (scene.start, scene.end)]
    if ends == [None, None]:
        turned = [travel(end.rotation[2][0], t) for end in (scene.start, scene.end)]
        twist = turned[1] - turned[0] + twisted_at_first(scene)
        return np.full(len(s), twist / float(np.trapezoid(1.0 / torsion, s)))
    points = [(load.s, float(np.dot([curve.value(t) for curve in load.moment], axis))) for load in scene.points]
    return _carried(s, 0.0 * s, points, ends)


def _carried(s: Any, spread: Any, points: list[tuple[float, float]], ends: list[float | None]) -> Any:
    """What the rod carries along itself at `s`: all that is given on that side of it where an end gives way."""
    before = np.append(0.0, np.cumsum(0.5 * np.diff(s) * (spread[1:] + spread[:-1])))
    before = before + sum((value * (s > place) for place, value in points), 0.0 * s)
    start, end = ends
    if end is not None:
        return end + before[-1] + sum(value for place, value in points if place >= s[-1]) - before
    return start - before if start is not None else 0.0 * s


def _components(end: End, axis: Any) -> list[tuple[float, Component]]:
    """Those of an end's translation that are along the rod, with how much."""
    parts = axis if end.frame == "lab" else (0.0, 0.0, 1.0)
    return [(float(part), component) for part, component in zip(parts, end.translation, strict=True) if part]


def _given(parts: list[tuple[float, Component]], t: float) -> float | None:
    """The load that is given at an end; None if it does not give way at first."""
    if any(component[0].kind != "load" for _, component in parts):
        return None
    return sum(part * component[0].curve.value(t) for part, component in parts)
