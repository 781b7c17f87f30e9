"""Refusals that help: the field that was meant, and large numbers told by their size."""

from __future__ import annotations

from typing import Any

import pytest

from service.cases import CaseError, apply_settings, load_case, parse_case


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
    assert f"is not a known field: did you mean {meant}?" in str(refusal(setting, value))


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


@pytest.mark.parametrize(("name", "pointer"), [("<table>", ""), ("<b", "/<b")])
def test_an_unknown_field_in_angle_brackets_is_told_too(name: str, pointer: str):
    with pytest.raises(CaseError) as refused:
        parse_case({**load_case("elastica"), name: 1})
    assert [fault.pointer for fault in refused.value.errors] == [pointer]
