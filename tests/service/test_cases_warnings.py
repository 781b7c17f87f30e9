"""Warnings: slips are named, and what is meant is left alone."""

from __future__ import annotations

from math import pi
from typing import Any

import numpy as np
import pytest

from service.cases import apply_settings, build_scene, load_case, parse_case, shipped_cases, warnings_of
from service.cases.buckling import PUSHED
from service.cases.errors import FieldError

DNA = {"rod.length": 3e-7, "rod.diameter": 2e-9, "rod.youngs_modulus": 3e8, "rod.shear_modulus": 1.5e8,
       "rod.density": 1700.0, "loads.point": []}
MODEL = {"rod.length": 1.0, "rod.diameter": 0.01, "rod.youngs_modulus": 1.0, "rod.shear_modulus": 0.5,
         "rod.density": 1.0}
SAW = {"t": [0.0, 0.1, 0.2, 0.3, 0.4], "value": [0, 1, 0, 1, 0], "interpolation": "linear"}


def told(settings: dict[str, Any], name: str = "elastica") -> list[FieldError]:
    """The warnings of a shipped case with some settings."""
    spec = parse_case(apply_settings(load_case(name), settings))
    return warnings_of(spec, build_scene(spec))


@pytest.mark.parametrize("name", shipped_cases())
def test_shipped_cases_are_beyond_doubt(name: str):
    assert told({}, name) == []


@pytest.mark.parametrize("settings", [DNA, MODEL, {"loads.gravity": [0, -9.81, 0]}, {"loads.gravity": [0, 0, -1.62]}])
def test_other_units_and_worlds_are_left_alone(settings: dict[str, Any]):
    assert told(settings) == []


@pytest.mark.parametrize(("setting", "value", "pointer", "rule"), [
    ("rod.diameter", 0.3, "/rod/diameter", "a fifth of the rod's length"),
    ("rod.density", 1.5, "/rod/density", "no material"),
    ("rod.density", 1.5e6, "/rod/density", "no material"),
    ("rod.youngs_modulus", 210.0, "/rod/youngs_modulus", "no material"),
    ("rod.shear_modulus", 1e14, "/rod/shear_modulus", "no material"),
    ("loads.gravity", [0.0, 0.0, 9.81], "/loads/gravity", "upwards"),
    ("loads.gravity", [0.0, 0.0, -981.0], "/loads/gravity", "far from 9.81"),
    ("loads.point", [{"s": 0.5, "force": [SAW, 0, 0]}], "/output/interval", "/loads/point/0/force/0"),
])  # fmt: skip
def test_a_slip_is_named_with_its_value(setting: str, value: Any, pointer: str, rule: str):
    [warning] = told({setting: value, "output.interval": 0.25})
    assert (warning.pointer, warning.value if pointer == "/output/interval" else 0.25) == (pointer, 0.25)
    assert rule in warning.rule


def test_a_rod_of_30_m_diameter_is_told_to_be_wide_and_thick():
    assert [warning.value for warning in told({"rod.diameter": 30.0})] == [30.0, 30.0]


@pytest.mark.parametrize("part", [50.0, 200.0])
def test_a_push_that_was_meant_for_a_pull_is_told(part: float):
    """Whether something is across the rod makes no difference."""
    spec = parse_case(load_case("elastica"))
    scene = build_scene(spec)
    euler = pi**2 * float(scene.rod.stiffness[0](0.0)) / scene.rod.length**2
    axis = int(np.argmax(np.abs(scene.initial.direction)))
    guided = {"preset": "pin", "frame": "lab"}

    def warned(preset: dict[str, Any], name: str, force: float) -> bool:
        return f"/ends/end/{name}" in [warning.pointer for warning in told({"ends.end": preset | {name: force}})]

    for preset, name in (({"preset": "slider"}, "f3"), (guided, f"f{axis + 1}")):
        assert warned(preset, name, -part * euler) == (part > PUSHED)
        assert not warned(preset, name, part * euler)


@pytest.mark.parametrize(("turns", "end", "warned"), [(3.0, "slider", True), (3.0, "clamp", False),
                                                      (1.0, "slider", False), (3.0, "free", False)])
def test_a_rod_that_buckles_by_twist_needs_contact(turns: float, end: str, warned: bool):
    """Of EJ = 1.25 GJ a straight clamped rod buckles at 8.987 * 1.25 / 2 pi = 1.79 turns."""
    twist = {"t": [0.0, 1.0], "value": [0.0, turns * 6.2832], "interpolation": "linear"}
    turning = {"ends.start": {"preset": "clamp", "theta3": twist}, "ends.end": end, "loads.point": []}
    assert [warning.pointer for warning in told({**turning, "t_end": 2.0})] == ["/contact"] * warned




@pytest.mark.parametrize(("pull", "warned"), [(0.0, True), (1e4, False)])
def test_a_rod_that_is_pulled_bears_more_twist(pull: float, warned: bool):
    """2 sqrt(T EJ + (8.987 EJ / 2L)^2) / GJ are 11.2 rad, and 15.1 by 1e4 N: EJ = 613.6, GJ = 490.9 N m^2."""
    twist = {"t": [0.0, 1.0], "value": [0.0, 13.0], "interpolation": "linear"}
    rod = PRESSED["rod"] | {"diameter": 0.05, "youngs_modulus": 2e9, "shear_modulus": 8e8}
    ends = {"start": {"preset": "clamp", "theta3": twist}, "end": {"preset": "slider", "f3": pull}}
    assert ("/contact" in {found.pointer for found in _warned(PRESSED | {"rod": rod, "ends": ends})}) == warned


@pytest.mark.parametrize(("turned", "warned"), [(725.0, True), (72.0, False)])
def test_a_rod_that_its_ends_wring_is_told_so(turned: float, warned: bool):
    """Of D = L / 100 the surface is sheared by 725 / 200."""
    twist = {"t": [0.0, 1.0], "value": [0.0, turned], "interpolation": "linear"}
    found = _warned(PRESSED | {"ends": {"start": {"preset": "clamp", "theta3": twist}, "end": "clamp"}})
    assert [warning.pointer for warning in found] == ["/ends"] * warned
    assert all("115 turns" in warning.rule and "up to 3.6" in warning.rule for warning in found)


def _moved(x3: float) -> dict[str, Any]:
    """A clamp, and one that moves by so much along the rod."""
    schedule = {"t": [0.0, 1.0], "value": [0.0, x3], "interpolation": "smoothstep"}
    return {"start": "clamp", "end": {"preset": "clamp", "frame": "lab", "x3": schedule}}


PRESSED = {"schema_version": 1, "t_end": 1.0, "output": {"interval": 0.1}, "initial": {"shape": "straight"},
           "rod": {"length": 1.0, "diameter": 0.01, "youngs_modulus": 1e9, "shear_modulus": 4e8, "density": 1500},
           "ends": _moved(-0.1)}  # fmt: skip


def _warned(case: dict[str, Any]) -> list[FieldError]:
    spec = parse_case(case)
    return warnings_of(spec, build_scene(spec))


def test_a_straight_rod_that_is_pressed_and_that_nothing_bends_is_pointed_out():
    [warning] = _warned(PRESSED)
    assert warning.pointer == "/loads" and "0.1 m nearer" in warning.rule


@pytest.mark.parametrize("change", [
    {"loads": {"gravity": [-9.81, 0.0, 0.0]}},
    {"loads": {"point": [{"s": 0.5, "force": [1e-6, 0.0, 0.0]}]}},
    {"ends": {"start": "clamp", "end": "slider"}},
    {"ends": _moved(0.01)},
])  # fmt: skip
def test_one_that_something_bends_or_that_is_pulled_is_left_alone(change: dict[str, Any]):
    assert _warned(PRESSED | change) == []


LIMP = {"rod": PRESSED["rod"] | {"youngs_modulus": 1e7, "shear_modulus": 4e6}, "t_end": 5.0,
        "output": {"interval": 0.5}}  # fmt: skip
TWISTED = {"ends": {"start": "clamp", "end": {"preset": "slider", "theta3": {"t": [0, 1], "value": [0, 25.0],
                                                                        "interpolation": "smoothstep"}}}}  # fmt: skip


@pytest.mark.parametrize(("change", "warned"), [
    ({"ends": {"start": "clamp", "end": "free"}, "loads": {"gravity": [0, 0, -9.81]}}, True),
    ({"ends": {"start": "free", "end": "clamp"}, "loads": {"gravity": [0, 0, -9.81]}}, False),
    ({"ends": {"start": "free", "end": "clamp"}, "loads": {"gravity": [0, 0, 9.81]}}, True),
    ({"ends": {"start": "clamp", "end": "free"}, "loads": {"gravity": [1e-9, 0, -9.81]}}, False),
    ({"ends": {"start": "clamp", "end": "free"}, "loads": {"point": [{"s": 1.0, "force": [0, 0, -1.0]}]}}, True),
    ({"ends": {"start": "clamp", "end": "free"}, "loads": {"point": [{"s": 1.0, "force": [0, 0, 1.0]}]}}, False),
    ({"ends": {"start": {"preset": "slider", "f3": -5.0}, "end": "clamp"}}, True),
    ({"ends": {"start": {"preset": "slider", "f3": -0.05}, "end": "clamp"}}, False),
    ({"ends": {"start": "clamp", "end": "free"},
      "loads": {"distributed": [{"force": [0, 0, -2.0]}]}}, True),
    (TWISTED, True), (TWISTED | {"analysis": "static"}, True),
    ({"analysis": "static", "ends": {"start": {"preset": "slider", "f3": -5.0}, "end": "clamp"}}, True),
    ({"analysis": "static", "ends": {"start": {"preset": "slider", "f3": -0.05}, "end": "clamp"}}, False),
    ({"analysis": "static", "ends": {"start": "clamp", "end": "free"}, "loads": {"gravity": [0, 0, -9.81]}}, True),
    ({"analysis": "static", "ends": {"start": "free", "end": "clamp"}, "loads": {"gravity": [0, 0, -9.81]}}, False),
])  # fmt: skip
def test_a_straight_rod_that_its_loads_press_or_wring_beyond_what_it_bears_is_pointed_out(change: dict[str, Any],
                                                                                          warned: bool):  # fmt: skip
    rules = [warning.rule for warning in _warned(PRESSED | LIMP | change) if warning.pointer == "/loads"]
    said = "no rod stays so" if change.get("analysis") == "static" else "disturbance would grow"
    assert [(said in rule) for rule in rules] == [True] * warned


def _lowered(by: float, **loads: Any) -> dict[str, Any]:
    """A straight thread above a floor, free below, whose upper end comes down."""
    end = {"preset": "clamp", "frame": "lab", "x3": {"t": [0, 1], "value": [0, -by], "interpolation": "smoothstep"}}
    floor = {"stiffness": 50.0, "normal": [0, 0, 1], "height": -0.05}
    loads = {"floor": floor, "gravity": [0, 0, -9.81], **loads}
    return PRESSED | {"ends": {"start": "free", "end": end}, "loads": loads}


def test_a_straight_thread_that_is_pushed_into_a_floor_end_first_is_pointed_out():
    [warning] = _warned(_lowered(0.3))
    assert warning.pointer == "/loads/floor" and "end first, by 0.25 m" in warning.rule


@pytest.mark.parametrize("case", [
    _lowered(0.05), _lowered(0.3, point=[{"s": 0.5, "force": [1e-9, 0.0, 0.0]}]), _lowered(0.3, gravity=[1, 0, -9.81]),
])  # fmt: skip
def test_one_that_does_not_reach_it_or_bends_aside_is_left_alone(case: dict[str, Any]):
    assert [warning for warning in _warned(case) if warning.pointer == "/loads/floor"] == []


@pytest.mark.parametrize(("interval", "warned"), [(0.0999999, True), (0.333, True), (0.1, False), (0.3, False)])
def test_a_last_frame_right_after_the_one_before_is_named(interval: float, warned: bool):
    warnings = told({"t_end": 1.0, "output.interval": interval})
    assert [(warning.pointer, warning.value) for warning in warnings] == [("/output/interval", interval)] * warned


@pytest.mark.parametrize(("intervals", "warned"), [(10, True), (100, False)])
def test_an_obstacle_that_fits_between_nodes_is_named(intervals: int, warned: bool):
    balls = [{"start": [0, 0, -1], "radius": radius, "stiffness": 5e5} for radius in (0.5, 0.02)]
    warnings = told({"loads.obstacles": balls, "numerics.intervals": intervals})
    assert [warning.pointer for warning in warnings] == ["/numerics/intervals"] * warned
    assert all("radius of 0.02 m of /loads/obstacles/1" in warning.rule for warning in warnings)


BAR = {"start": [0.0, -1.0, 0.5], "end": [0.0, 1.0, 0.5], "radius": 0.1, "stiffness": 5e5}


@pytest.mark.parametrize(("loads", "pointer"), [
    ({"loads.floor": {"stiffness": 50.0, "height": 0.3}}, "/loads/floor"),
    ({"loads.floor": {"stiffness": 50.0, "height": -0.01}}, ""),
    ({"loads.floor": {"stiffness": 50.0, "height": -2.0}, "loads.obstacles": [BAR | {"start": [9, 9, 9], "end": None},
                                                                               BAR]}, "/loads/obstacles/1"),
    ({"loads.obstacles": [BAR | {"radius": 0.005}]}, ""),
])  # fmt: skip
def test_a_rod_that_begins_in_something_solid_is_pointed_out(loads: dict[str, Any], pointer: str):
    assert [warning.pointer for warning in told({"numerics.intervals": 1000, **loads})] == [pointer] * bool(pointer)


@pytest.mark.parametrize(("stiffness", "warned"), [(900.0, True), (1100.0, False)])
def test_an_obstacle_that_a_pulled_rod_may_cut_through_is_told(stiffness: float, warned: bool):
    """A pull of 2 N over a bar of 0.1 m: T / (R k) = 2.2 cm, more than a fifth of the radius, or 1.8 cm."""
    bar = BAR | {"start": [0.2, -1.0, 0.5], "end": [0.2, 1.0, 0.5], "stiffness": stiffness}
    warnings = told({"loads.obstacles": [bar], "loads.point": [], "ends.end": {"preset": "free", "f3": 2.0}})
    assert [warning.pointer for warning in warnings] == ["/loads/obstacles/0/stiffness"] * warned


@pytest.mark.parametrize(("angle", "warned"), [(90.0, True), (6.28, False)])
def test_an_angle_that_is_likely_in_degrees_is_pointed_out(angle: float, warned: bool):
    swing = {"t": [0.0, 1.0], "value": [0.0, angle], "interpolation": "smoothstep"}
    warnings = told({"ends.start": {"preset": "clamp", "theta2": swing}})
    assert [warning.pointer for warning in warnings] == ["/ends/start/theta2"] * warned


@pytest.mark.parametrize(("pull", "warned"), [(-785.0, True), (-100.0, False)])
def test_a_rod_that_loads_stretch_beyond_the_theory_is_pointed_out(pull: float, warned: bool):
    """By 785 N of 2400 N."""
    jumper = {"preset": "pin", "frame": "lab", "f1": 0.0, "f2": 0.0, "f3": -pull}
    rod = PRESSED["rod"] | {"axial_stiffness": 2400.0}
    warnings = _warned(PRESSED | {"rod": rod, "ends": {"start": "pin", "end": jumper}, "output": {"interval": 1e-3}})
    assert [warning.pointer for warning in warnings] == ["/rod/axial_stiffness"] * warned
    assert all("by 0.33 of its length" in warning.rule for warning in warnings)


@pytest.mark.parametrize(("pull", "warned"), [(300.0, False), (500.0, True)])
def test_rubber_whose_axial_stiffness_is_that_of_its_section_is_left_alone(pull: float, warned: bool):
    """EA = 78.5 N: by 3.8 and by 6.4 of its length, of which a run bears 4."""
    rod = PRESSED["rod"] | {"youngs_modulus": 1e6, "shear_modulus": 4e5, "axial_stiffness": 78.5}
    jumper = {"preset": "pin", "frame": "lab", "f1": 0.0, "f2": 0.0, "f3": pull}
    warnings = _warned(PRESSED | {"rod": rod, "ends": {"start": "pin", "end": jumper}, "output": {"interval": 1e-3}})
    assert [warning.pointer for warning in warnings] == ["/rod/axial_stiffness"] * warned


def test_a_profile_that_goes_on_beyond_the_rod_is_told():
    table = {"s": [0.0, 500.0, 1000.0], "value": [1.0, 2.0, 1.0], "interpolation": "linear"}
    [warning] = [w for w in told({"rod.mass_per_length": table, "rod.length": 1.0}) if w.pointer.endswith("/s")]
    assert (warning.pointer, warning.value) == ("/rod/mass_per_length/s", 1000.0)
    assert "beyond the rod" in warning.rule


@pytest.mark.parametrize(("moved", "words"), [(0.02, ""), (0.08, "has to stretch by 8 %"), (0.5, "torn")])
@pytest.mark.parametrize("elastic", [False, True])
def test_ends_that_would_stretch_or_tear_the_rod_are_told(moved: float, words: str, elastic: bool):
    pulled = {"t": [0.0, 1.0], "value": [0.0, moved], "interpolation": "linear"}
    case = {"ends.start": "clamp", "ends.end": {"preset": "clamp", "x3": pulled}, "t_end": 2.0}
    found = [w.rule for w in told(case | ({"rod.axial_stiffness": 1e3} if elastic else {})) if w.pointer == "/ends"]
    assert len(found) == (0 if elastic or not words else 1)
    assert all(words in rule for rule in found)


@pytest.mark.parametrize(("heavy", "places", "warned"), [
    (100.0, (0.0, 0.95, 0.96, 1.0), True), (10.0, (0.0, 0.95, 0.96, 1.0), False), (100.0, (0.0, 0.6, 0.61, 1.0), False),
])  # fmt: skip
def test_a_short_heavy_piece_at_an_end_is_told_that_there_are_bodies(heavy: float, places: tuple[float, ...],
                                                                     warned: bool):  # fmt: skip
    for name, values in (("end", [1.0, 1.0, heavy, heavy]), ("start", [heavy, heavy, 1.0, 1.0])):
        s = list(places) if name == "end" else [1.0 - place for place in places[::-1]]
        mass = {"s": s, "value": values, "interpolation": "linear"}
        rod = {**PRESSED["rod"], "mass_per_length": mass, "inertia_per_length": [1e-4] * 3}
        rod.pop("density")
        found = _warned(PRESSED | {"rod": rod, "ends": {"start": "clamp", "end": "free"}})
        assert [f"ends.{name}.mass" in warning.rule for warning in found] == [True] * warned


LATER = {"t": [2.0, 3.0], "value": [0.0, 1.0], "interpolation": "linear"}


@pytest.mark.parametrize(("change", "pointer"), [
    ({"loads": {"point": [{"s": 0.5}]}}, "/loads/point/0"),
    ({"loads": {"point": [{"s": 0.5, "force": [LATER, 0.0, 0.0]}]}}, "/loads/point/0"),
    ({"loads": {"point": [{"s": 0.0, "force": [1.0, 0.0, 0.0]}]}}, "/loads/point/0"),
    ({"loads": {"distributed": [{"force": [0.0, 1.0, 0.0], "schedule": LATER}]}}, "/loads/distributed/0"),
    ({"fluid": {"density": 1000.0, "added_mass": 1.0, "current": [1.0, 0.0, 0.0]}}, "/fluid/current"),
    ({"fluid": {"density": 1000.0, "drag_normal": 1.0, "schedule": 2.0}}, "/fluid/schedule"),
    ({"loads": {"distributed": [{"force": [0.0, 1.0, 0.0]}, {"moment": [0.0, 0.0, 0.0]}]}}, "/loads/distributed/1"),
    ({"ends": {"start": "clamp", "end": {"preset": "free", "switches": [{"at": 1.0, "v1": 0.0}]}}},
     "/ends/end/switches"),
    ({"ends": {"start": {"preset": "clamp", "mass": 2.0}, "end": "free"}}, "/ends/start/mass"),
    ({"ends": {"start": {"preset": "clamp", "x2": 0.1}, "end": "free"}}, "/ends/start/x2"),
    ({"ends": {"start": "clamp", "end": {"preset": "free", "switches": [{"at": 0.5, "theta1": 0.1}]}}},
     "/ends/end/theta1"),
    ({"initial": {"shape": "straight", "velocity": [0.0, 2.0, 0.0]}}, "/initial/velocity"),
    ({"initial": {"shape": "straight", "angular_velocity": [0.0, 2.0, 0.0]}}, "/initial/angular_velocity"),
    ({"ends": {"start": "clamp", "end": {"preset": "clamp", "frame": "lab", "x1": {
        "t": [0.0, 0.5, 0.5001], "value": [0.0, 0.0, 0.2], "interpolation": "linear"}}}}, "/ends/end/x1"),
])  # fmt: skip
def test_what_does_nothing_and_what_comes_with_a_jerk_is_told(change: dict[str, Any], pointer: str):
    bare = {"ends": {"start": "clamp", "end": "free"}}
    assert _warned(PRESSED | bare) == []
    assert {warning.pointer for warning in _warned(PRESSED | bare | change)} == {pointer}


@pytest.mark.parametrize(("velocity", "start", "warned"), [
    ([0.0, 1.0, 0.0], "pin", False), ([0.0, 1.0, 0.0], "clamp", True), ([0.0, 2.0, 0.0], "pin", True),
])  # fmt: skip
def test_a_rod_that_begins_to_swing_about_its_pin_has_no_jerk(velocity: list[float], start: str, warned: bool):
    """A metre along e3 that turns about e1 by -2 rad/s: its middle, half a metre above the pin, moves by 1 m/s."""
    swinging = {"initial": {"shape": "straight", "velocity": velocity, "angular_velocity": [-2.0, 0.0, 0.0]},
                "ends": {"start": start, "end": "free"}}  # fmt: skip
    found = {warning.pointer for warning in _warned(PRESSED | swinging)}
    assert ("/initial/angular_velocity" in found) == warned


@pytest.mark.parametrize(("component", "motion", "warned"), [
    ("v1", 0.2, True), ("x2", {"t": [0.0, 1.0], "value": [0.0, 0.1], "interpolation": "linear"}, True),
    ("v1", {"t": [0.0, 0.5], "value": [0.0, 0.2], "interpolation": "linear"}, False),
    ("x2", {"t": [0.0, 1.0], "value": [0.0, 0.1], "interpolation": "smoothstep"}, False),
])  # fmt: skip
def test_an_end_that_moves_at_once_is_told_where_the_rod_is_at_rest(component: str, motion: Any, warned: bool):
    case = PRESSED | {"ends": {"start": {"preset": "clamp", component: motion}, "end": "free"}}
    assert [warning.pointer for warning in _warned(case)] == [f"/ends/start/{component}"] * warned
    moving = {"initial": {"shape": "straight", "velocity": [0.2, 0.1, 0.0]}}
    assert not any("at rest" in warning.rule for warning in _warned(case | moving))


def test_an_end_that_moves_at_once_is_told_however_long_the_run_goes_on_and_not_what_is_little_beside():
    soon = {"t": [0.0, 1.0], "value": [0.0, 1.0], "interpolation": "linear"}
    slow = {"t": [0.0, 0.2, 1.0], "value": [0.0, 1e-4, 1.0], "interpolation": "pchip"}
    little = {"t": [0.0, 1.0], "value": [0.0, 1e-3], "interpolation": "linear"}
    for motion, t_end, pointers in (({"x1": soon, "x2": little}, 2.0, ["/ends/start/x1"]),
                                    ({"x1": slow}, 2.0, []), ({"x1": slow}, 2000.0, [])):  # fmt: skip
        end = {"preset": "clamp", "frame": "lab"} | motion
        case = PRESSED | {"t_end": t_end, "ends": {"start": end, "end": "free"}}
        assert [warning.pointer for warning in _warned(case) if "jerk" in warning.rule] == pointers


@pytest.mark.parametrize(("stiffer", "analysis", "warned"), [
    (None, "dynamic", True), (1.0, "dynamic", True), (100.0, "dynamic", False), (None, "static", False),
])  # fmt: skip
def test_an_end_that_is_faster_than_sound_is_told_where_it_has_a_speed(stiffer: float | None, analysis: str,
                                                                       warned: bool):  # fmt: skip
    """Sound runs by the axial stiffness that the rod has; in a static analysis the time is no time."""
    scene = build_scene(parse_case(PRESSED))
    EA = 16.0 * float(scene.rod.stiffness[0](0.0)) / float(scene.rod.diameter(0.0)) ** 2
    sound = float(np.sqrt(EA / scene.rod.mass(0.0)))
    fast = {"t": [0.0, 0.1 / sound], "value": [0.0, 0.2], "interpolation": "linear"}
    rod = PRESSED["rod"] | ({"axial_stiffness": stiffer * EA} if stiffer else {})
    case = PRESSED | {"rod": rod, "analysis": analysis,
                      "ends": {"start": {"preset": "clamp", "frame": "lab", "x1": fast}, "end": "free"}}  # fmt: skip
    assert any("faster than sound" in warning.rule for warning in _warned(case)) == warned


@pytest.mark.parametrize(("rise", "warned"), [(0.0, True), (0.03, False)])
def test_a_shape_that_begins_within_itself_is_told_where_there_is_contact(rise: float, warned: bool):
    """Two turns of a helix of radius 1 / 4 pi, which lie in each other or above each other; a ring touches its end."""
    turns = np.linspace(0.0, 2.0, 81)
    size = np.hypot(1.0, 2.0 * rise)
    helix = [[np.cos(2 * pi * t) / (4 * pi), np.sin(2 * pi * t) / (4 * pi), rise * t] for t in turns]
    shape = {"initial": {"shape": "centreline", "points": helix}, "rod": PRESSED["rod"] | {"length": size}}
    found = [warning.pointer for warning in _warned(PRESSED | shape | {"contact": {}})]
    assert ("/initial" in found) == warned


def test_a_ring_does_not_begin_within_itself():
    ring = [[np.cos(x) / (2 * pi), np.sin(x) / (2 * pi), 0.0] for x in np.linspace(0.0, 2 * pi, 81)]
    shape = {"initial": {"shape": "centreline", "points": ring}, "contact": {}}
    assert "/initial" not in [warning.pointer for warning in _warned(PRESSED | shape)]


@pytest.mark.parametrize(("analysis", "pointers"), [
    ("static", ["/loads/floor/friction", "/loads/obstacles/1/friction"]), ("dynamic", []),
])  # fmt: skip
def test_friction_counts_for_nothing_at_rest(analysis: str, pointers: list[str]):
    bar = {"start": [5.0, 0.0, 0.0], "end": [6.0, 0.0, 0.0], "radius": 0.1, "stiffness": 1e3}
    floor = {"stiffness": 1e3, "height": -9.0, "friction": 0.2}
    settings = {"loads.floor": floor, "loads.obstacles": [bar, bar | {"friction": 0.3}], "analysis": analysis}
    assert [warning.pointer for warning in told(settings)] == pointers
