"""What a run to a tolerance tries next."""

from __future__ import annotations

from math import inf

import numpy as np
import pytest

from solver.run.budget import (
    FIRST_PART,
    MOST_PATIENCE,
    MOST_WORK,
    SETTLING,
    SETTLING_LATE,
    TO_THE_END,
    Patience,
    allowance,
    expected,
)
from solver.run.plan import CROSSED, FAR_FROM_IT, MADE, WAVES, Excess, next_trial, to_come
from solver.run.series import Attempt, Chosen, chosen
from solver.run.trial import AT_REST, DAMPED, LOOSEST, Trial, step_tolerance

SMALL = 0.01 * MOST_WORK


def ran(mesh: int, steps: int, work: float = SMALL) -> Attempt:
    return Attempt(mesh, steps, work, 1.0, complete=True, slow=False)


def failed(mesh: int, t: float, work: float = SMALL, steps: int = 0) -> Attempt:
    return Attempt(mesh, steps, work, t, complete=False, slow=False, outcome=WAVES[0])


def made(mesh: int, steps: int, work: float = SMALL) -> Attempt:
    return Attempt(mesh, steps, work, 0.8, complete=False, slow=False, outcome=MADE)


def slow(mesh: int, steps: int, work: float = SMALL) -> Attempt:
    return Attempt(mesh, steps, work, 0.1, complete=False, slow=True)


@pytest.mark.parametrize(
    ("history", "excess", "then"),
    [
        ([ran(0, 0)], Excess(), Trial(0, 1)),
        ([ran(0, 0, 0.9 * MOST_WORK)], Excess(), Trial(0, -1)),  # shorter steps are not to be had
        ([ran(0, 0), ran(0, 1)], Excess(inf, 5.0), Trial(1, 1)),
        ([ran(0, 0), ran(0, 1)], Excess(inf, 0.2), Trial(1, 0)),
        ([ran(0, 0), ran(0, 1, 4.0 * SMALL)], Excess(inf, 12.0), Trial(1, 0)),  # shorter steps are dear
        ([ran(0, 0), ran(0, 1, 4.0 * SMALL)], Excess(inf, 2.0), Trial(1, 1)),  # and nearly enough
        ([ran(0, 0), ran(0, 1, 4.0 * SMALL)], Excess(inf, 12.0, worth=4.0), Trial(1, 1)),  # of what is given up soon
        ([ran(0, 0, 0.1 * MOST_WORK), ran(0, 1, 0.2 * MOST_WORK)], Excess(inf, 2.0), Trial(1, 1)),
        ([ran(0, 0, 0.2 * MOST_WORK), ran(0, 1, 0.3 * MOST_WORK)], Excess(inf, 2.0), Trial(1, 0)),  # none for a third
        ([ran(0, 0, 0.2 * MOST_WORK), ran(0, 1, 0.3 * MOST_WORK)], Excess(inf, 20.0), Trial(1, 1)),  # and far off
        ([ran(0, 0), ran(0, 1), ran(1, 0)], Excess(0.5, 0.1, 9.0), None),
        ([ran(0, 0), ran(0, 1), ran(1, 0)], Excess(2.0, 0.1, 9.0), Trial(2, 0)),
        ([ran(0, 0), ran(0, 1), ran(1, 0)], Excess(0.5, 0.9, 9.0), Trial(1, 1)),
        ([ran(0, 0), ran(0, 1), ran(1, 0)], Excess(9.0, 0.9, 50.0), Trial(2, 1)),  # both at once
        ([ran(0, 0), ran(0, 1), ran(1, 1), ran(2, 2)], Excess(0.6, 0.6, 9.0), Trial(3, 3)),  # a diagonal
        ([ran(0, 0), ran(0, 1), ran(1, 1), ran(2, 2)], Excess(5.0, 0.3, 9.0), Trial(3, 2)),  # whose steps are enough
        ([ran(0, 0), ran(0, 1), ran(1, 0, 0.9 * MOST_WORK)], Excess(9.0, 0.1), None),
        ([ran(0, 0), ran(0, 1), ran(1, 0), slow(2, 0)], Excess(9.0, 0.1, 9.0), None),
        ([failed(0, 0.5)], Excess(), Trial(1, 0)),
        ([made(0, 0)], Excess(), Trial(0, 1)),  # shorter steps first
        ([made(0, 0), made(0, 1)], Excess(), Trial(1, 1)),
        ([failed(0, 0.5), failed(1, 0.2), failed(2, 0.2)], Excess(), Trial(3, 0)),
        ([failed(0, 0.5), failed(1, 0.2), failed(2, 0.2, 0.6 * MOST_WORK)], Excess(), Trial(2, -11)),  # with viscosity
        ([failed(0, 0.5), failed(1, 0.2), made(2, 0), made(2, 1, 2 * MOST_WORK)], Excess(), None),
        ([failed(0, 0.5, steps=AT_REST), failed(1, 0.5, 2 * MOST_WORK, AT_REST)], Excess(), None),  # what rests, rests
        ([slow(0, 0)], Excess(), Trial(0, -2)),
        ([made(0, 0), slow(0, 1), slow(0, -1)], Excess(), Trial(0, -2)),
        ([slow(0, 0), slow(0, -2)], Excess(), Trial(0, -11)),
        ([slow(0, 0), slow(0, -2), failed(0, 0.5, steps=-11)], Excess(), Trial(0, -12)),
        ([slow(2, 0), slow(2, -2), slow(2, -11)], Excess(), Trial(2, -14)),
        ([slow(0, -12)], Excess(), Trial(0, -13)),  # the highest grade that a mesh may have
        ([failed(0, 0.5, steps=-13)], Excess(), Trial(1, DAMPED)),  # too limp for the mesh
        ([failed(0, 0.5, MOST_WORK, steps=-13)], Excess(), Trial(1, DAMPED)),
        ([failed(0, 0.5, 1.1 * MOST_WORK, steps=-13)], Excess(), None),
        ([slow(0, -13)], Excess(), None),
        ([failed(6, 0.5, steps=-17)], Excess(), None),  # of most_intervals
        ([slow(2, -2), ran(2, -11)], Excess(), Trial(3, -11)),
        ([slow(2, -2), ran(2, -11), failed(3, 0.2, steps=-11)], Excess(), Trial(1, -11)),
        ([slow(2, -2), ran(2, -11, MOST_WORK)], Excess(), Trial(1, -11)),
        ([ran(2, -11, MOST_WORK), failed(1, 0.2, steps=-11)], Excess(), Trial(1, -12)),
        ([ran(2, -11, MOST_WORK), failed(1, 0.2, steps=-11), ran(1, -12)], Excess(), Trial(2, -12)),
        ([ran(2, -11), ran(3, -11)], Excess(9.0), Trial(4, -11)),  # and never without again
        ([ran(2, -11), ran(3, -11, MOST_WORK)], Excess(9.0), None),
        ([ran(0, 0), ran(0, 1), failed(1, 0.2)], Excess(inf, 0.1), Trial(2, 0)),
        ([ran(0, 0), ran(0, 1), failed(1, 0.2), failed(2, 0.2), failed(3, 0.2)], Excess(inf, 0.1), Trial(4, 0)),
        ([ran(0, 0), ran(0, 1), failed(1, 0.2), failed(2, 0.2, MOST_WORK)], Excess(inf, 0.1), Trial(2, -11)),
        ([ran(0, 0), ran(0, 1), failed(1, 0.2), slow(2, 0, MOST_WORK)], Excess(inf, 0.1), Trial(2, -11)),
        ([ran(0, 0), ran(0, 1), ran(1, 0), failed(2, 0.2)], Excess(9.0, 0.1), Trial(3, 0)),
    ],
)
def test_what_follows(history: list[Attempt], excess: Excess, then: Trial | None) -> None:
    assert next_trial(history, [excess], 2000) == then


def test_no_mesh_is_finer_than_may_be() -> None:
    assert next_trial([ran(0, 0), ran(0, 1), ran(1, 0)], [Excess(9.0, 0.1, 90.0)], 63) is None


@pytest.mark.parametrize(
    ("work", "excess", "then"),
    [
        (0.25, Excess(9.0, 0.1, 36.0, 4.0), Trial(2, 0)),
        (0.25, Excess(90.0, 0.1, 95.0), None),  # it hardly falls
        (0.25, Excess(9000.0, 0.1, 36000.0, 4.0), None),  # it falls, but there is a long way to go
        (0.25, Excess(9000.0, 0.1, 36000.0), Trial(2, 0)),  # which may be gone for this quantity
        (0.01, Excess(90.0, 0.1, 95.0), Trial(2, 0)),  # but it costs nearly nothing
    ],
)
def test_what_cannot_bring_the_tolerance_is_not_tried_unless_it_is_cheap(
    work: float, excess: Excess, then: Trial | None
) -> None:
    history = [ran(0, 0, 0.5 * work * MOST_WORK), ran(0, 1), ran(1, 0, work * MOST_WORK)]
    assert next_trial(history, [excess], 2000) == then


def test_shorter_steps_that_changed_nothing_are_not_made_shorter_again() -> None:
    history = [ran(0, 0), ran(0, 1), ran(1, 1), ran(1, 2)]
    assert next_trial(history, [Excess(0.2, 16.0, 16.5)], 2000) is None
    assert next_trial(history, [Excess(0.2, 16.0, 60.0)], 2000) == Trial(1, 3)
    assert next_trial([*history[:3], ran(2, 1)], [Excess(0.2, 16.0, 16.5)], 2000) == Trial(2, 2)


def test_where_two_meshes_agreed_by_chance_another_is_tried_unless_it_takes_long() -> None:
    history = [ran(0, 0), ran(0, 1), ran(1, 0, 0.1 * MOST_WORK), ran(2, 0, 0.14 * MOST_WORK)]
    risen = Excess(9.7, 0.1, 0.9)
    assert next_trial(history, [risen], 2000) == Trial(3, 0)
    assert next_trial(history, [risen._replace(worth=4.0)], 2000) is None
    assert next_trial([*history[:3], ran(2, 0, 0.18 * MOST_WORK)], [risen], 2000) is None


def test_where_meshes_do_not_make_the_error_fall_shorter_steps_are_tried() -> None:
    history = [ran(0, 0), ran(0, 1), ran(1, 1), ran(2, 1)]
    assert next_trial(history, [Excess(9.6, 8.9, 14.0)], 2000) == Trial(3, 2)
    assert next_trial(history, [Excess(9.6, 8.9, 40.0)], 2000) == Trial(3, 1)
    dear = [ran(0, 0), ran(0, 1), ran(1, 1, 0.1 * MOST_WORK), ran(2, 1, 0.16 * MOST_WORK)]  # both at once are
    assert next_trial(dear, [Excess(9.6, 8.9, 14.0)], 2000) == Trial(2, 2)


@pytest.mark.parametrize(("work", "then"), [(SMALL, Trial(2, 0)), (0.2 * MOST_WORK, None)])
def test_few_frames_that_stand_out_are_resolved_where_it_is_cheap(work: float, then: Trial | None) -> None:
    history = [ran(0, 0), ran(0, 1), ran(1, 0, work)]
    assert next_trial(history, [Excess(0.5, 0.1, 9.0, 4.0, anywhere=3.0)], 2000) == then


def test_what_shorter_steps_change_is_told_before_a_third_mesh() -> None:
    rattled = [slow(0, 0, 0.1 * MOST_WORK), ran(0, -2, 0.12 * MOST_WORK), ran(1, -2, 0.15 * MOST_WORK)]
    assert next_trial(rattled, [Excess(9.0, inf)], 2000) == Trial(0, -1)
    assert next_trial([*rattled, ran(0, -1, 0.15 * MOST_WORK)], [Excess(90.0, 0.1)], 2000) == Trial(2, -2)
    dear = [*rattled[:2], ran(1, -2, 0.8 * MOST_WORK)]
    assert next_trial(dear, [Excess(9.0, inf)], 2000) is None


def test_a_quantity_beyond_hope_does_not_keep_others_from_being_refined() -> None:
    history = [ran(0, 0, 0.1 * MOST_WORK), ran(0, 1), ran(1, 0, 0.25 * MOST_WORK)]
    curvature, place = Excess(900.0, 0.1, 910.0, 4.0), Excess(5.0, 0.1, 20.0)
    assert next_trial(history, [place, curvature], 2000) == Trial(2, 0)
    assert next_trial(history, [Excess(0.5, 0.1, 20.0), curvature], 2000) is None


def test_the_work_of_an_attempt_is_expected_to_grow_as_it_did() -> None:
    there = [ran(0, 0, 1e5), ran(0, 1, 2e5), ran(1, 1, 6e5)]
    assert expected(there, Trial(2, 1)) == pytest.approx(18e5)
    assert expected(there, Trial(1, 2)) == pytest.approx(12e5)
    assert expected(there, Trial(2, 2)) == pytest.approx(36e5)
    assert expected([*there, ran(2, 2, 30e5)], Trial(3, 3)) == pytest.approx(150e5)
    longer = [ran(0, 0, 1e5), ran(0, 1, 2e5), ran(1, 0, 2e5), ran(2, 0, 4e5)]
    assert expected(longer, Trial(2, 1)) == pytest.approx(1.44 * 8e5)  # on a finer mesh shorter steps are dearer


@pytest.mark.parametrize(
    ("attempts", "then"),
    [
        ([ran(0, 0), ran(0, 1), ran(1, 0)], Chosen(2, [0, 2], [0, 1])),
        ([ran(0, 0), ran(0, 1), ran(1, 1), ran(2, 1)], Chosen(3, [1, 2, 3], [0, 1])),
        ([ran(0, 0), ran(0, 1), ran(1, 1), ran(2, 2)], Chosen(3, [0, 2, 3], [])),  # a diagonal
        ([ran(0, 0), ran(0, 1), ran(1, 1), ran(1, 2), ran(1, 3)], Chosen(4, [1, 2], [2, 3, 4])),
        ([ran(0, 0), ran(0, 1), ran(1, 1), ran(1, 2), ran(2, 2)], Chosen(4, [3, 4], [2, 3], (1, 2))),
        ([ran(0, 0), ran(0, 1), ran(1, 1), ran(1, 2), ran(2, 2), ran(2, 3)], Chosen(5, [3, 4], [4, 5], (1, 2))),
        ([ran(0, 0), ran(0, 1), ran(1, 1), ran(2, 2), ran(3, 2)], Chosen(4, [3, 4], [0, 1], (), (0, 2, 3))),
        ([ran(0, 0), slow(0, 1)], Chosen(0, [0], [])),
        ([slow(0, 0), failed(0, 0.2), failed(1, 0.3), failed(2, 0.3)], Chosen(3, [2, 3], [])),
    ],
)
def test_which_attempts_make_the_frames(attempts: list[Attempt], then: Chosen) -> None:
    assert chosen(attempts) == then


def test_a_step_shorter_has_a_quarter_of_the_error() -> None:
    assert step_tolerance(2, 1e-3) == step_tolerance(1, 1e-3) / 4.0
    assert step_tolerance(3, 1e-3) == step_tolerance(1, 1e-3) / 16.0


@pytest.mark.parametrize("seed", range(300))
def test_it_comes_to_an_end_and_tries_nothing_twice(seed: int) -> None:
    rng = np.random.default_rng(seed)
    trial, history, excess = Trial(int(rng.integers(0, 5)), 0), [], Excess()
    chances = rng.dirichlet([3, 1, 1])
    while trial is not None:
        kind, work = rng.choice(3, p=chances), float(10 ** rng.uniform(-3, 0.5)) * MOST_WORK
        history.append(Attempt(*trial, work, float(rng.uniform()), complete=kind == 0, slow=kind == 1))
        here = chosen(history)
        if any(attempt.complete for attempt in history):
            assert all(history[i].complete for i in (here.finest, *here.meshes, *here.series))
        assert history[here.meshes[-1]].mesh == history[here.finest].mesh
        excess = Excess(*(10 ** rng.uniform(-2, 2, 2)), excess.total)
        trial = next_trial(history, [excess], 1024)
        assert len(history) < 60
    assert len({attempt[:2] for attempt in history}) == len(history)


def test_an_error_of_exactly_nothing_wants_no_more_work() -> None:
    history = [ran(0, 0), ran(0, 1), ran(1, 0)]
    place, topology = Excess(9.0, 0.1, 36.0), Excess(0.0, 0.0, 0.0)
    assert to_come(history, [place, topology], Trial(2, 0)) == to_come(history, [place], Trial(2, 0)) > 0.0
    assert to_come(history, [topology], Trial(2, 0)) == 0.0


def test_where_what_is_to_tell_the_error_takes_far_too_long_nothing_else_is_tried() -> None:
    first, second = ran(2, -2, 1.5 * MOST_WORK), slow(1, -2)._replace(work=MOST_WORK)
    assert next_trial([first], [Excess()], 2000) == Trial(1, -2)
    assert allowance([first], Trial(1, -2)) == MOST_PATIENCE * MOST_WORK
    assert next_trial([first, second], [Excess()], 2000) is None


def test_what_has_no_waves_and_is_slow_may_go_on_to_its_end() -> None:
    first, last = Trial(3, 0), Trial(3, LOOSEST)
    patience = Patience(waves=False).part(inf)
    assert allowance([], first) == allowance([], first, patience) == allowance([], last) == FIRST_PART * MOST_WORK
    assert allowance([slow(3, 0)], last, patience) == TO_THE_END * MOST_WORK
    for work, more in ((0.9, True), (1.1, False)):
        history = [slow(3, 0), ran(3, LOOSEST, work * MOST_PATIENCE * MOST_WORK)]
        assert (next_trial(history, [Excess()], 2000) is not None) == more


def test_strands_that_strike_each_other_and_soon_rest_are_waited_for() -> None:
    """Twice as long where half of the time was behind them when they had taken what is waited for in any case."""
    patience = Patience(waves=True, settles=True, t_end=10.0)
    assert patience.part(inf) == patience.part(5.0) == SETTLING_LATE
    assert patience.part(4.9) == SETTLING
    assert Patience(waves=True).part(inf) == FIRST_PART
    last, once = Trial(3, LOOSEST), slow(2, LOOSEST)._replace(work=MOST_WORK)
    assert allowance([slow(2, 0)], last, SETTLING) == SETTLING * MOST_WORK
    assert allowance([slow(2, 0), once], last, SETTLING) == FIRST_PART * MOST_WORK


def test_the_error_of_strands_that_rattled_is_told_by_another_mesh_rather_than_by_shorter_steps() -> None:
    """A finer one if there is work left for it, else a coarser one."""
    for part, mesh in ((0.4, 3), (0.9, 1)):
        history = [slow(2, 0), ran(2, LOOSEST, part * MOST_WORK)]
        assert next_trial(history, [Excess()], 2000) == Trial(mesh, LOOSEST)
    assert next_trial([ran(2, LOOSEST, 0.05 * MOST_WORK)], [Excess()], 2000) == Trial(2, LOOSEST + 1)


def test_an_attempt_that_is_begun_is_not_given_up_as_soon_as_nothing_is_left() -> None:
    """Near their end several had spent most of what may be spent, for nothing."""
    spent = [ran(0, 0), ran(0, 1), ran(1, 1, 0.1 * MOST_WORK), ran(2, 2, 0.3 * MOST_WORK)]
    left = MOST_WORK - sum(attempt.work for attempt in spent)
    assert left < allowance(spent, Trial(3, 3)) <= 1.5 * left
    overdrawn = [*spent, ran(3, 3, left + 0.1 * MOST_WORK)]
    assert next_trial(overdrawn, [Excess(900.0, 900.0, 3600.0)], 2000) is None


def test_shorter_steps_are_tried_again_on_the_first_mesh_that_shows_the_motion() -> None:
    far, near = 2.0 * FAR_FROM_IT, 0.5 * FAR_FROM_IT
    history = [ran(0, 0), ran(0, 1), ran(1, 0)._replace(apart=far), ran(2, 0)._replace(apart=near)]
    short_of_it = Excess(mesh=3.0, steps=0.1, before=9.0)
    assert next_trial(history, [short_of_it], 2000) == Trial(2, 1)
    shown = [*history[:2], history[2]._replace(apart=near), history[3]]
    assert next_trial(shown, [short_of_it], 2000) == Trial(3, 0)
    on_a_diagonal = [*history[:2], ran(1, 1)._replace(apart=far), ran(2, 2)._replace(apart=near)]
    assert next_trial(on_a_diagonal, [short_of_it], 2000) != Trial(2, 3)


@pytest.mark.parametrize(("t", "grades"), [(0.2, 3), (0.6, 1)])
def test_a_damped_run_that_was_slow_but_nearly_there_gets_a_little_more_viscosity(t: float, grades: int) -> None:
    history = [failed(6, 0.1), slow(6, DAMPED - 1)._replace(t=t)]
    assert next_trial(history, [Excess()], 10_000, t_end=1.0) == Trial(6, DAMPED - 1 - grades)


def test_a_damped_run_that_crossed_itself_is_tried_on_a_finer_mesh_and_not_again() -> None:
    """Two knots (.37 and .11 m) crossed themselves on 32 intervals with any viscosity, and came to their end on 64."""
    crossed = failed(1, 0.7, steps=DAMPED - 2)._replace(outcome=CROSSED)
    history = [slow(1, 0), slow(1, LOOSEST), slow(1, DAMPED), crossed]
    assert next_trial(history, [Excess()], 10_000) == Trial(2, DAMPED)
    assert next_trial(history, [Excess()], 32) is None
    assert next_trial([*history, ran(2, DAMPED)], [Excess()], 10_000) == Trial(3, DAMPED)


def test_a_finer_mesh_on_which_it_crossed_itself_gets_more_viscosity() -> None:
    """As that of a coil of 16 intervals whose run on 32 did."""
    waited_for = failed(1, 0.7, 1.1 * MOST_WORK, LOOSEST)._replace(outcome=CROSSED)
    assert next_trial([slow(1, 0), waited_for], [Excess()], 2000, 1.0) == Trial(2, DAMPED)
    history = [slow(0, 0), slow(0, LOOSEST), ran(0, DAMPED), failed(1, 0.1, steps=DAMPED)._replace(outcome=CROSSED)]
    assert next_trial(history, [Excess()], 10_000) == Trial(1, DAMPED - 1)


def test_where_far_too_much_was_spent_without_an_answer_the_next_run_has_all_the_viscosity_there_may_be() -> None:
    """DNA in tweezers that winds itself up took 115 s, of grade after grade, and had no answer."""
    begun = [slow(4, LOOSEST, 2.2 * MOST_WORK), slow(4, DAMPED, 0.6 * MOST_WORK)._replace(t=0.7)]
    assert next_trial(begun, [Excess()], 2000, 1.0) == Trial(4, DAMPED - 1)
    last = slow(4, DAMPED - 1, 1.5 * MOST_WORK)._replace(t=0.7)
    assert next_trial([*begun, last], [Excess()], 2000, 1.0) == Trial(4, DAMPED - 4)
    assert next_trial([*begun, last, slow(4, DAMPED - 4)], [Excess()], 2000, 1.0) is None
