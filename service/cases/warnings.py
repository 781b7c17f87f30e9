"""What is likely a slip in a case that can be run: values a hundred times off, and parts that others call for."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import chain
from math import hypot

import numpy as np

from service.cases.bends import bends_of
from service.cases.buckling import buckling_of
from service.cases.case import CaseSpec
from service.cases.errors import FieldError
from service.cases.extents import forces, largest, widest
from service.cases.frames import frames_of
from service.cases.motion import motion_of
from service.cases.outlook import HEAVY, heavy_part
from service.cases.quantities import ProfileTable
from service.cases.size import tables_in
from service.cases.solids import touching_of
from service.cases.units import units_of
from solver import Curve, End, Scene
from solver.physics.axial import distances, largest_strain
from solver.physics.elasticity import Stretch, can_stretch

WIDEST, THICKEST = 10.0, 0.2
"""Diameter in m, as of the largest chimneys, and in rod lengths, beyond which the theory of thin rods says little."""
GRAVITY = (1.0, 30.0)
"""m/s²: less than on the moon, more than on Jupiter."""
RUBBER = 0.3
"""Strain beyond that of any material but rubber."""
FAR = 0.05
"""Strain beyond that of metals, glass and most threads."""
ALIKE = 2.0
"""How many times larger or smaller an axial stiffness may be than that of a solid circle to be taken for one."""
BEYOND = 1.0 + 1e-6
"""Part of the rod's length up to which a table ends at the rod's end."""
SHORT = 0.1
"""Part of the rod's length up to which a heavy piece may stand for a body."""


def warnings_of(spec: CaseSpec, scene: Scene) -> list[FieldError]:
    """What a user should look at again: where, the value and the rule. Nothing is refused for it."""
    return [*_thickness(spec, scene), *units_of(spec, scene), *bends_of(spec, scene), *_gravity(spec),
            *buckling_of(spec, scene), *touching_of(spec, scene), *_stretched(scene), *_pulled_apart(scene),
            *_tables(spec), *frames_of(spec, scene), *_idle(scene), *_stays(scene), *_body(spec, scene),
            *motion_of(spec, scene)]  # fmt: skip


def _thickness(spec: CaseSpec, scene: Scene) -> Iterator[FieldError]:
    diameter = widest(scene)
    if diameter > THICKEST * spec.rod.length:
        rule = f"is more than a fifth of the rod's length of {spec.rod.length:g} m: the rod is not thin"
        rule += "; is it given in mm?" if diameter > spec.rod.length else ""
        yield FieldError("/rod/diameter", diameter, rule)
    if diameter > WIDEST:
        yield FieldError("/rod/diameter", diameter, f"is more than {WIDEST:g} m: is it given in m?")


def _gravity(spec: CaseSpec) -> Iterator[FieldError]:
    gravity = spec.loads.gravity
    size = hypot(*gravity)
    if size and not GRAVITY[0] <= size <= GRAVITY[1]:
        yield FieldError("/loads/gravity", gravity, "is far from 9.81 m/s²")
    if not any(gravity[:2]) and gravity[2] > 0.0:
        yield FieldError("/loads/gravity", gravity, "points along +e3, which is upwards in most scenes")


def _stretched(scene: Scene) -> Iterator[FieldError]:
    """A rod that loads, or its weight, would stretch by more than a run bears; or than any material but rubber, where
    EA is not that of a solid circle that bends as the rod does, 16 EJ / D^2."""
    s = np.linspace(0.0, scene.rod.length, 1001)
    stiffness = min((float(np.min(law.EA(s))) for law in scene.rod.laws if isinstance(law, Stretch)), default=np.inf)
    weight = float(np.mean(scene.rod.mass(s))) * scene.rod.length * hypot(*scene.gravity)
    strain = max(weight, *forces(scene).values()) / stiffness
    solid = 16.0 * float(np.min([EJ(s) / scene.rod.diameter(s) ** 2 for EJ in scene.rod.stiffness[:2]]))
    doubted = not 1.0 / ALIKE < stiffness / solid < ALIKE
    if strain > (min(RUBBER, largest_strain(scene)) if doubted else largest_strain(scene)):
        bears = (f"more than the {largest_strain(scene):g} up to which a run goes on" if strain > largest_strain(scene)
                 else "which only rubber bears: is it E A, in N?")  # fmt: skip
        rule = f"is so small that loads or the weight may stretch the rod by {strain:.2g} of its length, {bears}"
        yield FieldError("/rod/axial_stiffness", stiffness, rule)


def _pulled_apart(scene: Scene) -> Iterator[FieldError]:
    """Ends that come farther apart than the rod is long, by more than it stretches."""
    apart, length = distances(scene), scene.rod.length
    strain = 0.0 if apart is None else float(apart.max()) / length - 1.0
    torn = strain > largest_strain(scene)
    if torn or (strain > FAR and not can_stretch(scene.rod)):
        then = "it would be torn" if torn else f"it has to stretch by {100 * strain:.2g} %, as axial_stiffness lets it"
        rule = f"come up to {(1.0 + strain) * length:.3g} m apart, and the rod is {length:.3g} m long: {then}"
        yield FieldError("/ends", None, rule)


def _tables(spec: CaseSpec) -> Iterator[FieldError]:
    """A profile that goes on beyond the rod."""
    for where, table in tables_in(spec):
        if isinstance(table, ProfileTable) and table.s[-1] > BEYOND * spec.rod.length:
            rule = f"ends at {table.s[-1]:g} m, beyond the rod, which is {spec.rod.length:g} m long"
            yield FieldError(f"{where}/s", table.s[-1], rule)


def _idle(scene: Scene) -> Iterator[FieldError]:
    """Loads that are zero, or that an end bears, a current that drags at nothing, and switches that come too late."""
    ends = {0.0: scene.start, scene.rod.length: scene.end}
    for i, load in enumerate(scene.points):
        if largest(load.force, scene) == largest(load.moment, scene) == 0.0:
            yield FieldError(f"/loads/point/{i}", None, "has neither a force nor a moment until t_end: it does nothing")
        elif load.s in ends and _is_clamp(ends[load.s]):
            yield FieldError(f"/loads/point/{i}", load.s, "is where a clamp bears the load: the rod does not feel it")
    for i, spread in enumerate(scene.distributed):
        parts = (*spread.force, *spread.moment)
        zero = all(isinstance(part, Curve) and part.is_zero for part in parts)
        if zero or largest((spread.schedule,), scene) == 0.0:
            rule = "has neither a force nor a moment until t_end: it does nothing"
            yield FieldError(f"/loads/distributed/{i}", None, rule)
    fluid = scene.fluid
    if fluid and any(fluid.current) and not (fluid.drag_normal or fluid.drag_tangential or fluid.viscosity):
        rule = "drags at nothing: drag_normal, drag_tangential and viscosity are 0"
        yield FieldError("/fluid/current", float(np.linalg.norm(fluid.current)), rule)
    if fluid and fluid.varies and fluid.fastest == 0.0:
        name = "shear" if fluid.shear else "schedule"
        yield FieldError(f"/fluid/{name}", None, "is of a current that is 0: it does nothing")
    for name, end in (("start", scene.start), ("end", scene.end)):
        if end.mass > 0.0 and all(c.kind != "load" for component in end.translation for c in component):
            rule = "is of a body at an end that is held in place: the rod does not feel it"
            yield FieldError(f"/ends/{name}/mass", end.mass, rule)
        conditions = chain.from_iterable((*end.translation, *end.rotation))
        late = sorted({condition.since for condition in conditions if condition.since >= scene.t_end})
        for time in late:
            rule = f"has a switch at {time:g} s, and the run ends at t_end, {scene.t_end:g} s: it does nothing"
            yield FieldError(f"/ends/{name}/switches", time, rule)


def _body(spec: CaseSpec, scene: Scene) -> Iterator[FieldError]:
    """A short piece at an end that is as heavy as a body, which a mesh hardly finds."""
    heavy = heavy_part(scene)
    for name, along in (("start", heavy), ("end", heavy[::-1])):
        many = int(np.argmin(along))  # the first place that is not
        if 0 < many <= SHORT * len(heavy) and spec.analysis == "dynamic":
            rule = (f"is more than {HEAVY:g} times as much along the {many / len(heavy) * spec.rod.length:.2g} m at "
                    f"its {name} as elsewhere: if that is a body, ends.{name}.mass is more exact, and costs less")
            yield FieldError("/rod/mass_per_length", None, rule)


def _stays(scene: Scene) -> Iterator[FieldError]:
    """An end that is given a place, where only a change of it is followed."""
    for name, end in (("start", scene.start), ("end", scene.end)):
        for letter, components in (("x", end.translation), ("theta", end.rotation)):
            for i, condition in ((i, condition) for i, component in enumerate(components) for condition in component):
                if condition.kind == "position" and condition.curve.is_constant and not condition.curve.is_zero:
                    rule = ("does not change, and a position is followed by its change: this end stays where it is; "
                            "give the way that it goes as a table that begins at 0")  # fmt: skip
                    yield FieldError(f"/ends/{name}/{letter}{i + 1}", condition.curve.value(0.0), rule)


def _is_clamp(end: End) -> bool:
    """Whether an end has its place and its rotation all the time."""
    return all(condition.kind != "load" for component in (*end.translation, *end.rotation) for condition in component)
