"""How long steps are: what learns from the last step, and what aligns the next."""

from __future__ import annotations

from math import inf

import pytest

from solver.run.step_control import GROWTH, StepControl

EASY, MODERATE, HARD = 3, 6, 9
"""Newton's iterations."""


def control(dt_max: float, outputs: list[float]) -> StepControl:
    """Steps up to `dt_max` that end on `outputs`; the error tolerated is 0.1 of the motion."""
    return StepControl(dt_max, 0.1, 2.0, 4, 0.0, [], outputs)


def steps(of: StepControl, t_end: float, increment: float = 0.0, iterations: int = EASY) -> list[float]:
    """The steps from 0 to `t_end`, each accepted with the same error and iterations."""
    t, taken = 0.0, []
    while t < t_end:
        dt, t = of.step_from(t, t_end)
        of.accepted(dt, increment, iterations)
        taken.append(dt)
    return taken


@pytest.mark.parametrize("interval", [0.1, 0.2, 1.0])
def test_steps_grow_to_dt_max_where_frames_are_a_multiple_of_it_apart(interval: float) -> None:
    """From one aligned step to the next is a factor 2, which is more than a step may grow at once."""
    dt_max = 0.1
    taken = steps(control(dt_max, [interval * k for k in range(1, round(10 / interval) + 1)]), 10.0)
    assert taken[-1] == pytest.approx(dt_max)
    # it starts at a sixteenth and grows by half at a time
    assert len(taken) < 10.0 / dt_max + 20


def test_a_step_is_as_long_as_its_error_allows() -> None:
    """The error falls with the step squared: at 0.4 of the tolerated 0.1 the next may be 0.9 sqrt(2.5) as long."""
    of = control(1.0, [])
    dt, _ = of.step_from(0.0, 1.0)
    of.accepted(dt, 0.04, EASY)
    assert of.step_from(dt, 1.0)[0] == pytest.approx(0.9 * 2.5**0.5 * dt)


def test_the_error_counts_for_the_step_that_made_it() -> None:
    """A step cut down to end on a frame says nothing of errors at the step that was wanted."""
    of = control(1.0, [0.05])
    dt, t = of.step_from(0.0, 1.0)
    assert dt == pytest.approx(0.05)
    of.accepted(dt, 0.1, EASY)
    assert of.step_from(t, 1.0)[0] == pytest.approx(0.9 * dt)


@pytest.mark.parametrize(("iterations", "factor"), [(EASY, GROWTH), (MODERATE, 1.0), (HARD, 0.7)])
def test_newtons_iterations_lengthen_or_shorten_the_next_step(iterations: int, factor: float) -> None:
    of = control(1.0, [])
    dt, _ = of.step_from(0.0, 1.0)
    of.accepted(dt, 0.0, iterations)
    assert of.step_from(dt, 1.0)[0] == pytest.approx(factor * dt)


def test_a_sliver_between_two_frames_costs_no_more_than_half_the_step_that_was_reached() -> None:
    of = control(1.0, [0.0625, 0.0626, 100.0])
    first, t = of.step_from(0.0, 1.0)
    of.accepted(first, 0.0, EASY)
    sliver, t = of.step_from(t, 1.0)
    of.accepted(sliver, 0.0, EASY)
    assert first == pytest.approx(0.0625)
    assert sliver == pytest.approx(0.0001)
    assert of.step_from(t, 1.0)[0] > 0.5 * first


def test_a_step_that_was_refused_is_halved() -> None:
    of = control(1.0, [])
    dt, _ = of.step_from(0.0, 1.0)
    of.rejected(dt)
    assert of.step_from(0.0, 1.0)[0] == pytest.approx(0.5 * dt)


def test_a_run_whose_steps_only_shrink_is_stuck() -> None:
    steps = control(1.0, [1.0])
    dt, _ = steps.step_from(0.0, inf)
    for _ in range(60):
        assert dt > 0.0
        if steps.stuck:
            break
        steps.accepted(dt, 0.3, 3)
        dt *= 0.6
    assert steps.stuck
    assert dt > 1e-8


@pytest.mark.parametrize(("blow", "end"), [(0.01, 0.01), (0.05, 0.05), (0.7, 0.0625)])
def test_a_step_ends_with_a_blow_that_comes_sooner(blow: float, end: float) -> None:
    assert control(1.0, [0.5]).step_from(0.0, 1.0, blow) == pytest.approx((end, end))
