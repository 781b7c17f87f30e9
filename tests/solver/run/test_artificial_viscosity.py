"""A limp rope that whips more sharply than any mesh shows has an answer: its shortest waves are damped."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from solver import Curve, VerifiedFrame, simulate
from solver.physics.elasticity import Viscosity, elasticity_of
from solver.run.artificial_viscosity import has_waves, highest_grade, retardation_time, with_viscosity
from solver.run.refined import Refined
from solver.run.trial import AT_REST, DAMPED, LOOSEST, grade_of
from tests.solver.scenes import ROPE, rope_let_go
from validation.error_bars import verified

MASS, EJ = (float(profile(np.zeros(1))[0]) for profile in (ROPE.mass, ROPE.stiffness[0]))


def test_the_retardation_time_falls_with_the_square_of_an_interval_and_grows_by_grades() -> None:
    for intervals, grade in ((16, 0), (64, 0), (64, 2)):
        time = retardation_time(with_viscosity(ROPE, intervals, grade))
        assert time == pytest.approx(8.0**grade / intervals**2 * np.sqrt(MASS / EJ))


def test_it_comes_on_top_of_the_rods_own() -> None:
    own = replace(ROPE, laws=(Viscosity(Curve.constant(0.1)),))
    both = with_viscosity(own, 64, 0)
    added = retardation_time(with_viscosity(ROPE, 64, 0))
    assert retardation_time(both) == pytest.approx(0.1 + added)
    s = np.linspace(0.0, 1.0, 5)
    elastic = elasticity_of(both, s)
    np.testing.assert_allclose(elastic.viscosity, (0.1 + added) * elastic.K, rtol=1e-12)


@pytest.mark.parametrize("intervals", [16, 64])
def test_what_a_scene_damps_itself_is_no_wave(intervals: int) -> None:
    """omega = k^2 sqrt(EJ / m) of waves that are two intervals long."""
    critical = 2.0 * (np.pi * intervals) ** 2 * float(np.sqrt(EJ / MASS))
    for part, waves in ((0.0, True), (0.9, True), (1.1, False)):
        assert has_waves(replace(rope_let_go(), damping=part * critical), intervals) == waves


@pytest.mark.parametrize("intervals", [16, 20, 64, 128, 512, 1024])
def test_waves_as_long_as_the_rod_are_hardly_damped(intervals: int) -> None:
    def longest(grade: int) -> float:
        return retardation_time(with_viscosity(ROPE, intervals, grade)) / float(np.sqrt(MASS / EJ))

    assert longest(highest_grade(intervals)) <= 0.25 < longest(highest_grade(intervals) + 1)


def test_a_limp_rope_that_is_let_go_has_an_answer_with_its_errors_and_says_what_was_done_to_it() -> None:
    scene = rope_let_go()
    run = simulate(scene)
    assert isinstance(run, Refined)
    frames, phases = [], set()
    while not run.finished:
        phases.add(run.phase)
        frames.append(run.advance())
    frames = [frame for frame in frames if isinstance(frame, VerifiedFrame)]
    assert frames[-1].t == 4.0
    assert {"run 1: 16 intervals", "run 2: 32 intervals"} <= phases
    assert any(phase.endswith(" intervals, with viscosity") for phase in phases)
    assert run.accuracy is not None and np.isfinite(list(run.accuracy.errors.values())).all()
    assert 1e-3 < run.accuracy.errors["r"] < 1.0
    attributes = run.attributes()
    assert any(f"retardation time of {attributes['retardation_time']:.3g} s" in note for note in run.notes())
    # it swings, and what the viscosity takes is told as dissipated
    assert min(frame.r[-1, 2] for frame in frames) < -0.5
    assert abs(frames[-1].energy_balance) < 0.05 * frames[-1].dissipation
    assert verified(run, scene).rod.laws


def test_a_rope_that_meshes_can_show_is_left_as_it_is() -> None:
    scene = replace(rope_let_go(), rod=replace(ROPE, stiffness=(Curve.constant(100.0 * EJ),) * 3), damping=3.0)
    run = simulate(scene)
    assert isinstance(run, Refined)
    list(run)
    assert "retardation_time" not in run.attributes()
    assert not verified(run, scene).rod.laws


def test_numbers_of_steps_that_stand_for_viscosity_stand_for_nothing_else() -> None:
    assert [grade_of(DAMPED - more) for more in range(3)] == [0, 1, 2]
    assert all(grade_of(steps) is None for steps in (*range(LOOSEST, 10), AT_REST))
