"""What is likely a slip in a case that can be run: values a hundred times off, and parts that others call for."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import chain, pairwise
from math import hypot, log, pi
from typing import Any

import numpy as np

from service.cases.bends import bends_of
from service.cases.case import CaseSpec
from service.cases.errors import FieldError
from service.cases.extents import forces, largest, times, widest
from service.cases.initial import Straight
from service.cases.outlook import HEAVY, heavy_part
from service.cases.quantities import ProfileTable, ScheduleTable
from service.cases.size import tables_in
from service.cases.stability import critical_twist, growth
from service.cases.units import units_of
from solver import Curve, End, Scene
from solver.kernels.rotation import matrix_of
from solver.measures.buckling import MUCH
from solver.physics.axial import distances, has_to_stretch, largest_strain
from solver.physics.elasticity import Stretch
from solver.physics.ends import travel
from solver.physics.loads.solids import Floor, Given
from solver.physics.seed import seed_of
from solver.scene.layout import nodes_at_rest
from solver.scene.view import View

WIDEST, THICKEST = 10.0, 0.2
"""Diameter in m, as of the largest chimneys, and in rod lengths, beyond which the theory of thin rods says little."""
GRAVITY = (1.0, 30.0)
"""m/s²: less than on the moon, more than on Jupiter."""
SHEARED = 0.5
"""Shear strain of a rod's surface beyond that of any material but rubber."""
RUBBER = 0.3
"""Strain beyond that of any material but rubber."""
ALIKE = 2.0
"""How many times larger or smaller an axial stiffness may be than that of a solid circle to be taken for one."""
BEYOND = 1.0 + 1e-6
"""Part of the rod's length up to which a table ends at the rod's end."""
BESIDE, WITHIN = 8.0, 0.9
"""In D: how far along the rod places are neighbours; and how near others overlap."""
SHORT = 0.1
"""Part of the rod's length up to which a heavy piece may stand for a body."""
JERK = 1e-3
"""Part of the largest speed that an end which is held may have at first: that of a rod which begins to swing."""


def warnings_of(spec: CaseSpec, scene: Scene) -> list[FieldError]:
    """What a user should look at again: where, the value and the rule. Nothing is refused for it."""
    return [*_thickness(spec, scene), *units_of(spec, scene), *bends_of(spec, scene), *_gravity(spec),
            *_contact(spec, scene), *_sheared(spec, scene), *_column(scene), *_unstable(spec, scene),
            *_pushed_in(spec, scene), *_obstacles(spec), *_begins_inside(scene), *_friction_at_rest(spec),
            *_touches_itself(scene), *_stretched(scene), *_pulled_apart(scene), *_tables(spec), *_frames(spec),
            *_idle(scene), *_stays(scene), *_body(spec, scene), *_held_back(scene),
            *_too_fast(spec, scene)]  # fmt: skip


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


def _contact(spec: CaseSpec, scene: Scene) -> Iterator[FieldError]:
    """A rod that is twisted past buckling, and can give way, sooner or later touches itself."""
    if spec.contact is not None or not _gives_way(spec, scene):
        return
    turned, bearable = _turned(scene), critical_twist(scene)
    if turned > bearable:
        rule = (f"is not given, but the ends twist the rod by {turned / (2 * pi):.3g} turns, and it buckles at "
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
    if has_to_stretch(scene) or (R := _kept_straight(spec, scene)) is None:
        return
    if (grows := growth(scene, R[:, 2])) > MUCH:
        so = "no rod stays so, but nothing says to which side it leaves"
        if not scene.at_rest:
            so = f"a small disturbance would grow by a factor of 1e{grows / log(10.0):.0f}, but there is none"
        rule = ("has nothing across the rod, which is straight and pressed, or twisted, beyond its critical load: "
                f"{so}; add a small load across it, which says to which side it buckles")
        yield FieldError("/loads", None, rule)


def _pushed_in(spec: CaseSpec, scene: Scene) -> Iterator[FieldError]:
    """A straight rod that an end pushes into something solid, with no load across it, goes in end first."""
    R = _kept_straight(spec, replace(scene, loads=(), contact=None)) if not has_to_stretch(scene) else None
    if R is None:
        return
    r, _, _ = nodes_at_rest(scene.initial, np.linspace(0.0, scene.rod.length, 2))
    ways = [_travel(end, R, t) for end in (scene.start, scene.end) for t in times(scene)[::20]]
    for where, solid in _solids(scene):
        deepest = max(float(np.max(solid.depth(r + way * R[:, 2]))) for way in (min(ways), max(ways)))
        if deepest - float(np.max(solid.depth(r))) > widest(scene) and deepest > widest(scene):
            rule = (f"has the rod pushed into it, end first, by {deepest:.3g} m: nothing is across the rod, which is "
                    "straight, so it goes in instead of bending; add a small load across it, which says to which side")
            yield FieldError(where, None, rule)


def _kept_straight(spec: CaseSpec, scene: Scene) -> Any:
    """The axes (3, 3) of a straight rod with no load across it; None of another one."""
    if not isinstance(spec.initial, Straight):
        return None
    s, R = np.linspace(0.0, spec.rod.length, 11), np.zeros((3, 3))
    _, quaternion, kappa = nodes_at_rest(scene.initial, s)
    matrix_of(quaternion[0], R)
    return R if scene.keeps(View(2, s, quaternion, kappa, R)) else None


def _solids(scene: Scene) -> Iterator[tuple[str, Given]]:
    """Floor and obstacles, with their pointers."""
    count = 0
    for load in scene.loads:
        if isinstance(load, Given):
            yield "/loads/floor" if isinstance(load, Floor) else f"/loads/obstacles/{count}", load
            count += not isinstance(load, Floor)


def _obstacles(spec: CaseSpec) -> Iterator[FieldError]:
    """An obstacle that nodes may pass on both sides of."""
    intervals = spec.numerics.intervals
    if intervals is None or not spec.loads.obstacles:
        return
    interval = spec.rod.length / intervals
    smallest = min(range(len(spec.loads.obstacles)), key=lambda i: spec.loads.obstacles[i].radius)
    radius = spec.loads.obstacles[smallest].radius
    if interval > radius:
        rule = (f"leave {interval:.3g} m from node to node, more than the radius of {radius:.3g} m of "
                f"/loads/obstacles/{smallest}, which could pass between them")
        yield FieldError("/numerics/intervals", intervals, rule)


def _begins_inside(scene: Scene) -> Iterator[FieldError]:
    """A rod that begins so deep in something solid that it will be thrown out."""
    r, _, _ = nodes_at_rest(scene.initial, np.linspace(0.0, scene.rod.length, 201))
    for where, solid in _solids(scene):
        deepest = float(np.max(solid.depth(r)))
        if deepest > widest(scene):
            rule = f"has the rod in it at t = 0, by {deepest:.3g} m: it would throw the rod out"
            yield FieldError(where, None, rule)


def _friction_at_rest(spec: CaseSpec) -> Iterator[FieldError]:
    if spec.analysis != "static":
        return
    solids = [("/loads/obstacles/" + str(i), obstacle) for i, obstacle in enumerate(spec.loads.obstacles)]
    for where, solid in [("/loads/floor", spec.loads.floor), *solids]:
        if solid is not None and solid.friction:
            rule = "counts for nothing in a static analysis: friction needs a motion to act against"
            yield FieldError(f"{where}/friction", solid.friction, rule)


def _touches_itself(scene: Scene) -> Iterator[FieldError]:
    """With contact: a shape that begins within itself."""
    if scene.contact is None:
        return
    s = np.linspace(0.0, scene.rod.length, 201)
    r, _, _ = nodes_at_rest(scene.initial, s)
    D, along = float(np.min(scene.rod.diameter(s))), np.abs(s[:, None] - s)
    closed = float(np.linalg.norm(r[-1] - r[0])) < D  # a ring: its ends are neighbours
    along = np.minimum(along, scene.rod.length - along) if closed else along
    apart = np.linalg.norm(r[:, None] - r, axis=2)
    apart[along < max(BESIDE * D, 2.0 * s[1])] = np.inf
    one, other = np.unravel_index(int(np.argmin(apart)), apart.shape)
    if apart[one, other] < WITHIN * D:
        rule = (f"of the places at s = {s[one]:.3g} and {s[other]:.3g} m is less than the diameter, {D:.3g} m: with "
                "contact the rod must not begin within itself")  # fmt: skip
        yield FieldError("/initial", float(apart[one, other]), rule)


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
    """Ends that come farther apart than the rod is long."""
    apart, length = distances(scene), scene.rod.length
    if apart is not None and float(apart.max()) > (1.0 + largest_strain(scene)) * length:
        rule = f"come up to {apart.max():.3g} m apart, and the rod is {length:.3g} m long: it would be torn"
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
    if fluid and any(fluid.current) and not (fluid.drag_normal or fluid.drag_tangential):
        rule = "drags at nothing: drag_normal and drag_tangential are 0"
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


def _held_back(scene: Scene) -> Iterator[FieldError]:
    """A rod that begins to move as a whole while an end of it stays where it is, or as it is turned."""
    velocity, spin = (np.array(v) for v in (scene.initial.velocity, scene.initial.angular_velocity))
    s = np.linspace(0.0, scene.rod.length, 101)
    r = nodes_at_rest(scene.initial, s)[0]
    moves = velocity + np.cross(spin, r - np.average(r, axis=0, weights=scene.rod.mass(s) + 0.0 * s))
    speeds = np.linalg.norm(moves, axis=1)
    field, value = ("angular_velocity", spin) if spin.any() else ("velocity", velocity)
    for at, name, end in ((0, "start", scene.start), (-1, "end", scene.end)):
        stays, as_turned = (all(c[0].kind != "load" and c[0].curve.is_zero for c in components)
                            for components in (end.translation, end.rotation))  # fmt: skip
        if (stays and speeds[at] > JERK * speeds.max()) or (as_turned and spin.any()):
            held = "where" if stays else "as"
            rule = f"is of the whole rod, whose {name} is held {held} it is: it begins with a jerk"
            yield FieldError(f"/initial/{field}", float(np.linalg.norm(value)), rule)


def _too_fast(spec: CaseSpec, scene: Scene) -> Iterator[FieldError]:
    """An end that is moved faster than a push runs along the rod, sqrt(EA / m) with EA of a solid section."""
    s = np.linspace(0.0, scene.rod.length, 11)
    EJ = np.max([profile(s) for profile in scene.rod.stiffness[:2]])
    sound = float(4.0 * np.sqrt(EJ / np.min(scene.rod.mass(s))) / np.min(scene.rod.diameter(s)))
    for where, table in tables_in(spec.ends, "/ends"):
        if where.rpartition("/")[2] in ("x1", "x2", "x3") and isinstance(table, ScheduleTable):
            speed = float(np.max(np.abs(np.diff(table.value) / np.diff(table.t))))
            if speed > sound:
                rule = f"moves at {speed:.3g} m/s, faster than sound runs along the rod, {sound:.3g} m/s"
                yield FieldError(where, speed, rule)


def _travel(end: End, R: Any, t: float) -> float:
    """How far an end has gone along a rod that stays straight, where it is held all the time."""
    along = R[:, 2] if end.frame == "lab" else np.array([0.0, 0.0, 1.0])
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
    return 0.0 if start is None or end is None else float(np.max(np.abs(end - start)))


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


def _frames(spec: CaseSpec) -> Iterator[FieldError]:
    """Too few frames to see a schedule go up and down."""
    periods = [period for part in ("ends", "loads") for period in _periods(getattr(spec, part), f"/{part}")]
    shortest, where = min(periods, default=(np.inf, ""))
    if spec.output.interval > shortest:
        rule = f"is longer than {shortest:.3g} s, in which {where} goes up and down: the frames cannot show it"
        yield FieldError("/output/interval", spec.output.interval, rule)


def _periods(part: Any, pointer: str) -> Iterator[tuple[float, str]]:
    """The shortest time between two maxima, or two minima, of each schedule below a part; and where it is."""
    for where, table in tables_in(part, pointer):
        if isinstance(table, ScheduleTable):
            steps = np.diff(table.value)
            changing = np.flatnonzero(steps)
            turns = [table.t[j] for i, j in pairwise(changing) if steps[i] * steps[j] < 0.0]
            yield from ((late - early, where) for early, late in zip(turns, turns[2:], strict=False))
