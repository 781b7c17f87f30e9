"""A rod that is pressed or twisted beyond buckling, where something must say to which side, and contact hold strands
apart."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import chain
from math import log, pi
from typing import Any

import numpy as np

from service.cases.case import CaseSpec
from service.cases.errors import FieldError
from service.cases.extents import times, widest
from service.cases.initial import Straight
from service.cases.solids import solids_of
from service.cases.stability import critical_twist, growth, stiffness_and_mass, twisted_at_first
from solver import End, Scene
from solver.kernels.rotation import rotate
from solver.measures.buckling import MUCH, stays_straight
from solver.physics.axial import distances, has_to_stretch
from solver.physics.ends import travel
from solver.physics.seed import seed_of
from solver.scene.layout import nodes_at_rest

PUSHED = 100.0
"""Push at an end, in pi^2 EJ/L^2, for which a pull is likely meant."""
ALONG = 0.9
"""Cosine of the angle between a force and the rod up to which it pulls or pushes."""
SHEARED = 0.5
"""Shear strain of a rod's surface beyond that of any material but rubber."""


def buckling_of(spec: CaseSpec, scene: Scene) -> list[FieldError]:
    """What a rod that buckles calls for."""
    return [*_contact(spec, scene), *_sheared(spec, scene), *_column(scene), *_unstable(spec, scene),
            *_pushed_in(spec, scene), *_pushed(scene)]  # fmt: skip


def _contact(spec: CaseSpec, scene: Scene) -> Iterator[FieldError]:
    """A rod that is twisted past buckling, and can give way, sooner or later touches itself."""
    if spec.contact is not None or not _gives_way(spec, scene):
        return
    turned, bearable = _turned(scene), critical_twist(scene)
    if turned > bearable:
        rule = (f"is not given, but the rod is twisted by {turned / (2 * pi):.3g} turns, and it buckles at "
                f"{bearable / (2 * pi):.3g}: it would pass through itself")
        yield FieldError("/contact", None, rule)


def _sheared(spec: CaseSpec, scene: Scene) -> Iterator[FieldError]:
    """Ends that wring the rod, as where turns were meant for rad, or rad/s last too long."""
    turned = _turned(scene)
    strain = 0.5 * widest(scene) * turned / spec.rod.length
    if strain > SHEARED:
        rule = (f"turn against each other by {turned / (2 * pi):.3g} turns: what is left as twist shears the rod's "
                f"surface by up to {strain:.2g}")
        yield FieldError("/ends", None, rule)


def _column(scene: Scene) -> Iterator[FieldError]:
    """A straight rod that its ends shorten beyond its critical load, with no load across it."""
    apart = distances(scene)
    if seed_of(scene) is not None and apart is not None:
        rule = (f"has nothing across the rod, which is straight and whose ends come {apart[0] - apart.min():.3g} m "
                "nearer to each other: a small load is added across it, so that it buckles; one of your own says to "
                "which side")  # fmt: skip
        yield FieldError("/loads", None, rule)


def _unstable(spec: CaseSpec, scene: Scene) -> Iterator[FieldError]:
    """A straight rod that is loaded beyond its critical load or torque, with no load across it."""
    if has_to_stretch(scene) or (axis := _kept_straight(spec, scene)) is None:
        return
    if (grows := growth(scene, axis)) > MUCH:
        so = "no rod stays so, but nothing says to which side it leaves"
        if not scene.at_rest:
            so = f"a small disturbance would grow by a factor of 1e{grows / log(10.0):.0f}, but there is none"
        rule = ("has nothing across the rod, which is straight and pressed, or twisted, beyond its critical load: "
                f"{so}; add a small load across it, which says to which side it buckles")
        yield FieldError("/loads", None, rule)


def _pushed_in(spec: CaseSpec, scene: Scene) -> Iterator[FieldError]:
    """A straight rod that an end pushes into something solid, with no load across it, goes in end first."""
    if has_to_stretch(scene) or (axis := _kept_straight(spec, replace(scene, loads=()))) is None:
        return
    r, _, _ = nodes_at_rest(scene.initial, np.linspace(0.0, scene.rod.length, 2))
    ways = [_travel(end, axis, t) for end in (scene.start, scene.end) for t in times(scene)[::20]]
    for where, solid in solids_of(scene):
        deepest = max(float(np.max(solid.depth(r + way * axis))) for way in (min(ways), max(ways)))
        if deepest - float(np.max(solid.depth(r))) > widest(scene) and deepest > widest(scene):
            rule = (f"has the rod pushed into it, end first, by {deepest:.3g} m: nothing is across the rod, which is "
                    "straight, so it goes in instead of bending; add a small load across it, which says to which side")
            yield FieldError(where, None, rule)


def _pushed(scene: Scene) -> Iterator[FieldError]:
    """A rod that an end pushes along itself with far more than it bears, where a pull was meant."""
    critical = pi**2 * stiffness_and_mass(scene)[0] / float(scene.rod.length) ** 2
    _, orientation, _ = nodes_at_rest(scene.initial, np.linspace(0.0, scene.rod.length, 2))
    tangents = rotate(orientation, np.tile([0.0, 0.0, 1.0], (2, 1)))
    for where, end, tangent in zip(("start", "end"), (scene.start, scene.end), tangents, strict=True):
        along = tangent if end.frame == "lab" else np.array([0.0, 0.0, 1.0])
        i = int(np.argmax(np.abs(along)))
        held = all(component[0].kind != "load" for k, component in enumerate(end.translation) if k != i)
        condition = end.translation[i][0]
        if condition.kind != "load" or abs(along[i]) < ALONG or (end.frame == "lab" and not held):
            continue
        least = float(np.min(along[i] * condition.curve(times(scene))))
        if least < -PUSHED * critical:
            rule = (f"pushes the rod along itself, {-least / critical:.2g} times as hard as it takes to buckle one "
                    "that is pinned: a pull is positive")
            yield FieldError(f"/ends/{where}/f{i + 1}", least, rule)


def _kept_straight(spec: CaseSpec, scene: Scene) -> Any:
    """The axis (3,), lab, of a straight rod with no load across it; None of another one."""
    return np.array(scene.initial.direction) if isinstance(spec.initial, Straight) and stays_straight(scene) else None


def _travel(end: End, axis: Any, t: float) -> float:
    """How far an end has gone along a rod that stays straight, where it is held all the time."""
    along = axis if end.frame == "lab" else (0.0, 0.0, 1.0)
    return float(sum(x * travel(component[0], t) for x, component in zip(along, end.translation, strict=True)
                     if component[0].kind != "load"))  # fmt: skip


def _gives_way(spec: CaseSpec, scene: Scene) -> bool:
    """Whether the rod is slack, or its ends can come nearer to each other."""
    components = chain(scene.start.translation, scene.end.translation)
    conditions = [condition for component in components for condition in component]
    moved = any(condition.kind == "load" or np.any(condition.curve(times(scene))) for condition in conditions)
    return moved or not isinstance(spec.initial, Straight)


def _turned(scene: Scene) -> float:
    """The most that the ends are turned against each other about the rod (rad), while neither is free or switched."""
    start, end = _turn(scene.start, scene), _turn(scene.end, scene)
    return 0.0 if start is None or end is None else float(np.max(np.abs(end - start + twisted_at_first(scene))))


def _turn(end: End, scene: Scene) -> Any:
    """How far an end is turned about the rod at `times`; None where its moment is given."""
    t = times(scene)
    condition, *later = end.rotation[2]
    value = np.asarray(condition.curve(t))
    if condition.kind == "load":
        return None
    if condition.kind == "rate":
        steps = 0.5 * (value[1:] + value[:-1]) * np.diff(t)
        value = np.concatenate([[0.0], np.cumsum(steps)])
    driven = t <= later[0].since if later else np.full(len(t), True)
    return np.where(driven, value, value[driven][-1]) - value[0]
