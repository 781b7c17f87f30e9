"""What a case would cost is told by the documented model, and what is too much is refused."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from service.cases import CaseError, apply_settings, check_cost, estimate, load_case, parse_case
from service.cases.cost import STEP, STEP_NODE, WRITHE

MEASURED = json.loads((Path(__file__).parents[2] / "benchmarks" / "results" / "last.json").read_text())


def cost(**settings):
    told = {key.replace("__", "."): value for key, value in settings.items()}
    return estimate(parse_case(apply_settings(load_case("cantilever-vibration"), told)))


def test_steps_frames_and_bytes_are_those_of_the_case():
    told = cost(t_end=10.0, numerics__dt_max=0.05, numerics__intervals=100, output__interval=0.5)
    assert (told.nodes, told.frames, told.steps) == (101, 21, 200)
    assert told.bytes == 8 * 21 * 101 * 22
    only_r = cost(t_end=10.0, numerics__intervals=100, output__interval=0.5, output__fields=["r"])
    assert only_r.bytes == 8 * 21 * 101 * 3


def test_there_are_no_fewer_steps_than_frames():
    assert cost(t_end=10.0, numerics__dt_max=1.0, output__interval=0.1).steps == 100


def test_twice_the_time_costs_twice():
    assert cost(t_end=20.0).seconds == pytest.approx(2 * cost(t_end=10.0).seconds, rel=0.01)


def test_topology_costs_with_the_square_of_the_nodes():
    with_, without = (cost(numerics__intervals=10_000, output__topology=told) for told in (True, False))
    assert with_.seconds - without.seconds == pytest.approx(with_.frames * WRITHE * 10_001**2)


@pytest.mark.parametrize("row", MEASURED["scene_s"], ids=lambda row: f"{row['intervals']:.0f}")
def test_the_rates_are_those_that_were_measured_within_a_factor_of_four(row):
    a_step = row["CPU stepping"] / row["steps"]
    assert a_step / 4 < STEP + STEP_NODE * (row["intervals"] + 1) < 4 * a_step


def test_a_case_beyond_the_bound_is_refused_with_what_it_asks_for():
    spec = parse_case(apply_settings(load_case("cantilever-vibration"), {"t_end": 1000.0}))
    seconds = estimate(spec).seconds
    assert check_cost(spec, 1.01 * seconds) == estimate(spec)
    with pytest.raises(CaseError) as refused:
        check_cost(spec, 0.99 * seconds)
    [fault] = refused.value.errors
    assert (fault.pointer, fault.value) == ("/t_end", 1000.0)
    assert "steps" in fault.rule


def test_a_static_analysis_costs_by_its_frames():
    told = parse_case(apply_settings(load_case("static-elastica"), {"numerics.dt_max": 1e-3}))
    assert estimate(told).steps == 2 * 11 + 10
    assert estimate(told).seconds < 1.0
