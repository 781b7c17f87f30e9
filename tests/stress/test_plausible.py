"""The bank of plausible scenes: large, the same everywhere, valid, and run."""

from __future__ import annotations

import pytest

from service.cases import build_scene, parse_case
from stress.plausible.__main__ import written
from stress.plausible.bank import EACH, KINDS, scene
from stress.plausible.judge import judge
from stress.plausible.judge import written as judgement
from stress.plausible.run import ANSWERED, LATE, run


def test_it_is_large() -> None:
    assert len(KINDS) >= 14
    assert len(KINDS) * EACH >= 600


@pytest.mark.parametrize("kind", KINDS)
def test_its_scenes_are_valid_and_say_nothing_of_how_they_are_solved(kind: str) -> None:
    for number in range(EACH):
        case = scene(kind, number)
        assert "numerics" not in case
        assert case == scene(kind, number)
        build_scene(parse_case(case))
    assert scene(kind, 0) != scene(kind, 1)


def test_a_scene_is_answered_with_its_errors_and_one_without_time_is_told() -> None:
    answered, late = run("riser", 2, 60.0), run("whirled", 0, 0.01)
    assert (answered.ending, late.ending) == (ANSWERED, LATE)
    assert answered.frames == 61
    assert answered.attributes["tolerance"] == 1e-3
    assert 0.0 < answered.attributes["error_r"] < 1e-2
    table = "\n".join(written([answered, late]))
    assert "Answered: 50.0%" in table


def test_an_answer_is_judged_by_a_finer_run_and_by_fixed_ones() -> None:
    verdict = judge("towed", 1)
    assert not verdict.unjudged
    assert verdict.outside <= 0.05
    assert 0.0 < verdict.error < 3.0 and verdict.error_of_truth < 0.5
    assert 0.0 < verdict.fixed
    assert "of 1 scenes" in "\n".join(judgement([verdict]))
