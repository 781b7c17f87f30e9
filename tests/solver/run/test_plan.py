"""What a run to a tolerance tries next."""

from __future__ import annotations

from math import inf

import numpy as np
import pytest

from solver.run.plan import MOST_WORK, Attempt, Excess, Trial, chosen, following, step_tolerance

SMALL = 0.01 * MOST_WORK


def ran(mesh: int, steps: int, work: float = SMALL) -> Attempt:
    return Attempt(mesh, steps, work, 1.0, complete=True, slow=False)


def failed(mesh: int, t: float) -> Attempt:
    return Attempt(mesh, 0, SMALL, t, complete=False, slow=False, outcome=3)


def slow(mesh: int, steps: int) -> Attempt:
    return Attempt(mesh, steps, SMALL, 0.1, complete=False, slow=True)


@pytest.mark.parametrize(
    ("history", "excess", "then"),
    [
        ([], Excess(), Trial(1, 0)),
        ([ran(0, 0)], Excess(), Trial(0, 1)),
        ([ran(0, 0, 0.9 * MOST_WORK)], Excess(), Trial(0, -1)),  # shorter steps are not to be had
        ([ran(0, 0), ran(0, 1)], Excess(inf, 5.0), Trial(1, 0)),
        ([ran(0, 0), ran(0, 1), ran(1, 0)], Excess(0.5, 0.1, 1), None),
        ([ran(0, 0), ran(0, 1), ran(1, 0)], Excess(2.0, 0.1, 1), Trial(2, 0)),
        ([ran(0, 0), ran(0, 1), ran(1, 0)], Excess(0.5, 0.9, 1), Trial(0, 2)),
        ([ran(0, 0), ran(0, 1), ran(1, 0)], Excess(9.0, 0.9, 1), Trial(2, 0)),  # the larger error first
        ([ran(0, 0), ran(0, 1), ran(1, 0), ran(2, 0), ran(0, 2)], Excess(0.5, 0.1, 2), Trial(1, 1)),
        ([ran(0, 0), ran(0, 1), ran(1, 0, 0.9 * MOST_WORK)], Excess(9.0, 0.1, 1), None),
        ([failed(0, 0.5)], Excess(), Trial(1, 0)),
        ([failed(0, 0.5), failed(1, 0.2), failed(2, 0.2)], Excess(), None),
        ([slow(0, 0)], Excess(), Trial(0, -2)),
        ([slow(2, 0), slow(2, -2), ran(2, -4, 3 * MOST_WORK)], Excess(), Trial(2, -5)),
        ([slow(2, 0), slow(2, -2), ran(2, -4, 3 * MOST_WORK), ran(2, -5)], Excess(inf, 9.0), Trial(1, -4)),
        ([ran(2, -4, 3 * MOST_WORK), ran(2, -5), ran(1, -4)], Excess(9.0, 9.0, 2), None),
        ([ran(0, 0), ran(0, 1), failed(1, 0.2)], Excess(), Trial(2, 0)),
    ],
)
def test_what_follows(history: list[Attempt], excess: Excess, then: Trial | None) -> None:
    assert following(history, excess, 1 if not history else history[0].mesh, 2000) == then


def test_no_mesh_is_finer_than_may_be() -> None:
    assert following([ran(0, 0), ran(0, 1), ran(1, 0)], Excess(9.0, 0.1, 1), 0, 63) is None


def test_the_frames_are_those_of_the_finest_mesh_and_its_steps_error_that_of_its_steps() -> None:
    attempts = [ran(0, 0), ran(0, 1), ran(1, 1), ran(2, 1), ran(0, 2), ran(0, 3), ran(1, 3)]
    assert chosen(attempts) == ([1, 2, 3], [0, 1, 4])


def test_where_nothing_is_complete_the_last_two_that_went_on_count() -> None:
    assert chosen([slow(0, 0), failed(0, 0.2), failed(1, 0.3), failed(2, 0.3)]) == ([2, 3], [])


def test_a_step_shorter_has_a_quarter_of_the_error() -> None:
    assert step_tolerance(2, 1e-3) == 1e-3
    assert step_tolerance(3, 1e-3) == 0.25e-3


@pytest.mark.parametrize("seed", range(300))
def test_it_comes_to_an_end_and_tries_nothing_twice(seed: int) -> None:
    rng = np.random.default_rng(seed)
    first, history, excess = int(rng.integers(0, 5)), [], Excess()
    chances = rng.dirichlet([3, 1, 1])
    while (trial := following(history, excess, first, 1024)) is not None:
        kind, work = rng.choice(3, p=chances), float(10 ** rng.uniform(-3, 0.5)) * MOST_WORK
        history.append(Attempt(*trial, work, float(rng.uniform()), complete=kind == 0, slow=kind == 1))
        known = max((attempt.mesh for attempt in history if attempt.complete), default=-1)
        at = known if rng.uniform() < 0.8 and len({a.mesh for a in history if a.complete}) > 1 else -1
        excess = Excess(*(10 ** rng.uniform(-2, 2, 2)), at)
        assert len(history) < 60
    assert len({attempt[:2] for attempt in history}) == len(history)
