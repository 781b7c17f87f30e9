"""A case can say all that a scene can hold: by the same names, with the same defaults, within the same bounds."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import MISSING, Field, dataclass, field, fields, is_dataclass, replace
from importlib import import_module
from math import inf, nan, radians
from pkgutil import iter_modules
from typing import Any

import pytest
from pydantic import BaseModel

import solver.scene
from service.cases import CaseError, apply_settings, build_scene, parse_case
from service.cases.case import CaseSpec, NumericsSpec, OutputSpec
from service.cases.ends import EndObject, EndsSpec, Stop, Switch
from service.cases.initial import Centreline, Straight
from service.cases.rod import RodSpec
from service.cases.surroundings import ContactSpec, DistributedSpec, FluidSpec, LoadsSpec, PointSpec, ShearSpec
from solver import (
    Condition,
    Contact,
    Curve,
    DistributedLoad,
    End,
    Fluid,
    Initial,
    Numerics,
    PointLoad,
    Rod,
    Scene,
    Shear,
)
from solver.scene.view import View

TRANSLATION = tuple(f"{kind}{i}" for kind in "vxf" for i in (1, 2, 3))
ROTATION = tuple(f"{kind}{i}" for kind in ("omega", "theta", "q") for i in (1, 2, 3))


@dataclass(frozen=True)
class Pair:
    """A dataclass of the scene, and the models of a case that say it.

    `renamed`: the model's fields behind a field of the scene that is called otherwise; `beside`: those of the models'
    that no scene needs; `keys`: where a field of this dataclass stands in a case, if it is bounded by a rule;
    `placed`: a scene with another part of this kind.
    """

    part: type
    models: tuple[type[BaseModel], ...]
    renamed: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    beside: tuple[str, ...] = ()
    key: str = ""
    of: Callable[[Scene], Any] = lambda scene: scene
    placed: Callable[[Scene, Any], Scene] = lambda _, part: part

    def named(self, name: str) -> tuple[str, ...]:
        """The models' fields of a field of the scene."""
        return self.renamed.get(name, (name,))


PAIRS = (
    Pair(Scene, (CaseSpec, LoadsSpec, OutputSpec, EndsSpec), {"output_interval": ("interval",), "points": ("point",),
                                                                "loads": ("loads", "floor", "obstacles")},
         ("schema_version", "name", "title", "description", "ends", "output", "fields")),
    Pair(Rod, (RodSpec,),
         {"stiffness": ("bending_stiffness", "torsional_stiffness", "youngs_modulus", "shear_modulus"),
          "mass": ("mass_per_length", "density"), "inertia": ("inertia_per_length", "density"),
          "laws": ("coupling", "sticking_stiffness", "slip_curvature", "locking_stiffness", "locking_curvature",
                   "axial_stiffness", "twist_stretch_coupling", "retardation_time")},
         (), "rod.", lambda scene: scene.rod, lambda scene, part: replace(scene, rod=part)),
    Pair(Initial, (Straight, Centreline), {"centreline": ("shape", "origin", "direction", "points")},
         (), "initial.", lambda scene: scene.initial, lambda scene, part: replace(scene, initial=part)),
    Pair(End, (EndObject,), {"translation": TRANSLATION, "rotation": ROTATION}, ("preset", "switches")),
    Pair(Condition, (Switch, Stop), {"kind": (*TRANSLATION, *ROTATION), "curve": (*TRANSLATION, *ROTATION),
                                     "since": ("at",), "within": ("stop_within",)}, ("preset",)),
    Pair(DistributedLoad, (DistributedSpec,)),
    Pair(PointLoad, (PointSpec,), {}, (),
         "loads.point.0.", lambda scene: scene.points[0], lambda scene, part: replace(scene, points=(part,))),
    Pair(Fluid, (FluidSpec,), {}, (),
         "fluid.", lambda scene: scene.fluid, lambda scene, part: replace(scene, fluid=part)),
    Pair(Shear, (ShearSpec,), {"factor": ("height", "factor", "interpolation")}),
    Pair(Contact, (ContactSpec,), {"aperture": ("aperture_deg",)}, (),
         "contact.", lambda scene: scene.contact, lambda scene, part: replace(scene, contact=part)),
    Pair(Numerics, (NumericsSpec,), {"most_intervals": (), "small_motion": (), "strides": ()}, (),
         "numerics.", lambda scene: scene.numerics, lambda scene, part: replace(scene, numerics=part)),
)  # fmt: skip

SCENE_KEYS = {"output_interval": "output.interval", "gravity": "loads.gravity", "damping": "loads.damping"}

OTHER_DEFAULTS = {
    "Initial.direction",  # none, but of a straight rod
    "Scene.numerics",  # a case's own are resolved by what else it says
    "Numerics.dt_max",  # 0.05 s, where a case says nothing else about its steps
    "Condition.since", "Condition.within",  # a condition that a case names has a value
}  # fmt: skip
"""Where a case has another default than the scene."""

CASE: dict[str, Any] = {
    "schema_version": 1,
    "rod": {"length": 1.0, "diameter": 0.01, "youngs_modulus": 1e7, "shear_modulus": 1e7, "density": 1000.0},
    "initial": {"shape": "straight"},
    "ends": {"start": "clamp", "end": "free"},
    "loads": {"gravity": [0.0, 0.0, 0.0], "point": [{"s": 0.0}]},
    "fluid": {"density": 1000.0},
    "contact": {"k1": 1.0, "k2": 1.0, "aperture_deg": 70.0, "cutoff": 0.1, "skip": 0.1, "spacing": 0.05},
    "numerics": {"method": "staggered", "intervals": 20, "dt_max": 0.1},
    "t_end": 1.0,
    "output": {"interval": 0.5},
}
PROBES = (-inf, -1.0, -1e-9, 0.0, 1e-9, 0.3, 1.0, 1.0 + 1e-9, 90.0, 180.0, 181.0, 25_000.0, inf, nan)
NARROWER = {
    "Fluid.density": {0.0},
    "Numerics.intervals": {25_000.0},
    "Numerics.tolerance": {1e-9, 0.3, 1.0, 1.0 + 1e-9, 90.0, 180.0, 181.0, 25_000.0, inf},
    "Numerics.increment_tolerance": {inf},
    "Numerics.dt_max": {1e-9},  # more steps than a case may have
    "Scene.output_interval": {1e-9},  # and more frames
    "Contact.spacing": {1e-9},  # and more contact points
}
"""What the solver would run and the service refuses."""


def of_scene() -> Iterator[type]:
    for module in iter_modules(solver.scene.__path__, "solver.scene."):
        for thing in vars(import_module(module.name)).values():
            own = isinstance(thing, type) and is_dataclass(thing) and thing.__module__ == module.name
            if own and thing is not View:
                yield thing


def test_every_part_of_a_scene_has_its_models():
    assert {part.__name__ for part in of_scene()} == {pair.part.__name__ for pair in PAIRS}


@pytest.mark.parametrize("pair", PAIRS, ids=lambda pair: pair.part.__name__)
def test_no_field_is_missing_on_either_side(pair):
    wanted = {name for one in fields(pair.part) for name in pair.named(one.name)}
    there = {name for model in pair.models for name in model.model_fields}
    assert there == wanted | set(pair.beside)


def plain(value: object) -> object:
    """A default as numbers."""
    if isinstance(value, Curve):
        return value.value(0.0)
    return tuple(map(plain, value)) if isinstance(value, tuple) else value


def scene_default(one: Field[Any]) -> object:
    return plain(one.default_factory() if one.default_factory is not MISSING else one.default)


def case_default(pair: Pair, name: str) -> object:
    [model] = [model for model in pair.models if name in model.model_fields][:1]
    if model is NumericsSpec:
        return getattr(NumericsSpec.model_validate({"method": "box"}), name)
    info = model.model_fields[name]
    return MISSING if info.is_required() else info.default


@pytest.mark.parametrize("pair", PAIRS, ids=lambda pair: pair.part.__name__)
def test_a_default_is_the_same_on_either_side(pair):
    same = [(one, pair.named(one.name)[0]) for one in fields(pair.part) if len(pair.named(one.name)) == 1]
    differing = {f"{pair.part.__name__}.{one.name}" for one, name in same
                 if scene_default(one) != case_default(pair, name)}  # fmt: skip
    assert differing == {name for name in OTHER_DEFAULTS if name.startswith(f"{pair.part.__name__}.")}


NUMBERS = ("float", "float | None", "int", "tuple[float, float, float]")
BOUNDED = [(pair, one) for pair in PAIRS for one in fields(pair.part)
           if one.type in NUMBERS and len(pair.named(one.name)) == 1 and (pair.key or pair.part is Scene)]  # fmt: skip


def case_takes(key: str, value: object) -> bool:
    try:
        parse_case(apply_settings(CASE, {key: value}))
    except CaseError:
        return False
    return True


def scene_takes(pair: Pair, name: str, value: object) -> bool:
    scene = build_scene(parse_case(CASE))
    try:
        pair.placed(scene, replace(pair.of(scene), **{name: value}))
    except ValueError:
        return False
    return True


@pytest.mark.parametrize(("pair", "one"), BOUNDED, ids=[f"{pair.part.__name__}.{one.name}" for pair, one in BOUNDED])
def test_a_value_is_taken_by_both_or_by_neither(pair, one):
    key = SCENE_KEYS.get(one.name, one.name) if pair.part is Scene else pair.key + pair.named(one.name)[0]
    refused = set()
    for probe in PROBES:
        value: Any = (1.0, 0.0, probe) if one.type.startswith("tuple") else probe
        if one.type == "int" and probe.is_integer():
            value = int(probe)
        in_scene = radians(probe) if one.name == "aperture" else value
        by_scene, by_case = scene_takes(pair, one.name, in_scene), case_takes(key, value)
        assert by_scene or not by_case, f"the scene refuses {value}, the case does not"
        if by_scene and not by_case:
            refused.add(probe)
    assert refused == NARROWER.get(f"{pair.part.__name__}.{one.name}", set())
