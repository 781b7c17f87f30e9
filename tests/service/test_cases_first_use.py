"""Warnings that people who wrote their first cases missed, and false ones that they got."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from service.cases import apply_settings, build_scene, parse_case, warnings_of
from service.cases.errors import FieldError

STEEL = {"length": 4.0, "diameter": 0.05, "youngs_modulus": 2.1e11, "shear_modulus": 8e10, "density": 7850.0}
COLUMN: dict[str, Any] = {
    "schema_version": 1, "rod": STEEL, "initial": {"shape": "straight", "direction": [0, 0, 1]},
    "ends": {"start": "clamp", "end": "free"}, "loads": {"gravity": [0.0, 0.0, -9.81]}, "t_end": 1.0,
    "output": {"interval": 0.01},
}  # fmt: skip
STRING = {"rod": {"length": 0.65, "diameter": 3e-4, "density": 7850.0, "youngs_modulus": 2e11, "shear_modulus": 8e10},
          "ends": {"start": "pin", "end": {"preset": "pin", "frame": "lab", "f3": 72.0}},
          "loads": {"distributed": [{"force": [1e-3, 0, 0]}]}, "t_end": 0.06}  # fmt: skip
CABLE = {"rod": {"length": 60.0, "diameter": 0.02, "mass_per_length": 0.6, "bending_stiffness": 30.0,
                 "torsional_stiffness": 40.0}, "contact": {}}  # fmt: skip


def warned(change: dict[str, Any], **settings: Any) -> list[FieldError]:
    raw = COLUMN | change
    spec = parse_case(apply_settings(raw, {name.replace("__", "."): value for name, value in settings.items()}))
    return warnings_of(spec, build_scene(spec))


def pointers(change: dict[str, Any], **settings: Any) -> list[str]:
    return [warning.pointer for warning in warned(change, **settings)]


@pytest.mark.parametrize(("mass", "expected"), [(20e3, ["/loads"]), (100.0, [])])
def test_a_body_presses_the_column_that_it_stands_on(mass: float, expected: list[str]):
    """Which bears 9.9 kN, less its own weight."""
    assert pointers({}, ends__end={"preset": "free", "mass": mass}) == expected


@pytest.mark.parametrize(("turns", "pull", "expected"), [(7.0, 2.0, ["/loads"]), (7.0, 400.0, []), (0.1, 2.0, [])])
def test_a_cable_that_is_twisted_at_first_is_pulled_straight_or_buckles(turns: float, pull: float, expected: list[str]):
    """Its torque, 29 N m at 7 turns, is beyond 2 sqrt(EJ T) up to a pull of 7 N."""
    slack = {"initial": {"shape": "straight", "direction": [0, 0, 1], "twist": {
                 "s": [0.0, 60.0], "value": [0.0, 2 * np.pi * turns], "interpolation": "linear"}},
             "ends": {"start": "clamp", "end": {"preset": "slider", "f3": pull}}, "loads": {}}  # fmt: skip
    assert pointers(CABLE | slack | {"analysis": "static"}) == expected
    needs = pointers(CABLE | slack | {"contact": None})
    assert ("/contact" in needs) == bool(expected)


@pytest.mark.parametrize(("value", "thin", "expected"), [(45.0, True, []), (45.0, False, ["/initial/twist"]),
                                                         (44.0, False, [])])
def test_turns_are_taken_for_degrees_where_they_are_much_for_the_rod(value: float, thin: bool, expected: list[str]):
    rod = CABLE["rod"] if thin else CABLE["rod"] | {"length": 6.0}  # type: ignore[operator]
    twist = {"s": [0.0, 6.0], "value": [0.0, value], "interpolation": "linear"}
    turned = {"rod": rod, "initial": {"shape": "straight", "direction": [0, 0, 1], "twist": twist}, "loads": {}}
    assert [at for at in pointers(turned) if at == "/initial/twist"] == expected


@pytest.mark.parametrize(("interval", "expected"), [(1e-4, []), (0.01, ["/output/interval"])])
def test_frames_that_cannot_show_a_string_are_too_few(interval: float, expected: list[str]):
    """f1 = sqrt(72 N / 0.55 g/m) / 1.3 m = 279 Hz."""
    [*found] = warned(STRING, output__interval=interval)
    assert [warning.pointer for warning in found] == expected
    assert all("0.0036 s" in warning.rule for warning in found)


def test_frames_that_show_how_a_string_is_driven_are_enough():
    table = {"t": [0.0, 0.06], "value": [0.0, 1.0], "interpolation": "linear"}
    driven = [{"force": [1e-3, 0, 0], "schedule": table}]
    assert pointers(STRING, output__interval=0.01, loads__distributed=driven) == []


@pytest.mark.parametrize(("velocity", "expected"), [(None, []), (0.0, ["/initial/angular_velocity"] * 2)])
def test_a_bent_rope_that_turns_about_its_pins_has_no_jerk(velocity: float | None, expected: list[str]):
    """A bow 1 m deep between pins on e1, whose centre of mass moves by omega z."""
    x = np.linspace(0.0, 4.0, 41)
    z = -(x / 2.0) * (2.0 - x / 2.0)
    length = float(np.sum(np.hypot(np.diff(x), np.diff(z))))
    depth = float(np.sum(np.hypot(np.diff(x), np.diff(z)) * 0.5 * (z[1:] + z[:-1]))) / length
    rope = {"rod": CABLE["rod"] | {"length": length}, "loads": {}, "ends": {"start": "pin", "end": "pin"},  # type: ignore[operator]
            "initial": {"shape": "centreline", "points": np.column_stack([x, 0 * x, z]).tolist(),
                        "angular_velocity": [3.0, 0.0, 0.0],
                        "velocity": [0.0, -3.0 * depth if velocity is None else velocity, 0.0]}}  # fmt: skip
    found = warned(rope)
    assert [warning.pointer for warning in found] == expected
    for warning in found:
        told = float(warning.rule.rpartition("[")[2].split(",")[1])
        assert told == pytest.approx(-3.0 * depth, rel=1e-3)


@pytest.mark.parametrize(("stiffness", "warns"), [(5.0, True), (1e5, False)])
def test_a_floor_that_is_far_too_soft_is_told_with_what_would_be_hard(stiffness: float, warns: bool):
    lying = {"rod": CABLE["rod"], "initial": {"shape": "straight", "direction": [1, 0, 0]},
             "loads": {"gravity": [0.0, 0.0, -9.81], "floor": {"stiffness": stiffness}},
             "ends": {"start": "free", "end": "free"}}  # fmt: skip
    found = [warning for warning in warned(lying) if warning.pointer == "/loads/floor/stiffness"]
    assert [warning.value for warning in found] == [stiffness] * warns
    assert all("3e+03 N/m² would be hard" in warning.rule for warning in found)


@pytest.mark.parametrize(("change", "pointer"), [
    ({"fluid": {"density": 1025.0, "drag_normal": 1.2, "current": [100.0, 0, 0]}}, "/fluid/current"),
    ({"rod": STEEL | {"length": 1e-5, "diameter": 2e-7}, "fluid": {"density": 1e3, "drag_normal": 1.2}},
     "/fluid/drag_normal"),
    ({"initial": {"shape": "straight", "direction": [0, 0, 1], "angular_velocity": [9000.0, 0.0, 0.0]},
      "ends": {"start": "free", "end": "free"}, "loads": {}}, "/initial/angular_velocity"),
])  # fmt: skip
def test_what_no_fluid_and_no_rod_does_is_told(change: dict[str, Any], pointer: str):
    assert pointer in pointers(change)
    assert pointers({"fluid": {"density": 1.2, "drag_normal": 1.2, "current": [50.0, 0, 0]}}) == []


def lying(points: np.ndarray, **others: Any) -> dict[str, Any]:
    """A rope that lies along points (n, 3)."""
    length = float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())
    return {"rod": CABLE["rod"] | {"length": length} | others, "ends": {"start": "pin", "end": "free"}, "loads": {},
            "initial": {"shape": "centreline", "points": points.tolist()}}  # fmt: skip


A = np.linspace(-2.6, 2.6, 301)
KNOT = np.column_stack([A**3 - 3.0 * A, A**4 - 4.0 * A**2, 0.2 * A**5 - 2.0 * A])
WAVE = np.column_stack([A, np.sin(A), 0.0 * A])
RADIUS, PITCH = 0.1, 0.01
COIL = np.column_stack([RADIUS * np.cos(5.0 * A), RADIUS * np.sin(5.0 * A), PITCH * 5.0 * A])
WOUND = [0.0, RADIUS / (RADIUS**2 + PITCH**2), PITCH / (RADIUS**2 + PITCH**2)]


@pytest.mark.parametrize(("points", "others", "warns"), [
    (KNOT, {}, True), (WAVE, {}, False), (COIL, {}, True), (COIL, {"kappa0": WOUND}, False)
], ids=["knot", "wave", "coil", "spring"])  # fmt: skip
def test_a_rod_that_lies_across_itself_needs_contact(points: np.ndarray, others: dict[str, Any], warns: bool):
    rope = lying(points, **others)
    assert ("/contact" in pointers(rope)) == warns
    assert "/contact" not in pointers(rope | {"contact": {}})


@pytest.mark.parametrize(("stiffness", "warns"), [(1.9e-28, False), (1.9e-10, True), (1.9e-38, True)])
def test_a_bending_stiffness_is_looked_at_beside_the_diameter(stiffness: float, warns: bool):
    dna = {"length": 1e-7, "diameter": 2e-9, "mass_per_length": 5e-15, "bending_stiffness": stiffness,
           "torsional_stiffness": stiffness}  # fmt: skip
    assert ("/rod/bending_stiffness" in pointers({"rod": dna, "loads": {}})) == warns


def test_a_value_is_told_in_digits_that_it_has():
    assert str(FieldError("/x", 40.00000000000001, "is much")) == "/x is much, got 40"
