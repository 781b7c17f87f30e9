"""Cases: what is accepted, and how everything else is refused."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from service.cases import (
    CaseError,
    apply_settings,
    case_schema,
    load_case,
    parse_case,
    shipped_cases,
)


def small_case() -> dict[str, Any]:
    """A short case with every part in it."""
    return {
        "schema_version": 1,
        "name": "small",
        "rod": {
            "length": 1.0,
            "diameter": {"s": [0.0, 0.5, 1.0], "value": [0.01, 0.009, 0.01], "interpolation": "cubic"},
            "youngs_modulus": 1.25e7,
            "shear_modulus": 5e6,
            "density": 1500,
        },
        "initial": {"shape": "straight"},
        "ends": {
            "start": {
                "preset": "clamp",
                "omega3": {"t": [0.0, 0.5], "value": [0.0, 2.0], "interpolation": "smoothstep"},
            },
            "end": {"preset": "slider", "switches": [{"at": 3.0, "v3": {"stop_within": 0.1}}]},
        },
        "fluid": {"density": 1000.0, "current": [0.0, 0.1, 0.0]},
        "loads": {
            "gravity": [0.0, 0.0, -9.81],
            "distributed": [{"force": [1e-4, 0, 0]}],
            "point": [{"s": 0.5, "force": [0, {"t": [0, 1], "value": [0, 1], "interpolation": "linear"}, 0]}],
        },
        "contact": {"k1": 1e-7, "k2": 3, "aperture_deg": 70, "cutoff": 0.02, "skip": 0.04, "spacing": 0.001},
        "numerics": {"intervals": 20},
        "t_end": 2.0,
        "output": {"interval": 0.1},
    }


CURVED = {
    "shape": "centreline",
    "points": [[0, 0, 0], [0, 0, 0.3], [0, 0, 0.6], [0, 0, 1.0]],
}

REFUSED: list[tuple[str, Any, str]] = [
    # (setting, value, pointer of the fault); the value `...` removes the field
    ("schema_version", 2, "/schema_version"),
    ("schema_version", ..., "/schema_version"),
    ("name", "Two Words", "/name"),
    ("colour", "red", "/colour"),
    ("rod", ..., "/rod"),
    ("rod", 3.0, "/rod"),
    ("rod.length", 0.0, "/rod/length"),
    ("rod.length", "1 m", "/rod/length"),
    ("rod.length", True, "/rod/length"),
    ("rod.length", float("nan"), "/rod/length"),
    ("rod.length", 10**400, "/rod/length"),
    ("rod.radius", 0.1, "/rod/radius"),
    ("rod.diameter", ..., "/rod/diameter"),
    ("rod.diameter", -0.01, "/rod/diameter"),
    ("rod.diameter.value", [0.01, 0.009], "/rod/diameter/value"),
    ("rod.diameter.value.1", -0.009, "/rod/diameter/value/1"),
    ("rod.diameter.value.1", float("inf"), "/rod/diameter/value/1"),
    ("rod.diameter.s", [0.0, 0.5, 0.5], "/rod/diameter/s/2"),
    ("rod.diameter.s", [0.0], "/rod/diameter/s"),
    ("rod.diameter.s", [i * 1e-5 for i in range(10_001)], "/rod/diameter/s"),
    ("rod.diameter.interpolation", "quintic", "/rod/diameter/interpolation"),
    ("rod.diameter.interpolation", ..., "/rod/diameter/interpolation"),
    ("rod.diameter", {"t": [0, 1], "value": [1, 1], "interpolation": "linear"}, "/rod/diameter/s"),
    ("rod.diameter.value", [0.01, 1e-5, 0.04], "/rod"),  # the spline through these is negative somewhere
    ("rod.youngs_modulus", ..., "/rod/youngs_modulus"),
    ("rod.bending_stiffness", 1.0, "/rod/youngs_modulus"),
    ("rod.bending_stiffness", [1.0, 1.0, 1.0], "/rod/bending_stiffness"),
    ("rod.torsional_stiffness", 1.0, "/rod/shear_modulus"),
    ("rod.density", ..., "/rod/density"),
    ("rod.inertia_per_length", [1.0, 0.0, 1.0], "/rod/inertia_per_length/1"),
    ("rod.kappa0", "straight", "/rod/kappa0"),
    ("rod.kappa0", [0.0, 0.0], "/rod/kappa0/2"),
    ("initial.shape", "circle", "/initial/shape"),
    ("initial.shape", ..., "/initial/shape"),
    ("initial.direction", [0, 0, 0], "/initial/direction"),
    ("initial.a1", [0, 0, 2], "/initial/a1"),
    ("initial.points", [[0, 0, 0]], "/initial/points"),
    ("initial", CURVED | {"points": CURVED["points"][:3]}, "/initial/points"),
    ("initial", CURVED | {"points": [*CURVED["points"], [0, 0, 1.0]]}, "/initial/points/4"),
    ("initial", CURVED | {"points": [*CURVED["points"], [0, 0, 1.2]]}, "/initial"),
    ("initial", CURVED | {"a1": [0, 0, 1]}, "/initial"),
    ("initial.velocity", [1.0, 2.0], "/initial/velocity/2"),
    ("ends.start", "glued", "/ends/start"),
    ("ends.start", {"v1": 0, "v2": 0, "v3": 0, "omega1": 0, "omega2": 0}, "/ends/start"),
    ("ends.start.theta3", 1.0, "/ends/start/theta3"),
    ("ends.start.omega3.t", [0.5, 0.0], "/ends/start/omega3/t/1"),
    ("ends.start.omega3", {"stop_within": 0.1}, "/ends/start/omega3/stop_within"),
    ("ends.start.frame", "global", "/ends/start/frame"),
    ("ends.end.switches.0.at", 0.0, "/ends/end/switches/0/at"),
    ("ends.end.switches", [{"at": 1.0}], "/ends/end/switches/0"),
    ("ends.end.switches", [{"at": 1.0, "preset": None, "x1": None}], "/ends/end/switches/0"),
    ("ends.end.switches", [{"at": 2.0, "v3": 0}, {"at": 1.0, "f3": 0}], "/ends/end/switches/1/at"),
    ("ends.end.switches.0.v3.stop_within", -0.1, "/ends/end/switches/0/v3/stop_within"),
    ("ends.end.switches.0.f3", 0.0, "/ends/end/switches/0/f3"),
    ("ends.middle", "clamp", "/ends/middle"),
    ("fluid.density", 0.0, "/fluid/density"),
    ("fluid.current", [0.1, 0.0, None], "/fluid/current/2"),
    ("fluid.drag", 1.0, "/fluid/drag"),
    ("fluid.shear", {"height": [0, 0], "factor": [0, 1], "interpolation": "linear"}, "/fluid/shear/height/1"),
    ("fluid.shear", {"height": [0, 1], "factor": [0, 1, 1], "interpolation": "linear"}, "/fluid/shear/factor"),
    ("fluid.shear", {"height": [0, 1], "factor": [0, 1], "interpolation": "linear", "normal": [0, 0, 0]},
     "/fluid/shear/normal"),
    ("loads.gravity", -9.81, "/loads/gravity"),
    ("loads.damping", -1.0, "/loads/damping"),
    ("loads.point.0.s", 1.5, "/loads/point/0/s"),
    ("loads.point.0.force.1.t.1", 0.0, "/loads/point/0/force/1/t/1"),
    ("loads.distributed.0.frame", "body", "/loads/distributed/0/frame"),
    ("contact.aperture_deg", 200.0, "/contact/aperture_deg"),
    ("contact.aperture", 1.2, "/contact/aperture"),
    ("contact.sum", "integral", "/contact/sum"),
    ("contact.skip", ..., "/contact/skip"),
    ("numerics.method", None, "/numerics/method"),
    ("numerics.rho_inf", None, "/numerics/rho_inf"),
    ("numerics.method", "finite_elements", "/numerics/method"),
    ("numerics.intervals", 100.5, "/numerics/intervals"),
    ("numerics.intervals", 1, "/numerics/intervals"),
    ("numerics.intervals", 10**9, "/numerics/intervals"),
    ("numerics.rho_inf", 1.1, "/numerics/rho_inf"),
    ("numerics.dt_max", 1e-9, "/numerics/dt_max"),
    ("t_end", 0.0, "/t_end"),
    ("output.interval", 3.0, "/output/interval"),
    ("output.interval", 1e-7, "/output/interval"),
    ("output.fields", ["r", "w"], "/output/fields/1"),
    ("output.fields", ["r", "r"], "/output/fields/1"),
    ("output.fields", [], "/output/fields"),
]


def changed(key: str, value: Any) -> dict[str, Any]:
    if value is not ...:
        return apply_settings(small_case(), {key: value})
    raw = small_case()
    *parents, last = key.split(".")
    node = raw
    for parent in parents:
        node = node[parent]
    del node[last]
    return raw


@pytest.mark.parametrize(
    ("key", "value", "pointer"), REFUSED, ids=[f"{k}={str(v)[:20]}" for k, v, _ in REFUSED]
)
def test_a_malformed_case_is_refused_with_the_field_and_the_rule(key: str, value: Any, pointer: str):
    with pytest.raises(CaseError) as refused:
        parse_case(changed(key, value))
    assert pointer in [error.pointer for error in refused.value.errors]
    assert all(error.rule and "<" not in error.pointer for error in refused.value.errors)
    assert pointer in str(refused.value)


def test_every_fault_is_told_at_once_with_its_value():
    raw = apply_settings(small_case(), {"rod.length": -1.0, "t_end": 0.0})
    with pytest.raises(CaseError) as refused:
        parse_case(raw)
    assert str(refused.value) == "/rod/length must be > 0, got -1.0\n/t_end must be > 0, got 0.0"


@pytest.mark.parametrize(("key", "value", "rule"), [
    ("name", "My cable", "must be small letters, digits and hyphens, and not begin with a hyphen"),
    ("title", "two\nlines", "must be one line, without control characters"),
])  # fmt: skip
def test_what_a_text_must_be_is_told_in_words(key: str, value: str, rule: str):
    with pytest.raises(CaseError) as refused:
        parse_case(small_case() | {key: value})
    assert [(one.pointer, one.rule) for one in refused.value.errors] == [(f"/{key}", rule)]


def test_a_case_is_the_same_after_a_round_through_its_document():
    spec = parse_case(small_case())
    assert parse_case(json.loads(json.dumps(spec.document()))) == spec


def test_a_rod_along_e1_needs_no_first_axis():
    case = apply_settings(load_case("elastica"), {"initial": {"shape": "straight", "direction": [2.0, 0.0, 0.0]}})
    assert parse_case(case).initial.a1 is None


def test_settings_change_a_copy_only():
    raw = small_case()
    changed = apply_settings(raw, {"numerics.dt_max": 0.01, "loads.point.0.s": 0.25, "fluid.added_mass": 1})
    assert changed["numerics"] == {"intervals": 20, "dt_max": 0.01}
    assert changed["loads"]["point"][0]["s"] == 0.25
    assert raw == small_case()


@pytest.mark.parametrize("key", ["loads.point.7.s", "loads.point.first.s", "t_end.value"])
def test_a_setting_that_leads_nowhere_is_refused(key: str):
    with pytest.raises(CaseError, match="has no"):
        apply_settings(small_case(), {key: 1.0})


def test_data_that_json_cannot_hold_is_refused():
    with pytest.raises(CaseError, match="plain JSON"):
        parse_case(small_case() | {"t_end": {1.0}})


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (b'{"t_end": 1,', "line 1, column 13"),
        (b"[1, 2]", "must be a JSON object"),
        (b'{"t_end": 1, "t_end": 2}', "name twice"),
        ('{"t_end": 1}'.encode("utf-16"), "must be UTF-8 text in .*case.json, which byte 0 is not"),
        (b"[" * 100_000, "must not be nested so deeply"),
        (b'{"t_end": ' + b"1" * 5000 + b"}", "is not JSON in .*5000 digits"),
    ],
)
def test_a_file_that_is_no_case_is_refused(tmp_path: Path, text: bytes, told: str):
    path = tmp_path / "case.json"
    path.write_bytes(text)
    with pytest.raises(CaseError, match=told):
        load_case(path)


def test_an_unknown_name_tells_the_known_ones():
    with pytest.raises(CaseError, match="goyal-2003"):
        load_case("goyal-2030")


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig"])
def test_a_case_file_is_read_by_its_path(tmp_path: Path, encoding: str):
    path = tmp_path / "mine.json"
    path.write_text(json.dumps(small_case()), encoding=encoding)
    assert parse_case(load_case(path)).name == "small"


@pytest.mark.parametrize("name", shipped_cases())
def test_a_shipped_case_is_valid_and_named_as_its_file(name: str):
    spec = parse_case(load_case(name))
    assert spec.name == name
    assert spec.title
    assert spec.description


def test_the_schema_tells_every_field_of_a_case():
    schema = case_schema()
    assert set(small_case()) <= set(schema["properties"])
    assert schema["additionalProperties"] is False


@pytest.mark.parametrize(
    ("settings", "pointer", "rule"),
    [
        ({"ends.end": {"preset": "clamp", "switches": [{"at": 1.0, "f3": 0.0}]}}, "/ends/end", "switches"),
        ({"initial.velocity": [1.0, 0.0, 0.0]}, "/initial/velocity", "in which nothing moves"),
        ({"numerics.intervals": 1001, "contact": {}}, "", "intervals must be <= 1000 in a static analysis"),
        ({"ends.start": "slider"}, "/ends", "neither holds it along .0, 0, 1."),
    ],
)
def test_what_a_static_analysis_cannot_do_is_refused(settings: dict[str, Any], pointer: str, rule: str):
    with pytest.raises(CaseError, match=rule) as refused:
        parse_case(apply_settings(load_case("static-elastica"), settings))
    assert [fault.pointer for fault in refused.value.errors] == [pointer]


def test_a_static_analysis_that_says_nothing_of_its_resolution_has_a_tolerance_too():
    for given in ({}, {"verify": True}, {"tolerance": 1e-3}):
        told = parse_case({**load_case("static-elastica"), "numerics": given}).numerics
        assert (told.intervals, told.tolerance) == (None, 1e-3)


@pytest.mark.parametrize(("places", "intervals"), [((), 200), ((0.5,), 200), ((1 / 3,), 201), ((1 / 3, 0.25), 204),
                                                   ((0.1234,), 200)])  # fmt: skip
def test_the_usual_intervals_at_rest_have_a_node_at_each_point_load(places: tuple[float, ...], intervals: int):
    raw = load_case("static-elastica")
    point = [{"s": part * raw["rod"]["length"], "force": [1.0, 0.0, 0.0]} for part in places]
    case = {**raw, "loads": {"point": point}, "numerics": {"dt_max": 0.1}}
    assert parse_case(case).numerics.intervals == intervals
    assert parse_case({**case, "numerics": {"intervals": 50}}).numerics.intervals == 50


def numerics(**given):
    return parse_case({**load_case("elastica"), "numerics": given}).numerics


@pytest.mark.parametrize("given", [{}, {"verify": True}, {"method": "staggered"}, {"tolerance": 1e-3}])
def test_where_nothing_is_said_about_the_resolution_there_is_a_tolerance(given):
    told = numerics(**given)
    assert (told.method, told.tolerance, told.intervals, told.dt_max) == ("staggered", 1e-3, None, None)


@pytest.mark.parametrize(
    "given",
    [{"intervals": 50}, {"dt_max": 0.01}, {"method": "box"}, {"increment_tolerance": 0.2}, {"rho_inf": 0.9},
     {"linear_solver": "shooting"}],
)  # fmt: skip
def test_where_something_is_said_about_the_resolution_or_the_box_method_there_is_none(given):
    told = numerics(**given)
    filled_in = {"intervals": 200, "dt_max": 0.05, "method": "box", "tolerance": None, **given}
    assert {name: getattr(told, name) for name in filled_in} == filled_in


@pytest.mark.parametrize("name", ["intervals", "dt_max", "increment_tolerance"])
def test_a_tolerance_beside_what_it_chooses_is_refused(name):
    with pytest.raises(CaseError, match=f"/numerics/{name} must not be given beside a tolerance"):
        numerics(tolerance=1e-3, **{name: 10})


def test_a_tolerance_needs_the_staggered_method():
    with pytest.raises(CaseError, match="/numerics/method must be staggered with a tolerance, got 'box'"):
        numerics(tolerance=1e-3, method="box")


def test_a_tolerance_that_is_set_displaces_the_cases_own_resolution_and_back():
    changed = apply_settings(load_case("elastica"), {"numerics.tolerance": 1e-4})
    assert changed["numerics"] == {"tolerance": 1e-4}
    assert apply_settings(changed, {"numerics.intervals": 30})["numerics"] == {"intervals": 30}


def test_a_case_with_a_tolerance_reads_its_own_document_again():
    spec = parse_case({**load_case("elastica"), "numerics": {"tolerance": 1e-4, "verify": True}})
    assert parse_case(spec.document()) == spec


@pytest.mark.parametrize(
    ("contact", "pointer", "rule"),
    [
        ({"k1": 1e-7}, "/contact/k2", r"required beside k1: all constants of eq. \(6\), or none"),
        ({"cutoff": 0.1, "spacing": 0.01}, "/contact/k1", "required beside cutoff"),
        ({"k3": 1.0}, "/contact/k1", "required beside k3"),
        ({"sum": "grid_points"}, "/contact/sum", "must be density where no constants"),
    ],
)
def test_some_constants_of_contact_are_refused(contact: dict[str, Any], pointer: str, rule: str):
    with pytest.raises(CaseError, match=rule) as refused:
        parse_case({**load_case("short-loop"), "contact": contact})
    assert [fault.pointer for fault in refused.value.errors] == [pointer]


@pytest.mark.parametrize(
    ("name", "key", "value", "pointer"),
    [
        ("elastica", "t_end", 1e308, "/output/interval"),
        ("elastica", "t_end", 1e300, "/output/interval"),
        ("cantilever-vibration", "output.interval", 5e-324, "/output/interval"),
        ("hanging-cable", "initial.a1", [1.0, 1e308, 0.0], "/initial/a1"),
    ],
)
def test_a_number_whose_products_overflow_is_refused_in_a_line(name: str, key: str, value: object, pointer: str):
    with pytest.raises(CaseError) as refused:
        parse_case(apply_settings(load_case(name), {key: value}))
    assert [fault.pointer for fault in refused.value.errors] == [pointer]
    assert len(str(refused.value)) < 200


BODY = {"preset": "free", "mass": 2.0}


@pytest.mark.parametrize("part", [{"rod.axial_stiffness": 30.0}, {"rod.retardation_time": 0.1}, {"ends.end": BODY}])
def test_what_one_method_knows_alone_is_solved_by_it_where_none_is_named(part):
    raw = apply_settings(load_case("elastica"), {"numerics": {"intervals": 50}})
    assert parse_case(raw).numerics.method == "box"
    assert parse_case(apply_settings(raw, part)).numerics.method == "staggered"
