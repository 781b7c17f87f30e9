"""A run to a tolerance: its errors are what it says, it is kept where it can be, and there always is an answer."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from solver import (
    Condition,
    Curve,
    End,
    Initial,
    Numerics,
    Outcome,
    PointLoad,
    Rod,
    RunFailed,
    Scene,
    VerifiedFrame,
    simulate,
)
from solver.arrays import Array
from solver.methods.cost import ABOUT_AXIS
from solver.run import budget
from solver.run.accuracy import ENERGIES, QUANTITIES, errors_of, sizes
from solver.run.first_mesh import LARGEST_TURN, first_intervals
from solver.run.plan import Excess
from solver.run.recording import (
    ASTRAY,
    BALANCE,
    BENDING,
    CURVATURE,
    KAPPA,
    NUMBERS,
    TWIST,
    WIDTH,
    Columns,
    R,
    columns_of,
    number_of,
    row_of,
)
from solver.run.refined import Refined
from solver.run.series import Attempt
from solver.run.together import Together, possible
from solver.run.trial import FIRST_INTERVALS, Trial
from solver.run.under_way import FRAME, UnderWay
from solver.scene.ends import FREE
from tests.solver.bent import bent_cantilever
from tests.solver.scenes import EJ, LENGTH, energy
from validation.error_bars import missed, misses

NUMERICS = Numerics(method="staggered")


def tolerated(tolerance: float, **more: float) -> Scene:
    return bent_cantilever(replace(NUMERICS, tolerance=tolerance, **more))


@cache
def done(tolerance: float) -> tuple[Refined, list[VerifiedFrame]]:
    run = Refined(tolerated(tolerance))
    return run, [frame for frame in run if isinstance(frame, VerifiedFrame)]


@cache
def truth() -> list[VerifiedFrame]:
    """By 128 and 256 intervals, and short steps."""
    numerics = replace(NUMERICS, intervals=128, dt_max=0.005, increment_tolerance=1e-5, verify=True)
    return [frame for frame in simulate(bent_cantilever(numerics)) if isinstance(frame, VerifiedFrame)]


def true_errors(tolerance: float) -> np.ndarray:
    """Of `QUANTITIES`, the largest of all frames."""
    rows = (columns_of([row_of(frame) for frame in frames], judged=True) for frames in (done(tolerance)[1], truth()))
    ours, theirs = rows
    step = (theirs.along.shape[1] - 1) // (ours.along.shape[1] - 1)
    apart = Columns(np.abs(ours.along - theirs.along[:, ::step]), np.abs(ours.numbers - theirs.numbers))
    return errors_of(apart, sizes(tolerated(tolerance), [theirs])).max(axis=0)


@pytest.mark.parametrize("tolerance", [1e-2, 1e-3, 1e-4])
def test_the_true_error_is_below_the_tolerance_and_below_what_the_run_says(tolerance: float) -> None:
    accuracy = done(tolerance)[0].accuracy
    assert accuracy is not None
    assert accuracy.met
    for name, error in zip(QUANTITIES, true_errors(tolerance), strict=True):
        assert error <= accuracy.errors[name] + 1e-12 <= tolerance


def test_true_errors_are_within_three_bars() -> None:
    assert missed(misses(done(1e-3)[1], truth())) <= 0.05


def test_a_tighter_tolerance_costs_more_and_brings_more() -> None:
    loose, tight = done(1e-2), done(1e-4)
    assert tight[0].statistics.newton_iterations > loose[0].statistics.newton_iterations
    assert true_errors(1e-4)[0] < true_errors(1e-2)[0]


def test_runs_on_all_meshes_count_in_what_it_costs_and_frames_come_after_them() -> None:
    run = simulate(tolerated(1e-2))
    seen = []
    while run.advance() is None:
        assert run.t == 0.0
        seen.append(run.progress)
    assert seen == sorted(seen)
    assert 0.0 < seen[-1] < 1.0
    assert run.progress == 1.0
    first, steps = UnderWay(tolerated(1e-2), Trial(0, 0)), run.statistics.steps
    while not first.run.finished:
        first.advance()
    assert steps > 3 * first.statistics.steps
    assert [frame.t for frame in run] == pytest.approx(np.arange(0.25, 4.1, 0.25))
    assert run.statistics.steps == steps


def test_what_cannot_be_reached_is_delivered_all_the_same_and_says_so() -> None:
    run = simulate(tolerated(1e-6, most_intervals=32))
    assert len(list(run)) == 17
    assert run.accuracy is not None
    assert not run.accuracy.met
    assert "beyond the tolerance of 1e-06" in run.notes()[0]
    assert run.attributes()["tolerance_met"] == "no"


def test_where_the_work_that_may_be_done_is_little_there_is_an_answer(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(budget, "MOST_WORK", 2e4)
    run = simulate(tolerated(1e-6))
    assert len(list(run)) == 17
    assert run.accuracy is not None
    assert 0.0 < run.accuracy.errors["r"] < 0.1


def test_a_run_with_longer_steps_alone_makes_frames_of_unknown_error() -> None:
    scene = tolerated(1e-3)
    longer = UnderWay(scene, Trial(0, -2))
    rows = []
    while not longer.run.finished:
        frame = longer.advance()
        if frame is not None:
            rows.append(row_of(frame))
    slow = Attempt(0, 0, 1.0, 0.1, complete=False, slow=True)
    together = Together(scene, [slow, slow._replace(steps=-2, t=4.0, complete=True)], [np.array([]), np.array(rows)])
    assert len(together.piece(0).frames) == len(rows) == 17
    assert np.isnan(together.errors()[:, 0]).all()


@pytest.mark.parametrize(("off", "is_told"), [(0.01, True), (1.0, False)])
def test_how_the_error_falls_is_not_told_where_meshes_do_not_show_the_motion(off: float, is_told: bool) -> None:
    scene = tolerated(1e-3)
    coarse = np.array([row_of(frame) for frame in simulate(replace(scene, numerics=replace(NUMERICS, intervals=16)))])
    fine = np.array([row_of(frame) for frame in simulate(replace(scene, numerics=replace(NUMERICS, intervals=32)))])
    start = 1 + len(NUMBERS)
    fine[1:, start:] += off * LENGTH * (np.arange(fine.shape[1] - start) % WIDTH == R.start)  # r_1 of all nodes
    attempts = [Attempt(mesh, 0, 1.0, 4.0, complete=True, slow=False) for mesh in (0, 1)]
    before = [Excess(mesh=0.5, steps=0.5)] * len(QUANTITIES)  # all was well before
    of_r = Together(scene, attempts, [coarse, fine]).excesses(before)[QUANTITIES.index("r")]
    assert of_r.mesh > 1.0
    assert (of_r.before == 1.0) == is_told


def on_meshes(scene: Scene, *intervals: int) -> list[Array]:
    """The rows of its frames on meshes of so many intervals."""
    return [np.array([row_of(frame) for frame in simulate(replace(scene, numerics=replace(NUMERICS, intervals=n)))])
            for n in intervals]  # fmt: skip


def ran(*trials: tuple[int, int]) -> list[Attempt]:
    return [Attempt(*trial, 1.0, 4.0, complete=True, slow=False) for trial in trials]


def test_two_meshes_with_new_steps_are_told_apart_as_three_are() -> None:
    """Once the error of two alone was told, tens of times too large, though a third had run with longer steps."""
    scene, start = tolerated(1e-3), 1 + len(NUMBERS)
    meshes = on_meshes(scene, 16, 32, 64)
    by_steps = [rows.copy() for rows in meshes[:2]]
    for rows in by_steps:
        rows[1:, start:] += 1e-3 * LENGTH * (np.arange(rows.shape[1] - start) % WIDTH == R.start)  # r_1 of all nodes
    attempts, third = ran((0, 0), (1, 0), (1, 1), (2, 1)), ran((0, 1), (1, 1), (2, 1))
    none = [Excess()] * len(QUANTITIES)
    told = Together(scene, attempts, [*by_steps, *meshes[1:]]).excesses(none)
    assert [excess.mesh for excess in told] == pytest.approx(
        [excess.mesh for excess in Together(scene, third, meshes).excesses(none)]
    )


def test_few_frames_that_stand_out_are_left_out_of_an_error_but_not_of_what_it_is_anywhere() -> None:
    scene, kappa = tolerated(1e-3), QUANTITIES.index("kappa")
    scene = replace(scene, output_interval=scene.t_end / 40)
    rows, start = on_meshes(scene, 16, 32), 1 + len(NUMBERS)
    none = [Excess()] * len(QUANTITIES)
    before = Together(scene, ran((0, 0), (1, 0)), rows).excesses(none)[kappa]
    assert before.anywhere == pytest.approx(before.mesh)
    rows[0][7, start:] += 5.0 * (np.arange(rows[0].shape[1] - start) % WIDTH == KAPPA.start)  # of one frame
    then = Together(scene, ran((0, 0), (1, 0)), rows).excesses(none)[kappa]
    assert then.mesh == pytest.approx(before.mesh, rel=0.2)
    assert then.anywhere > 10.0 * then.mesh


def test_rounding_of_a_large_potential_energy_is_no_error_of_a_rod_that_rests() -> None:
    """A tower of rubber that stays straight between its ends has no energy but that of its place."""
    scene = Scene(Rod.circular(68.6, 0.109, 5e6, 2e6, 1100.0), Initial.straight(), End.clamp(), End.pin(), 60.0, 0.75,
                  gravity=(0.0, 0.0, -9.81), damping=1e-3, numerics=Numerics("staggered", tolerance=1e-3))  # fmt: skip
    run = simulate(scene)
    *_, last = run
    assert last.energy_potential > 1e5 and run.attributes()["tolerance_met"] == "yes"


def test_longest_steps_of_which_nothing_is_told_are_in_error_by_as_much_as_the_mesh() -> None:
    scene = tolerated(1e-3)
    rows = on_meshes(scene, 16, 32)
    by_mesh, by_both = (Together(scene, ran((0, steps), (1, steps)), rows).errors() for steps in (0, -2))
    assert by_mesh[-1, 0] > 0.0
    assert by_both[:, 0] == pytest.approx(2.0 * by_mesh[:, 0])


def test_steps_are_in_error_by_no_more_than_a_diagonal_that_ends_with_them_tells() -> None:
    scene, start = tolerated(1e-3), 1 + len(NUMBERS)
    rows = on_meshes(scene, 16, 16, 32, 64, 128)
    rows[0][1:, start:] += 0.1 * LENGTH * (np.arange(rows[0].shape[1] - start) % WIDTH == R.start)  # r_1 of all nodes
    trials, none = [(0, 0), (0, 1), (1, 1), (2, 2), (3, 2)], [Excess()] * len(QUANTITIES)
    by_diagonal = Together(scene, ran(*trials[:-1]), rows[:-1]).excesses(none)[0].total
    by_steps = Together(scene, ran(*trials[:2]), rows[:2]).excesses(none)[0].steps
    then = Together(scene, ran(*trials), rows).excesses(none)[0].steps
    assert by_steps / 3.0 > 2.0 * by_diagonal
    assert then <= by_diagonal


def test_a_run_that_fails_on_every_mesh_gives_the_frames_until_then_and_fails_by_name() -> None:
    moment = Condition("load", Curve.table([0.0, 2.0], [0.0, 1e4 * EJ], "linear"))
    twisted = End((FREE, FREE, FREE), (FREE, FREE, (moment,)))
    scene = replace(tolerated(1e-3, most_intervals=64), end=twisted, points=(), damping=40.0)
    run = simulate(scene)
    with pytest.raises(RunFailed) as failure:
        list(run)
    assert failure.value.outcome is Outcome.MESH_TOO_COARSE
    assert run.t == failure.value.t or run.t < failure.value.t


def test_a_run_that_cannot_even_start_fails_by_name_and_can_be_asked_for_its_errors() -> None:
    """It ended with a traceback: a rod that spins where both its ends are held."""
    spinning = Initial.straight(direction=(0.0, 0.0, 1.0), angular_velocity=(300.0, 0.0, 0.0))
    run = simulate(replace(tolerated(1e-3, most_intervals=32), initial=spinning, points=(), end=End.clamp()))
    with pytest.raises(RunFailed) as failure:
        list(run)
    assert (failure.value.outcome, failure.value.t) == (Outcome.NO_CONSISTENT_START, 0.0)
    assert not any("error" in note for note in run.notes())


def test_a_rod_at_rest_needs_no_fine_mesh() -> None:
    scene = replace(tolerated(1e-4), points=(), initial=Initial.straight(direction=(1.0, 1.0, 1.0)))
    assert len(next(iter(simulate(scene))).r) - 1 <= 4 * FIRST_INTERVALS


def test_the_first_mesh_is_fine_enough_for_a_rod_of_many_turns() -> None:
    turn = Condition("position", Curve.table([0.0, 4.0], [0.0, 20.0 * 2.0 * np.pi], "smoothstep"))
    end = End((FREE, FREE, FREE), (FREE, FREE, (turn,)))
    run = Refined(replace(tolerated(1e-2), end=end, points=()))
    assert len(run.s) - 1 >= 20.0 * 2.0 * np.pi / LARGEST_TURN


States = dict[Trial, tuple[dict[str, object], list[np.ndarray]]]


def states_at(scene: Scene, frame: int) -> States:
    """Of each attempt of a run the state at a frame, and the rows until then."""
    run, states = Refined(scene), {}
    while (attempt := run.under_way) is not None:
        if len(run.rows) == frame + 1 and attempt.trial not in states:
            states[attempt.trial] = attempt.checkpoint(), list(run.rows)
        run.advance()
    return states


def begun_from(states: States, scene: Scene) -> tuple[Refined, list[bool]]:
    """A run whose attempts begin from states as far as there are any, and whether each did."""
    run, begun, seen = Refined(scene), [], None
    while (attempt := run.under_way) is not None:
        if attempt is not seen and not run.rows:
            begun.append(attempt.trial in states and run.begin_from(*states[attempt.trial]))
            seen = run.under_way
        run.advance()
    return run, begun


@pytest.mark.parametrize("frame", [1, 8, 15])
def test_attempts_that_begin_from_states_of_another_run_give_the_same_to_the_bit(frame: int) -> None:
    alone, frames = done(1e-3)
    run, begun = begun_from(states_at(tolerated(1e-3), frame), tolerated(1e-3))
    assert all(begun)
    assert len(begun) > 2
    for one, other in zip([*run][-16:], frames[-16:], strict=True):
        assert one.r.tobytes() == other.r.tobytes()
        assert isinstance(one, VerifiedFrame)
        assert one.error.kappa.tobytes() == other.error.kappa.tobytes()
    ours, theirs = run.statistics, alone.statistics
    assert (ours.steps, ours.newton_iterations, ours.failed_steps) == (
        theirs.steps, theirs.newton_iterations, theirs.failed_steps)  # fmt: skip
    assert theirs.taken_over == 0 < run.attributes()["steps_taken_over"] == ours.taken_over < ours.steps


def test_an_attempt_that_is_given_up_before_a_state_does_not_begin_from_it(monkeypatch: pytest.MonkeyPatch) -> None:
    states = states_at(tolerated(1e-6, most_intervals=32), 15)
    monkeypatch.setattr(budget, "MOST_WORK", 2e4)
    alone, (run, begun) = Refined(tolerated(1e-6)), begun_from(states, tolerated(1e-6))
    frames = list(alone)
    assert begun[0] is False  # it takes more than a tenth of that work
    assert [frame.f.tobytes() for frame in frames[1:]] == [frame.f.tobytes() for frame in run]
    assert run.statistics.newton_iterations == alone.statistics.newton_iterations


def test_where_strands_pressed_before_a_state_on_a_mesh_too_coarse_for_that_it_is_not_begun_from() -> None:
    scene = tolerated(1e-2)
    run = Refined(scene)
    for _ in range(20):
        run.advance()
    state = run.under_way.checkpoint() if run.under_way else {}
    assert not state[".pressed"]
    for pressed, finer, begins in ((False, 1, True), (True, 0, True), (True, 1, False)):
        other = Refined(scene)
        other._first_if_pressed = run.under_way.trial.mesh + finer if run.under_way else 0
        assert other.begin_from({**state, ".pressed": pressed}, run.rows) is begins
        assert (other.statistics.steps > 0) is begins


def test_the_coarsest_mesh_has_a_node_at_a_point_load_if_few_enough_have() -> None:
    def loaded(*places: float) -> Scene:
        return replace(tolerated(1e-3), points=tuple(PointLoad(at * LENGTH) for at in places))

    assert first_intervals(loaded()) == first_intervals(loaded(0.5, 0.25)) == FIRST_INTERVALS
    assert [first_intervals(loaded(*places)) for places in ((0.4,), (1 / 3, 0.5), (0.4, 0.25), (0.1, 0.4142))] \
        == [20, 18, 20, FIRST_INTERVALS]  # fmt: skip


def test_energies_are_as_uncertain_as_what_went_nowhere() -> None:
    run = Refined(replace(tolerated(1e-2), damping=0.0))  # what is damped is not missed: see test_astray
    frames = list(run)
    together = run._together
    lost = max(abs(number_of(row, BALANCE)) for row in together._recorded[together._chosen.finest])
    largest = max(energy(frame) for frame in frames)
    assert lost > 0.0
    assert run.errors_of_frames[-1, ENERGIES] >= 0.9 * together._unfollowed * lost / largest
    for row in together._recorded[together._chosen.finest]:
        row[1 + ASTRAY] = 0.5 * largest  # as if it had lost so much
    assert run._together.errors()[-1, ENERGIES] >= 0.4 * run._together._unfollowed


def test_what_no_rod_has_is_not_extrapolated() -> None:
    """As where one mesh has buckled and the next has not: an energy below zero."""
    finest, numbers = np.full((1, 1, len(NUMBERS)), 0.5), np.full((1, 1, len(NUMBERS)), -2.0)
    told = possible(numbers, finest)[0, 0]
    assert told[BENDING] == told[CURVATURE] == 0.5
    assert told[TWIST] == told[BALANCE] == -2.0
    assert (possible(-numbers, finest)[0, 0, [BENDING, CURVATURE, TWIST]] == 2.0).all()


def test_the_work_of_an_attempt_is_that_of_its_steps_and_frames() -> None:
    attempt, frames = UnderWay(tolerated(1e-3), Trial(0, 0)), 0
    while not attempt.run.finished:
        frames += attempt.advance() is not None
    tried = attempt.statistics.steps + attempt.statistics.failed_steps
    counted = ABOUT_AXIS.of(16, tried, attempt.statistics.newton_iterations, 0, 0)
    assert attempt.work == pytest.approx(counted + frames * FRAME)
