"""The bank of plausible scenes: large, the same everywhere, valid, and run."""

from __future__ import annotations

from dataclasses import replace

import pytest

from service.cases import build_scene, parse_case
from solver import Numerics, VerifiedFrame, simulate
from stress.plausible.__main__ import written
from stress.plausible.bank import EACH, KINDS, scene
from stress.plausible.judge import judge
from stress.plausible.judge import written as judgement
from stress.plausible.run import ANSWERED, LATE, run
from validation.error_bars import misses


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
    assert 0.0 < verdict.fixed_by_largest <= verdict.fixed
    assert "of 1 scenes" in "\n".join(judgement([verdict]))


def test_waves_of_a_whip_that_no_attempt_follows_are_within_the_bars_of_how_it_turns() -> None:
    whip = build_scene(parse_case(scene("whip", 0)))
    whip = replace(whip, t_end=0.5 * whip.t_end, numerics=replace(whip.numerics, tolerance=1e-2))
    finer = Numerics("staggered", intervals=128, dt_max=0.1 * whip.output_interval, increment_tolerance=1e-5)
    truth = list(simulate(replace(whip, numerics=finer)))
    frames = [frame for frame in simulate(whip) if isinstance(frame, VerifiedFrame)]
    counts = misses(frames, truth, ("omega", "orientation", "kappa", "v"))
    assert max(far / many for far, many in counts.values()) <= 0.05
