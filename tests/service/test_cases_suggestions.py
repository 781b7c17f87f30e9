"""Refusals that help: the field that was meant, and large numbers told by their size."""

from __future__ import annotations

from typing import Any

import pytest

from service.cases import CaseError, CaseSpec, apply_settings, load_case, parse_case
from service.cases.other_names import OTHER_NAMES, named_otherwise, not_there
from service.cases.suggestions import fields_at


def refusal(setting: str, value: Any) -> CaseError:
    """How elastica with one setting is refused."""
    with pytest.raises(CaseError) as caught:
        parse_case(apply_settings(load_case("elastica"), {setting: value}))
    return caught.value


@pytest.mark.parametrize(("setting", "meant"), [
    ("rod.lenght", "length"), ("rod.Density", "density"), ("numeric", "numerics"), ("loads.gravty", "gravity"),
    ("numerics.interval", "intervals"), ("output.intervals", "interval"), ("fluid.densty", "density"),
    ("ends.start", "omega3"),
])  # fmt: skip
def test_an_unknown_field_is_told_with_the_one_that_was_meant(setting: str, meant: str):
    value: Any = {"preset": "clamp", "omga3": 0.0} if setting == "ends.start" else 1.0
    told = str(refusal(setting, value))
    assert "is not a known field, got " in told
    assert told.endswith(f": did you mean {meant}?")


@pytest.mark.parametrize(("setting", "hint"), [
    ("rod.fluid", " here: its place is fluid"), ("gravity", " here: its place is loads.gravity"),
    ("interval", " here: its place is output.interval"), ("output.t_end", " here: its place is t_end"),
    ("loads.force", " here: its place is loads.distributed.0.force or loads.point.0.force"),
    ("rod.E", ": did you mean youngs_modulus?"), ("rod.G", ": did you mean shear_modulus?"),
    ("rod.radius", ": did you mean diameter, which is twice the radius?"),
    ("rod.nu", ": did you mean shear_modulus, which is E / (2 (1 + nu))?"),
    ("ends.left", ": did you mean start?"), ("numerics.dt", ": did you mean dt_max?"),
    ("duration", ": did you mean t_end?"),
    ("rod.f3", ""), ("rod.interpolation", ""), ("stiffnesses", ""),
])  # fmt: skip
def test_a_field_by_another_name_or_in_another_place_is_told_as_that(setting: str, hint: str):
    [fault] = [fault for fault in refusal(setting, 1.0).errors if fault.pointer == "/" + setting.replace(".", "/")]
    assert fault.rule == "is not a known field" + hint


def test_a_value_is_quoted_before_what_there_is_instead():
    told = str(refusal("ends.end", {"preset": "free", "stiffness": 5.0}).errors[0])
    assert told == "/ends/end/stiffness is not a known field, got 5.0: " + not_there("stiffness", ["ends", "end"], [])


def test_a_case_within_another_object_is_told_as_that():
    with pytest.raises(CaseError) as refused:
        parse_case({"case": load_case("elastica")})
    assert [(fault.pointer, fault.rule) for fault in refused.value.errors] == [
        ("/case", "is not a known field: send what it holds by itself")
    ]


def test_what_a_wrong_object_lacks_is_not_told():
    [fault] = refusal("ends.start", {"preset": "clamp", "v3": {"stop_within": 0.1}}).errors
    assert fault.rule == "is not a known field here: its place is in switches"
    [fault] = refusal("ends.end", {"preset": "clamp", "switches": [{"at": 1.0, "x1": {"stop_within": 1.0}}]}).errors
    assert fault.rule == "is not a known field here: its place is in v1, v2, v3, omega1, omega2, omega3"
    faults = refusal("rod", {"length": 1.0, "diametre": 0.01, "density": 1.0}).errors
    assert {fault.rule for fault in faults} >= {"is required", "is not a known field: did you mean diameter?"}


def test_a_force_at_an_end_is_one_of_its_components():
    fault = refusal("ends.end", {"preset": "free", "force": [1, 0, 0]}).errors[0]
    assert fault.rule == "is not a known field: did you mean f3, f1 or f2?"


PLACES = [fields_at(CaseSpec, path.split(".") if path else []) for path in
          ("", "rod", "rod.diameter", "initial", "ends", "ends.end", "ends.end.f3", "fluid", "loads", "loads.point",
           "loads.floor", "loads.obstacles", "numerics", "output")]  # fmt: skip


def test_every_other_name_is_of_a_field_that_there_is():
    told = {named_otherwise(name, fields).split(",")[0] for fields in PLACES for _, others, _ in OTHER_NAMES
            for name in others.split() if name not in fields}  # fmt: skip
    assert told - {""} == {field for field, *_ in OTHER_NAMES}


@pytest.mark.parametrize(("setting", "value", "told"), [
    ("rod.length", "1.5e-3", "/rod/length must be a number without quotation marks, got '1.5e-3'"),
    ("rod.length", "1,5", "/rod/length must be a number with a point, not a comma, got '1,5'"),
    ("rod.length", "1.5 mm", "/rod/length must be a number alone, in SI units, got '1.5 mm'"),
    ("rod.length", "long", "/rod/length must be a number, got 'long'"),
    ("rod.length", None, "/rod/length must be a number, not null"),
    ("rod.length", True, "/rod/length must be a number, got true"),
    ("rod.length", {"value": [1.0, None]}, '/rod/length must be a number, got {"value": [1.0, null]}'),
    ("rod.diameter", [0.01, 0.02], "/rod/diameter must be a number or a table, which is an object, got [0.01, 0.02]"),
    ("rod.diameter", None, "/rod/diameter must be a number or a table, which is an object, not null"),
    ("rod.diameter", "thin", "/rod/diameter must be a number or a table, which is an object, got 'thin'"),
    ("ends.end", None, "/ends/end must be an object or the name of a preset, not null"),
    ("rod.kappa0", 1.0, "/rod/kappa0 must be a list of 3 entries or 'initial', got 1.0"),
    ("rod.kappa0", "straight", "/rod/kappa0 must be 'initial' or a list of 3 entries, got 'straight'"),
    ("numerics.intervals", "100", "/numerics/intervals must be an integer without quotation marks, got '100'"),
    ("output.topology", "yes", "/output/topology must be true or false, got 'yes'"),
    ("name", 3, "/name must be a text, got 3"),
    ("loads.gravity", [0.0, -9.81], "/loads/gravity/2 is required: the list ends after 2 entries"),
    ("loads.gravity", [0.0, 0.0, {"t": [0, 1]}],
     "/loads/gravity/2 must be a number; gravity stays the same: a load that changes is in loads.distributed, with a "
     'schedule, got {"t": [0, 1]}'),
    ("ends.start", {"preset": "clamp", "v1": "5*sin(t)"},
     "/ends/start/v1 must be a number, not a formula: a function of time is a table, of some 20 points a period with "
     "interpolation cubic, got '5*sin(t)'"),
    ("ends.start", {"preset": "clamp", "v1": {"t": [0, 1], "value": [0, 1]}},
     "/ends/start/v1/interpolation is required: linear, smoothstep, pchip or cubic; "
     "smoothstep begins and ends at rest"),
    ("loads.gravity", -9.81, "/loads/gravity must be a list of 3 entries, got -9.81"),
    ("loads.gravity", None, "/loads/gravity must be a list of 3 entries, not null"),
    ("loads.point", {"s": 0.5}, '/loads/point must be a list of objects: [{...}], got {"s": 0.5}'),
    ("initial", {"shape": "centreline", "points": [[0, 0, 0], [0, 0, 1], [0, 0, 2], 3]},
     "/initial/points/3 must be a list of 3 entries, got 3"),
    ("output.fields", "r", "/output/fields must be a list, got 'r'"),
    ("initial", "straight", "/initial must be an object, whose shape must be straight or centreline, got 'straight'"),
    ("initial.direction", [0, 0, 0], "/initial/direction must not be zero, got [0.0, 0.0, 0.0]"),
])  # fmt: skip
def test_a_value_of_another_kind_is_told_with_what_was_likely_meant(setting: str, value: Any, told: str):
    assert str(refusal(setting, value)) == told


def test_a_text_of_a_megabyte_is_told_of_at_once():
    assert refusal("rod.length", "1" * 1_000_000 + "°").errors[0].rule == "must be a number"


def test_a_list_with_a_fault_in_it_is_not_told_to_be_too_short():
    [fault] = refusal("output.fields", ["position"]).errors
    assert fault.pointer == "/output/fields/0"
    assert refusal("output.fields", []).errors[0].rule == "must have at least 1 entries"


def test_a_field_of_another_kind_is_told_as_that():
    [error] = refusal("initial", {"shape": "straight", "points": [[0, 0, 0], [0, 0, 1]]}).errors
    rule = "is not a known field of this kind of initial, but of another"
    assert (error.pointer, error.rule) == ("/initial/points", rule)


def test_a_field_that_is_like_no_other_is_told_by_itself():
    [error] = refusal("rod.colour", "red").errors
    assert error.rule == "is not a known field"


@pytest.mark.parametrize(("value", "told"), [(10**300, "1e+300"), (-(10**300), "-1e+300"), (10**400, "1e400")])
def test_a_number_of_hundreds_of_digits_is_told_by_its_size(value: int, told: str):
    message = str(refusal("rod.density" if value > 10**308 else "numerics.intervals", value))
    assert told in message
    assert "0" * 20 not in message


@pytest.mark.parametrize("setting", ["<table>", "<b", "rod.<a>", "loads.<straight>", "initial.<straight>"])
def test_an_unknown_field_in_angle_brackets_is_told_too(setting: str):
    """Found by texts of any kind: below another field it was a fault of the service."""
    [fault] = refusal(setting, 1.0).errors
    assert fault.pointer == "/" + setting.replace(".", "/") and fault.rule.startswith("is not a known field")


@pytest.mark.parametrize(("setting", "value", "instead"), [
    ("fluid", {"density": 1e3, "drag_linear": 0.1}, "viscosity"),
    ("contact", {"friction": 0.3}, "without friction"), ("ends.end", {"preset": "free", "stiffness": 5.0}, "no spring"),
    ("loads.point", [{"s": 0.5, "schedule": 2.0}], "a function of time itself"),
    ("fluid", {"surface": 60.0}, "fills all"),
    ("loads.point", [{"s": 0.5, "mass": 2.0}], "a larger mass_per_length"), ("loads", {"temperature": 2.0}, "thermal"),
    ("loads.obstacles", [{"point": [0, 0, 0], "velocity": [1, 0, 0]}], "stands still"),
    ("rods", [{}, {}], "a case has one rod"), ("supports", [], "is an obstacle"), ("_comment", "a note", "description"),
    ("fluid", {"density": 1e3, "wave_height": 2.0}, "a current with a schedule"),
    ("ends.end", {"preset": "free", "f3": {"amplitude": 1.0, "frequency": 2.0}}, "a table of t and value"),
])  # fmt: skip
def test_what_hockle_does_not_have_is_told_with_what_there_is_instead(setting: str, value: Any, instead: str):
    assert any(instead in fault.rule for fault in refusal(setting, value).errors)


@pytest.mark.parametrize(("end", "meant"), [("roller", "a pin with frame lab"), ("fixed", "clamp"), ("Hinged", "pin"),
                                            ({"preset": "built-in"}, "clamp")])  # fmt: skip
def test_an_end_by_another_name_is_told_as_that(end: Any, meant: str):
    [fault] = refusal("ends.end", end).errors
    assert f": did you mean {meant}" in str(fault) or f"did you mean an object, {meant}" in str(fault)


@pytest.mark.parametrize(("setting", "value", "meant"), [
    ("initial.shape", "helix", "centreline, with points of that curve"), ("ends.start", "bearing", "pin"),
    ("ends.start", {"preset": "clamp", "v1": {"t": [0, 1], "value": [0, 1], "interpolation": "sine"}}, "cubic"),
])  # fmt: skip
def test_a_kind_by_another_name_is_told_as_that(setting: str, value: Any, meant: str):
    [fault] = refusal(setting, value).errors
    assert f": did you mean {meant}" in str(fault)


def test_what_jumps_is_told_how_to_write_that():
    [fault] = refusal("ends.start", {"preset": "clamp", "v1": {"t": [0, 1, 1], "value": [0, 1, 2],
                                                             "interpolation": "linear"}}).errors  # fmt: skip
    assert fault.rule.endswith("entry before it (1.0): where it jumps, let two points be close together")


def test_a_shipped_case_that_is_misspelt_is_told_as_that():
    with pytest.raises(CaseError, match=r"a file that is there, or one of .*did you mean hanging-cable\?"):
        load_case("hanging-cabel")
