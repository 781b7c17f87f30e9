"""Warnings of values that are likely in another unit; rods as there are stay in peace."""

from __future__ import annotations

from math import pi
from typing import Any

import pytest

from service.cases import apply_settings, build_scene, parse_case, warnings_of
from stress.plausible.bank import KINDS, scene

STEEL = {"length": 2.0, "diameter": 0.01, "youngs_modulus": 2e11, "shear_modulus": 8e10, "density": 7850.0}
CASE = {"schema_version": 1, "t_end": 1.0, "output": {"interval": 0.1}, "rod": STEEL,
        "initial": {"shape": "straight", "direction": [1, 0, 0]}, "ends": {"start": "clamp", "end": "free"},
        "loads": {"gravity": [0.0, 0.0, -9.81]}}  # fmt: skip


def told(settings: dict[str, Any]) -> list[tuple[str, str]]:
    """Pointers and rules of the warnings of a steel cantilever with some settings."""
    spec = parse_case(apply_settings(CASE, settings))
    return [(warning.pointer, warning.rule) for warning in warnings_of(spec, build_scene(spec))]


SLIPS: list[tuple[dict[str, Any], str, str]] = [
    ({"rod.youngs_modulus": 2e5, "rod.shear_modulus": 8e4}, "/rod/youngs_modulus", "that of a metal: is it in MPa?"),
    ({"rod.youngs_modulus": 200.0}, "/rod/youngs_modulus", "no material (1000 to 2e+12 Pa): is it in MPa or GPa?"),
    ({"rod.youngs_modulus": 2000.0, "rod.shear_modulus": 800.0, "rod.density": 1150.0}, "/rod/youngs_modulus",
     "stretch the rod by 11 of its length: is it in MPa?"),
    ({"rod.density": 7.85}, "/rod/density", "no material (10 to 25000 kg/m³): is it in g/cm³?"),
    ({"rod.density": 7.85e-6}, "/rod/density", "is it in kg/mm³?"),
    ({"rod.density": 7.85e-9}, "/rod/density", "is it in t/mm³?"),
    ({"rod.density": 19.3}, "/rod/density", "that of a solid: is it in g/cm³?"),
    ({"rod.density": 7850e6}, "/rod/density", "no material (10 to 25000 kg/m³)"),
    ({"rod.youngs_modulus": 8e10, "rod.shear_modulus": 2e11}, "/rod/shear_modulus", "are they swapped?"),
    ({"rod.shear_modulus": 8e7}, "/rod/shear_modulus", "by a factor of 2.5e+03: are both in Pa?"),
    ({"rod.diameter": 10.0}, "/rod/diameter", "the rod is not thin; is it given in mm?"),
    ({"ends.end": {"preset": "free", "theta3": 90.0}}, "/ends/end/theta3", "14.3 turns about the rod: is it in deg"),
    ({"ends.end": {"preset": "free", "theta1": 90.0}}, "/ends/end/theta1", "14.3 turns about an axis across the rod"),
    ({"ends.end": {"preset": "free", "switches": [{"at": 0.5, "theta3": 180.0}]}}, "/ends/end/theta3", "28.6 turns"),
    ({"initial.twist": -45.0}, "/initial/twist", "7.16 turns: is it in degrees?"),
    ({"initial.twist": {"s": [0, 2], "value": [0, 360], "interpolation": "linear"}}, "/initial/twist", "57.3 turns"),
    ({"ends.end": {"preset": "free", "f3": 1e8}}, "/ends/end", "by 6.4 of its length: are they in N, Pa and m?"),
    ({"fluid": {"density": 1.025, "added_mass": 1.0}}, "/fluid/density", "is it in g/cm³?"),
    ({"loads.point": [{"s": 1.0, "force": [0, 2e6, 0]}]}, "/loads/point/0/force", "by 0.13 of its length"),
]


@pytest.mark.parametrize(("settings", "pointer", "rule"), SLIPS, ids=[str(settings) for settings, *_ in SLIPS])
def test_a_value_in_another_unit_is_pointed_out(settings: dict[str, Any], pointer: str, rule: str):
    at, said = told(settings)[0]
    assert (at, rule in said) == (pointer, True), said


SENSIBLE: list[dict[str, Any]] = [
    {},
    {"rod.youngs_modulus": 3e5, "rod.shear_modulus": 1e5, "rod.density": 2900.0, "rod.length": 0.05,
     "rod.diameter": 0.001},  # a soft magnet
    {"rod.youngs_modulus": 2e3, "rod.shear_modulus": 700.0, "rod.density": 1000.0, "rod.length": 0.02,
     "rod.diameter": 0.001},  # a gel
    {"rod.youngs_modulus": 5e6, "rod.shear_modulus": 2e6, "rod.density": 15.0},  # a foam
    {"rod.youngs_modulus": 2e11, "rod.shear_modulus": 4e9, "rod.density": 1600.0},  # a fibre
    {"rod.youngs_modulus": 1.0, "rod.shear_modulus": 0.5, "rod.density": 1.0},  # no units
    {"rod.youngs_modulus": 1e4, "rod.shear_modulus": 3e3, "rod.density": 1000.0, "loads.floor": {"stiffness": 50.0}},
    {"rod.youngs_modulus": 1e4, "rod.shear_modulus": 3e3, "rod.density": 1000.0, "fluid": {"density": 1000.0}},
    {"rod.youngs_modulus": 1e4, "rod.shear_modulus": 3e3, "rod.density": 1000.0, "ends.start": "free"},
    {"ends.end": {"preset": "free", "theta2": {"t": [0.0, 1.0], "value": [0.0, 4.0 * pi], "interpolation": "linear"}}},
    {"ends.end": {"preset": "free", "f3": 1e5}},
    {"initial.twist": 1.5},
    {"fluid": {"density": 1.025, "drag_normal": 1.0}},  # air
]


@pytest.mark.parametrize("settings", SENSIBLE, ids=str)
def test_a_sensible_rod_is_left_alone(settings: dict[str, Any]):
    assert told(settings) == []


def test_a_rod_that_says_how_it_stretches_is_judged_by_that_alone():
    rope = {"rod.axial_stiffness": 1e8, "ends.end": {"preset": "free", "f3": 2e6}}
    assert told(rope) == []
    assert [at for at, _ in told(rope | {"rod.axial_stiffness": 1e6})] == ["/rod/axial_stiffness"]


EXPECTED = ("/loads/gravity", "/contact", "/ends/start/x2")
"""Scaled gravity, rods that wind up without contact, and an end that whirls at once: some scenes of the bank have them
on purpose."""


@pytest.mark.parametrize("kind", KINDS)
def test_plausible_scenes_are_beyond_doubt(kind: str):
    for number in range(8):
        spec = parse_case(scene(kind, number))
        doubts = [warning for warning in warnings_of(spec, build_scene(spec)) if warning.pointer not in EXPECTED]
        bodies = [warning for warning in doubts if "if that is a body" in warning.rule]
        assert doubts == bodies
        assert not bodies or kind == "rubber"  # whose jumper is a heavy piece of the rope
