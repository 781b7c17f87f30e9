"""Warnings of bends that no rod has."""

from __future__ import annotations

from typing import Any

import pytest

from service.cases import apply_settings, build_scene, load_case, parse_case, warnings_of

STEP = {"s": [0.0, 0.5, 1.0], "value": [0.0, 0.0, 300.0], "interpolation": "linear"}
LINE = [[0.0, 0.0, z] for z in (0.0, 0.3, 0.6, 1.0)]


def told(settings: dict[str, Any]) -> list[tuple[str, str]]:
    """Pointers and texts of the warnings of elastica, a rod of 1 m and D = 0.01 m, with some settings."""
    spec = parse_case(apply_settings(load_case("elastica"), settings))
    return [(warning.pointer, str(warning)) for warning in warnings_of(spec, build_scene(spec))]


@pytest.mark.parametrize(("kappa0", "value", "rule"), [
    ([0.0, 200.0, 0.0], 200.0, "to a radius of 0.005 m at s = 0 m, which is less than its diameter, 0.01 m"),
    ([-120.0, 160.0, 0.0], 200.0, "to a radius of 0.005 m"),
    ([STEP, 0.0, 0.0], 300.0, "to a radius of 0.00333 m at s = 1 m"),
    ([0.0, 0.0, 400.0], 400.0, "winds the rod by 0.637 turns from one node to the next, of 100 intervals"),
])  # fmt: skip
def test_a_natural_shape_that_no_rod_has_is_pointed_out_with_its_value(kappa0: Any, value: float, rule: str):
    [(pointer, text)] = told({"rod.kappa0": kappa0})
    assert (pointer, rule in text, f", got {value}" in text) == ("/rod/kappa0", True, True)


@pytest.mark.parametrize("numerics", [{"tolerance": 1e-3}, {}])
def test_with_a_tolerance_it_is_the_finest_mesh_that_counts(numerics: dict[str, float]):
    natural = {"numerics": numerics, "rod.kappa0": [0.0, 0.0, 400.0]}
    assert told(natural) == []
    [(_, text)] = told(natural | {"rod.kappa0": [0.0, 0.0, 7000.0]})
    assert "0.557 turns from one node to the next, of 2000 intervals" in text


@pytest.mark.parametrize("settings", [
    {"rod.kappa0": [0.0, 90.0, 0.0]}, {"rod.kappa0": [0.0, 0.0, 300.0]},
    {"rod.kappa0": "initial", "initial": {"shape": "centreline", "points": LINE, "a1": [1.0, 0.0, 0.0]}},
    {"rod.diameter": 0.001, "rod.kappa0": [300.0, 0.0, 0.0]},
])  # fmt: skip
def test_a_coil_or_a_twisted_rod_is_left_alone(settings: dict[str, Any]):
    assert told(settings) == []


@pytest.mark.parametrize(("settings", "pointer"), [
    ({"ends.end": {"preset": "free", "q2": 1.0}}, "/ends/end"),
    ({"loads.point": [{"s": 0.5, "moment": [0.0, -1.0, 0.0]}]}, "/loads/point/0/moment"),
    ({"ends.end": {"preset": "free", "q2": 0.3}}, None),
])  # fmt: skip
def test_a_moment_that_would_fold_the_rod_is_pointed_out(settings: dict[str, Any], pointer: str | None):
    """EJ = 0.00614 N m^2 = 0.614 N m times D."""
    found = told(settings)
    assert [at for at, _ in found] == ([pointer] if pointer else [])
    assert all("163 rad/m" in text and ", got 1.0" in text for _, text in found)
