"""How long a run to a tolerance is likely to take: what sets the rod moving says more of it than its size.

A run whose motion the frames follow needs a few coarse meshes. One that is let go, loaded at once or thrown has waves
that only short steps follow, and one that is wound up buckles and winds on: there the work grows until what may be
spent is spent. The seconds of CPU time are about those of such scenes, of 60 frames each, at a tolerance of 1e-3, in
the middle between the least and the most: fitted on an EPYC to scenes of each kind in `stress/plausible/bank.py`, and,
of kinds that it lacks, to 470 scenes put together at random from rods, ends, shapes, loads, drives, solids, laws and
water; what is struck, spun, twisted while held straight, in water, thrown or slow in space anew on a Xeon. For how many
of the bank they are right to a factor of 3 stands in `stress/results/plausible.md`. Of 169 scenes drawn as people of
many trades might send them, to which they are fitted too, they are right for 86 %, and for 70 % of 44 that came after:
84 % once three kinds of these were told apart. Of 85 put together at random from ends, shapes, loads and drives they
were right for 62 %, for 74 % once four kinds were told apart, and for 79 % of 39 after these; once what is in balance
at the start was told apart, for 77 % of 95 after that, and for 63 % of 63 written by somebody who knew the guide alone.
What else is known of a scene before it runs tells little more: a forest of trees over thirty numbers of it is right for
89 % of the bank's and 61 % of the others that it has not seen.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from service.cases.driven import Driven
from service.cases.imbalance import imbalance
from service.cases.stability import critical_twist, pull, stiffness_and_mass
from solver import Scene
from solver.arrays import Array
from solver.kernels.rotation import rotate
from solver.methods.space.one_axis.axis import axis_of
from solver.physics.axial import distances, has_to_stretch
from solver.physics.elasticity import can_stretch, elasticity_of, moments
from solver.physics.loads import solids
from solver.physics.section import sample
from solver.run.first_mesh import first_mesh
from solver.scene.curve import Vector
from solver.scene.ends import End
from solver.scene.layout import nodes_at_rest

SECONDS = {
    "wound up": 10.0, "lies on itself": 7.0, "may spring onto itself": 3.5, "taut": 6.0,
    "taut and light": 1.2, "taut and heavy": 8.0,
    "taut and stretching": 1.6, "still": 0.1, "under many loads": 2.0, "struck": 9.0,
    "struck in water": 3.2, "held straight and twisted": 4.2,
    "held straight and twisted alone": 0.15, "held straight and springing": 6.0,
    "held straight and moved": 2.0, "held straight": 0.7, "on a floor": 8.0, "slides as a whole": 0.3,
    "overdamped": 0.18, "overdamped and wound up": 3.0, "limp and moved": 5.0, "in space and moved or let go": 4.0,
    "with a heavy piece": 2.3, "a coil that is moved": 0.45, "moved and settling in space": 0.4, "spun": 3.0,
    "flying freely": 0.18, "settling in space": 0.14, "limp in space": 3.2, "swinging in space": 4.0,
    "slow in space": 0.36, "long and heavy in water": 1.1, "shaken in water": 0.6,
    "shaken in air": 1.5,
    "shaken under tension": 3.2, "towed through water": 0.4, "in water": 0.7, "in space and in water": 0.25,
    "let go in water": 2.6, "let go or loaded at once": 5.5, "let go and settling": 2.5,
    "let go and settling between holds": 0.6, "let go gently": 0.2, "swinging as a stick": 0.3,
    "let go between pins": 5.5, "loaded on a slide": 4.5, "let go and stretching": 2.2, "snapping through": 5.0,
    "twisted to and fro": 1.7, "moved and ringing": 3.0, "undamped": 0.45, "followed by the frames": 0.3,
}  # fmt: skip
"""CPU seconds at a tolerance of 1e-3, by what moves the rod, of FRAMES frames."""
STATIC, STATIC_START, STATIC_DOUBLED = 0.008, 30, 1.5
"""CPU seconds of a frame of a static analysis, how many frames the start counts for, and how many times more for every
doubling of the first mesh."""
DEARER = {"wound up": 4.0, "on solids": 4.0, "limp and on no solids": 4.0, "stressed at the start": 1.5,
          "touching": 3.0, "snapping through": 4.0}  # fmt: skip
"""How many times more a static analysis takes."""
FRAMES, FOLLOWED, BY_FRAMES, MOST = 60, 0.5, 0.3, 10.0
"""Frames of a run of those seconds. More take as many times longer where they are below FOLLOWED, for the steps follow
the frames there, and else so many to the power of BY_FRAMES, up to MOST: the seconds that `solver.run.budget` has for a
tolerance (MOST_WORK)."""
FOR_A_TURN = 7
"""Frames that take as long as an end that turns back once."""
WINDS = 1.3
"""Twist, in that at which a rod buckles that is pulled as it is, from which on it is taken to wind itself up."""
SPINS = 15.0
"""Rotation (rad) of an end about itself, more than of the ends against each other, from which on a rod spins."""
INTERVALS, FINELY = 16, 2001
"""Intervals of a rod, and times of a schedule, that are looked at."""
SMALL, DRIVEN = 1e-3, 0.02
"""Moment, in EJ/L, that sets nothing moving; and that of the rod's inertia where its ends are moved."""
BALANCED, LITTLE, GENTLY = 2e-3, 0.02, 0.3
"""Imbalance, in what urges the rod, with which it lies at rest; and, in EJ/L, with which it hardly moves by itself,
and nor does it by its inertia if that is less than the last."""
STRUCK, DEADENED = 1.5, 0.5
"""By how much a force in a point changes, in EJ/L^2, within a radian of the first frequency, if it is a blow;
and damping, in that frequency, with which its waves do not matter."""
HARD, TAUT = 100.0, 100.0
"""Likewise of a rod that has to stretch; and a force in a point, in EJ/L^2, that keeps a rod taut."""
COILED = 10.0
"""Rotation (rad) by which the natural shape of a coil bends in all."""
GENTLE, DAMPED = 4.0, 0.3
"""Moment of the weight, in EJ/L, and least damping, in the first angular frequency, with which waves do not matter."""
SETTLING, IN_SPACE = 0.1, 0.3
"""Damping, in the first angular frequency, with which waves soon do not matter any more; and in space."""
UNDAMPED = 1e-3
"""Damping, in the first angular frequency, with which all waves stay."""
SNAPS = 16.0
"""Force, in EJ/L^2, for every radian by which an arch between its ends is bent, that pushes it through."""
TIED = 6.0
"""Rotation (rad) by which the shape of a rod that touches itself bends, in all, at the least."""
BOWED = 1.0
"""Likewise of one that nothing holds, or that its stress lets spring so far: parts of it may meet."""
FARTHER = 1e-6
"""Part of their distance by which ends that come apart pull the rod taut."""
MUCH, HEAVILY, LIGHT = 100.0, 5.0, 300.0
"""Damping, in the rod's first angular frequency, with which nothing swings; and with which nothing swings for long
whose ends stay, if its weight across, in EJ/L^2, is not more than so much."""
SWINGS, HARDLY = 2.5, 0.05
"""Weight across, in EJ/L^2, from which on, or damping, in the first angular frequency, below which a rod swings."""
HANGS, FALLS = 200.0, 2000.0
"""Weight across, in EJ/L^2, with which a limp rod takes long to settle; and with which it does even if heavily damped.
"""
STIFF, STICK = 1.0, 0.1
"""Weight, in EJ/L^2, of a rod that hardly bends by it; and of one that swings as if it were rigid."""
LIMP, WHIPPED = 1e5, 1e6
"""Weight, in EJ/L^2, of a rod that bends by its ends in so short a part that the meshes have to be fine; and moment of
the inertia, in EJ/L, of one that does where it is moved."""
LAYERED = 150.0
"""Weight across, in EJ/L^2, of a rod that a static analysis bends at its ends in so short a part."""
MANY = 10
"""Point loads, each of which kinks the rod, or sets in at a time of its own."""
HEAVY = 20.0
"""Mass per length, by its median, of a piece that stands for a body, whose end a mesh has to find."""
STRESSED = 3.0
"""Moment, in EJ/L, of a rod that a static analysis lets go far from its natural shape."""
DENSE = 0.05
"""Density of a fluid that brakes a rod, by the rod's."""
FIRST_FREQUENCY = 3.516
"""Of a cantilever, in sqrt(EJ / mu) / L^2."""
HANGING = 1.2024
"""Of a chain that hangs, in sqrt(g / L): half the first zero of J0."""


def likely_seconds(scene: Scene) -> float:
    """CPU seconds at a tolerance of 1e-3, but for what very many frames or nodes cost."""
    if scene.analysis == "static":
        return _at_rest(scene)
    driven = Driven.of(scene)
    kind, frames = _kind(scene, driven), scene.t_end / scene.output_interval
    more = max(frames, FOR_A_TURN * driven.turns, FRAMES) / FRAMES
    seconds = SECONDS[kind]
    if kind != "still" and heavy_part(scene).any() and not _is_braked(scene):
        seconds = max(seconds, SECONDS["with a heavy piece"])
    return seconds * more if seconds < FOLLOWED else max(min(seconds * more**BY_FRAMES, MOST), seconds)


def _at_rest(scene: Scene) -> float:
    driven = Driven.of(scene)
    urged = Urged.of(scene, driven)
    on_solids = any(isinstance(load, solids.Given) for load in scene.loads)
    dear = {
        "wound up": driven.turned > WINDS * critical_twist(scene), "on solids": on_solids,
        "limp and on no solids": urged.weight_across > LAYERED and not on_solids,
        "stressed at the start": urged.stress > STRESSED,
        "touching": scene.contact is not None, "snapping through": urged.bent > SMALL and _snaps(scene, urged),
    }  # fmt: skip
    seconds = STATIC * (len(scene.outputs) + STATIC_START) * STATIC_DOUBLED ** first_mesh(scene, pressed=False)
    return float(np.prod([seconds, *(DEARER[what] for what, is_so in dear.items() if is_so)]))


def kind_of(scene: Scene) -> str:
    """What moves the rod, of `SECONDS`."""
    return _kind(scene, Driven.of(scene))


def _kind(scene: Scene, driven: Driven) -> str:
    frequency, damping = _frequency(scene), scene.damping_rate
    urged = Urged.of(scene, driven)
    heavily, held = damping > HEAVILY * frequency, _is_held(scene.start) or _is_held(scene.end)
    overdamped = damping > MUCH * frequency or (heavily and not driven.moved and urged.weight_across < LIGHT)
    if can_stretch(scene.rod) and any(_lets_go(end) for end in (scene.start, scene.end)):
        return "let go and stretching"
    if _is_still(scene, driven, urged):
        return "still"
    if driven.turned + _wound(scene) > WINDS * critical_twist(scene):
        return "overdamped and wound up" if overdamped else "wound up"
    if scene.contact is not None and urged.bent > TIED and urged.at_once and not overdamped:
        return "lies on itself"
    unbends = urged.stress_at_free_end > BOWED or (urged.bent > BOWED and urged.force > SMALL)
    if scene.contact is not None and unbends and not overdamped:
        return "may spring onto itself"
    on_solids = any(isinstance(load, solids.Given) for load in scene.loads)
    rings = urged.struck > STRUCK * frequency and damping < DEADENED * frequency
    if rings and not on_solids and (not has_to_stretch(scene) or urged.struck > HARD * frequency):
        return "struck in water" if scene.fluid is not None else "struck"
    if has_to_stretch(scene):
        if overdamped and not driven.turned and (not driven.moved or damping > MUCH * frequency):
            return "overdamped"
        if _come_apart(scene) or (urged.weight_across > SMALL and not overdamped):
            if can_stretch(scene.rod):
                return "taut and stretching"
            heavy = urged.weight_across > SMALL
            return "taut and heavy" if heavy else "taut" if urged.pushed > TAUT else "taut and light"
        if driven.turned:
            return "held straight and twisted" if driven.moved else "held straight and twisted alone"
        springs = urged.inertia > DRIVEN or urged.stress > STRESSED
        return f"held straight and {'springing' if springs else 'moved'}" if driven.moved else "held straight"
    if on_solids:
        return "slides as a whole" if urged.weight < STIFF and not held and _lies(scene) else "on a floor"
    if overdamped:
        return "overdamped"
    if scene.fluid is not None and urged.weight < LIMP and urged.springs and _is_braked(scene):
        return "let go in water"
    loaded = max(urged.weight_across, urged.force) > SMALL
    if loaded and urged.bent < SMALL and (_slides(scene.start) or _slides(scene.end)):
        return "loaded on a slide"
    if axis_of(replace(scene, numerics=replace(scene.numerics, intervals=INTERVALS))) is None:
        if _is_braked(scene):
            if urged.weight > LIMP:
                return "long and heavy in water"
            return "shaken under tension" if driven.to_and_fro and urged.pushed > TAUT else "in space and in water"
        urging = max(urged.stress, urged.force, urged.held_weight) > SMALL
        springs_back = held and max(urged.stress_at_free_end, urged.force) > SMALL
        if driven.moved and urged.stress < SMALL and scene.fluid is None:
            if urged.bent > COILED and (damping > 0.0 or urged.weight_across < SMALL):
                return "a coil that is moved"
            if damping > frequency:
                return "moved and settling in space"
        gentle = urged.imbalance < LITTLE and urged.inertia < GENTLY and urged.force < SMALL
        if not gentle and (urged.inertia > DRIVEN or springs_back or (urging and damping == 0.0)):
            limp = urged.weight > LIMP or urged.inertia > WHIPPED
            return "limp and moved" if limp else "in space and moved or let go"
        if not (urging or held):
            return "flying freely"
        if driven.spun - driven.turned > SPINS:
            return "spun"
        if damping > IN_SPACE * frequency:
            limp = urged.weight_across > (FALLS if heavily else HANGS)
            return "limp in space" if limp else "settling in space"
        swings = urged.weight_across > SWINGS or damping < HARDLY * frequency
        return "swinging in space" if urged.at_once and swings and not gentle else "slow in space"
    if scene.fluid is not None:
        if urged.weight > LIMP:
            return "long and heavy in water" if _is_braked(scene) or not driven.moved else "limp and moved"
        if driven.to_and_fro and urged.pushed > TAUT:
            return "shaken under tension"
        if driven.to_and_fro and not _is_braked(scene):
            return "shaken in air"
        return "shaken in water" if driven.to_and_fro else "towed through water" if driven.moved else "in water"
    if not held and max(urged.stress, urged.force) < SMALL:
        return "flying freely"
    if len(scene.points) >= MANY:
        return "under many loads"
    between_holds = distances(scene) is not None
    if _snaps(scene, urged) and (urged.bent > SMALL or not urged.at_once):
        return "snapping through"
    if urged.at_once:
        gentle = max(urged.stress, urged.force) < SMALL and urged.weight < GENTLE and damping > DAMPED * frequency
        if gentle:
            return "let go gently"
        if max(urged.stress, urged.force) < SMALL and urged.weight < STICK:
            return "swinging as a stick"
        if between_holds and not (_is_turned(scene.start) or _is_turned(scene.end)):
            return "let go between pins"
        if damping > SETTLING * frequency:
            return "let go and settling between holds" if between_holds else "let go and settling"
        return "let go or loaded at once"
    if driven.spun and damping < UNDAMPED * frequency:
        return "twisted to and fro"
    if damping < UNDAMPED * frequency:
        return "moved and ringing" if urged.inertia > DRIVEN else "undamped"
    return "followed by the frames"


@dataclass(frozen=True)
class Urged:
    """What moves a rod, as moments in EJ/L: of its weight, of the part of that across the rod, and across a rod that is
    `held` somewhere; of its stress at t = 0, all along and at ends that may turn, of forces that are there at once, of
    its inertia where its ends are driven; as a force in EJ/L^2 how hard it is `pushed` in a point, at the most, and by
    how much a second that changes, `struck`; by what rotation (rad) it is `bent` at t = 0 in all; and whether it is
    `thrown`."""

    weight: float
    weight_across: float
    held_weight: float
    stress: float
    stress_at_free_end: float
    force: float
    inertia: float
    pushed: float
    struck: float
    bent: float
    imbalance: float
    thrown: bool

    @classmethod
    def of(cls, scene: Scene, driven: Driven) -> Urged:
        """As a scene has it."""
        length, (stiffness, mass) = float(scene.rod.length), stiffness_and_mass(scene)
        s = np.linspace(0.0, length, INTERVALS + 1)
        _, quaternion, kappa = nodes_at_rest(scene.initial, s)
        tangent = rotate(quaternion, np.tile([0.0, 0.0, 1.0], (len(quaternion), 1)))
        unit, stress = mass * length**3 / stiffness, np.abs(moments(elasticity_of(scene.rod, s), kappa)).max(axis=1)
        free = [0.0, *(float(stress[i]) for i, end in ((0, scene.start), (-1, scene.end)) if not _is_turned(end))]
        crossed = [np.cross(tangent[0], [c.value(0.0) for c in load.force]) for load in scene.points]
        across = [float(np.linalg.norm(force)) for force in crossed]
        across += [_across(scene.start, tangent[0]), _across(scene.end, tangent[-1])]
        weight_across = float(np.linalg.norm(np.cross(tangent, scene.gravity), axis=1).mean()) * unit
        return cls(
            weight=float(np.linalg.norm(scene.gravity)) * unit, weight_across=weight_across,
            held_weight=weight_across if _is_held(scene.start) or _is_held(scene.end) else 0.0,
            stress=float(stress.max()) * length / stiffness, stress_at_free_end=max(free) * length / stiffness,
            force=max(across) * length**2 / stiffness, inertia=driven.acceleration * unit,
            pushed=max([0.0, *(_largest(load.force, scene.t_end) for load in scene.points)]) * length**2 / stiffness,
            struck=max([0.0, *(_fastest(load.force, scene.t_end) for load in scene.points),
                        *(_fastest_at(end, scene.t_end, length) for end in (scene.start, scene.end))])
            * length**2 / stiffness,
            bent=float(np.linalg.norm(kappa[:, :2], axis=1).mean()) * length,
            imbalance=imbalance(scene), thrown=any((*scene.initial.velocity, *scene.initial.angular_velocity)),
        )  # fmt: skip

    @property
    def at_once(self) -> bool:
        """Whether the rod is not at rest where it begins."""
        urging = max(self.weight_across, self.stress, self.force)
        return self.thrown or (urging > SMALL and self.imbalance > BALANCED * urging)

    @property
    def springs(self) -> bool:
        """Whether it has stress that is not borne by its ends."""
        return self.stress > SMALL and self.imbalance > BALANCED * self.stress


def _snaps(scene: Scene, urged: Urged) -> bool:
    """Whether a force pushes a rod that is held at both ends to their other side."""
    return distances(scene) is not None and urged.pushed > SNAPS * urged.bent


def heavy_part(scene: Scene) -> NDArray[np.bool_]:
    """Where, of FINELY places along the rod, it is so heavy as a body that hangs at it."""
    mass = scene.rod.mass(np.linspace(0.0, float(scene.rod.length), FINELY)) + np.zeros(FINELY)
    return np.asarray(mass > HEAVY * np.median(mass))


def _is_braked(scene: Scene) -> bool:
    """Whether the rod is in a fluid that is not much lighter than it is itself."""
    section = sample(scene.rod, np.linspace(0.0, scene.rod.length, INTERVALS + 1))
    return scene.fluid is not None and bool(scene.fluid.density * section.area.mean() > DENSE * section.mass.mean())


def _lies(scene: Scene) -> bool:
    """Whether a floor or an obstacle bears the rod all along where it begins."""
    places, _, _ = nodes_at_rest(scene.initial, np.linspace(0.0, scene.rod.length, INTERVALS + 1))
    return any(bool((load.depth(places) >= 0.0).all()) for load in scene.loads if isinstance(load, solids.Given))


def _come_apart(scene: Scene) -> bool:
    """Whether ends that hold their places come farther apart than they are at first."""
    apart = distances(scene)
    return apart is not None and bool(apart.max() > apart[0] * (1.0 + FARTHER))


def _largest(force: Vector, t_end: float) -> float:
    """The largest force (N) of a schedule until t_end."""
    times = np.linspace(0.0, t_end, INTERVALS + 1)
    return float(np.linalg.norm([curve(times) + 0.0 * times for curve in force], axis=0).max())


def _fastest(force: Vector, t_end: float) -> float:
    """The largest rate (N/s) of a schedule until t_end, after its start."""
    times = np.linspace(0.0, t_end, FINELY)
    values = np.array([curve(times) + 0.0 * times for curve in force])
    return float(np.linalg.norm(np.diff(values, axis=1), axis=0).max() / times[1])


def _fastest_at(end: End, t_end: float, length: float) -> float:
    """Likewise of what loads an end, its moments as forces that have the rod for their lever."""
    times = np.linspace(0.0, t_end, FINELY)
    loads = np.zeros((6, FINELY))
    for load, component in zip(loads, (*end.translation, *end.rotation), strict=True):
        for condition in component:
            value = condition.curve(times) + 0.0 * times if condition.kind == "load" else 0.0 * times
            load[times >= condition.since] = value[times >= condition.since]
    loads[3:] /= length
    return float(np.linalg.norm(np.diff(loads, axis=1), axis=0).max() / times[1])


def _is_still(scene: Scene, driven: Driven, urged: Urged) -> bool:
    """Whether nothing sets the rod moving."""
    loaded = scene.distributed or scene.loads or urged.pushed > SMALL or urged.struck > 0.0
    flowed = scene.fluid is not None and any(scene.fluid.current)
    return not (urged.at_once or driven.moved or driven.turned or driven.spun or loaded or flowed)


def _is_held(end: End) -> bool:
    return _is_turned(end) or any(component[0].kind != "load" for component in end.translation)


def _lets_go(end: End) -> bool:
    """Whether it holds its place at first, and later does not."""
    return any(c[0].kind != "load" and c[-1].kind == "load" for c in end.translation)


def _wound(scene: Scene) -> float:
    """By what rotation (rad) a rod is twisted at t = 0 whose ends do not turn freely."""
    if not (_is_turned(scene.start) and _is_turned(scene.end)):
        return 0.0
    s = np.linspace(0.0, float(scene.rod.length), INTERVALS + 1)
    _, _, kappa = nodes_at_rest(scene.initial, s)
    return abs(float(np.trapezoid(kappa[:, 2] - scene.rod.kappa0[2](s), s)))


def _is_turned(end: End) -> bool:
    """Whether an end has a direction, or a rotation, of its own."""
    return any(component[0].kind != "load" for component in end.rotation)


def _slides(end: End) -> bool:
    """Whether an end has a direction, and may move along it alone."""
    kinds = [component[0].kind for component in (*end.rotation, *end.translation)]
    return kinds == ["rate"] * 5 + ["load"]


def _frequency(scene: Scene) -> float:
    """The first angular frequency (rad/s) of the rod as a cantilever, a chain that hangs or a string, the largest."""
    (stiffness, mass), length = stiffness_and_mass(scene), float(scene.rod.length)
    hanging = HANGING * np.sqrt(np.linalg.norm(scene.gravity) / length)
    string = np.pi * np.sqrt(pull(scene) / mass) / length
    return float(max(FIRST_FREQUENCY * np.sqrt(stiffness / mass) / length**2, hanging, string))


def _across(end: End, tangent: Array) -> float:
    """The force (N) across the rod that is there at once at a free end."""
    loads = [c[0].curve.value(0.0) if c[0].kind == "load" else 0.0 for c in end.translation]
    return float(np.linalg.norm(np.cross(tangent, loads) if end.frame == "lab" else loads[:2]))
