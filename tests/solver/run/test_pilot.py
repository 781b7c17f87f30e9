"""Accuracy on demand: the tolerance that is asked for is kept, no mesh is finer than it must be, and what cannot be
reached is told."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from math import inf

import numpy as np
import pytest

from solver import Frame, Initial, Numerics, Outcome, RunFailed, Scene, Simulation, simulate
from solver.run.pilot import LEAST_INTERVALS, MOST_HALVINGS, Difference, Errors, Piloted, Resolution, next_resolution
from solver.run.resolution import refine
from tests.solver.bent import bent_cantilever

NUMERICS = Numerics(method="staggered")


def tolerated(tolerance: float) -> Scene:
    return bent_cantilever(replace(NUMERICS, tolerance=tolerance))


@cache
def done(tolerance: float) -> tuple[Scene, list[Frame]]:
    """The scene with the resolution that was chosen for it, and its frames."""
    run = Piloted(tolerated(tolerance), Simulation)
    frames = list(run)
    return run.chosen, frames


def intervals(tolerance: float) -> int:
    return done(tolerance)[0].numerics.intervals


def true_error(tolerance: float) -> float:
    """Against four times the intervals, and steps a quarter as long."""
    scene, frames = done(tolerance)
    error = Difference(scene)
    for fine, coarse in zip(Simulation(refine(refine(scene))), frames, strict=True):
        error.add(fine, coarse)
    return error.largest


@pytest.mark.parametrize("tolerance", [1e-2, 1e-3])
def test_the_true_error_is_below_the_tolerance_but_not_by_far(tolerance: float) -> None:
    error = true_error(tolerance)
    assert error < tolerance
    assert intervals(tolerance) == LEAST_INTERVALS or error > 0.1 * tolerance


def test_a_hundredth_of_the_tolerance_takes_about_ten_times_the_intervals() -> None:
    assert 7 <= intervals(1e-5) / intervals(1e-3) <= 14


def test_the_frames_are_those_of_a_run_with_the_resolution_that_was_chosen() -> None:
    scene, frames = done(1e-2)
    *_, last = simulate(scene)
    assert np.array_equal(last.r, frames[-1].r)


def test_pilots_count_in_what_a_run_costs_and_its_time_begins_after_them() -> None:
    run = simulate(tolerated(1e-2))
    while run.advance() is None:
        assert run.t == 0.0
    steps, cpu_time = run.statistics.steps, run.statistics.cpu_time
    assert steps > 100
    for _ in run:
        pass
    assert run.t == 4.0
    assert run.statistics.steps > steps
    assert run.statistics.cpu_time > cpu_time


def test_what_cannot_be_reached_has_a_name_and_the_figures() -> None:
    run = simulate(bent_cantilever(replace(NUMERICS, tolerance=1e-5, most_intervals=100)))
    with pytest.raises(RunFailed, match="error of the mesh") as failure:
        list(run)
    assert failure.value.outcome is Outcome.TOLERANCE_NOT_REACHED


def test_a_rod_at_rest_needs_no_fine_mesh() -> None:
    scene = replace(tolerated(1e-4), points=(), initial=Initial.straight(direction=(1.0, 1.0, 1.0)))
    assert len(next(iter(simulate(scene))).r) - 1 == LEAST_INTERVALS


@pytest.mark.parametrize(
    ("now", "errors", "then"),
    [
        (Resolution(32, 0, False), Errors(5e-4, 1e-4), Resolution(32, 0, True)),
        (Resolution(32, 0, False), Errors(4e-3, 1e-4), Resolution(92, 0, True)),
        (Resolution(32, 0, False), Errors(4e-2, 1e-4), Resolution(64, 0, False)),
        (Resolution(32, 1, False), Errors(4e-3, 1e-3), Resolution(32, 2, False)),
        (Resolution(32, 1, False), Errors(4e-2, 1e-3), Resolution(64, 2, False)),
        (Resolution(32, 0, False), Errors(inf, 0.0), Resolution(64, 0, False)),
        (Resolution(512, 0, False), Errors(inf, 0.0), None),
        (Resolution(512, 0, False), Errors(1e-2, 0.0), None),
        (Resolution(32, MOST_HALVINGS, False), Errors(5e-4, 1e-3), None),
        (Resolution(32, MOST_HALVINGS, False), Errors(4e-2, 1e-4), Resolution(64, MOST_HALVINGS, False)),
    ],
)
def test_what_follows_a_pilot(now: Resolution, errors: Errors, then: Resolution | None) -> None:
    """To a tolerance of 1e-3 with at most 2000 intervals."""
    assert next_resolution(now, errors, replace(NUMERICS, tolerance=1e-3)) == then
