"""Driven ends: what holds when, and that what is prescribed is what happens."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest
from numpy.testing import assert_allclose

from solver import Condition, Curve, End, Initial, Numerics, Scene, simulate
from solver.physics.ends import ABOUT_A3, LOAD, LOAD_LAB, RATE, RATE_LAB, DrivenEnd
from solver.run.step_control import CONSISTENT_STEPS
from solver.scene.ends import FIXED, FREE
from tests.solver.scenes import ARC, ARC_ROD, ROD, fixed_steps, last, moved_clamp, turned_clamp

AT_REST, ZERO = np.zeros(6), Curve.constant(0.0)


def along(*conditions: Condition, frame: str = "material") -> DrivenEnd:
    """An end whose third translation obeys `conditions`."""
    return DrivenEnd(End((FIXED, FIXED, conditions), (FIXED, FIXED, FIXED), frame=frame))  # type: ignore[arg-type]


def value(end: DrivenEnd, t: float, dt: float = 0.1, gain: float = 0.0) -> float:
    return float(end.values(t, (dt,), gain)[0, 2])


def test_the_kinds_say_what_is_held_and_in_which_frame() -> None:
    components = (FIXED, FREE, (Condition("position"),))
    assert list(DrivenEnd(End(components, components)).kinds) == [RATE, LOAD, RATE, RATE, LOAD, RATE]
    in_lab = DrivenEnd(End(components, components, frame="lab"))
    assert list(in_lab.kinds) == [RATE_LAB, LOAD_LAB, RATE_LAB, RATE, LOAD, RATE]


def test_a_load_is_its_curve_at_the_end_of_the_step() -> None:
    end = along(Condition("load", Curve.table([0.0, 10.0], [0.0, 5.0])))
    assert value(end, 1.0, dt=0.2) == pytest.approx(0.6)


def test_a_condition_comes_into_force_at_its_time() -> None:
    end = along(Condition("load", Curve.constant(3.0)), Condition("rate", Curve.constant(7.0), since=1.0))
    end.switch(0.9, AT_REST)
    assert (end.kinds[2], value(end, 0.9)) == (LOAD, 3.0)
    end.switch(1.0, AT_REST)
    assert (end.kinds[2], value(end, 1.0)) == (RATE, 7.0)


def test_several_conditions_may_pass_at_once() -> None:
    curves = [Curve.constant(float(i)) for i in range(4)]
    end = along(*(Condition("rate", curve, since=0.1 * i) for i, curve in enumerate(curves)))
    end.switch(0.25, AT_REST)
    assert value(end, 0.25) == 2.0


def test_a_stop_begins_at_the_rate_there_is_and_ends_at_none() -> None:
    end = along(Condition("load"), Condition("stop", since=1.0, within=0.2))
    end.switch(1.0, np.array([0.0, 0.0, 0.5, 0.0, 0.0, 0.0]))
    assert end.kinds[2] == RATE
    assert value(end, 1.0, dt=1e-9) == pytest.approx(0.5)
    x = 0.35
    assert value(end, 1.0, dt=x * 0.2) == pytest.approx(0.5 * (1 - x**2 * (3 - 2 * x)))
    assert value(end, 1.0, dt=0.2) == pytest.approx(0.0, abs=1e-15)
    assert value(end, 4.0) == 0.0


def test_steps_are_aligned_with_switches_corners_and_the_end_of_a_stop() -> None:
    ramp = Condition("rate", Curve.table([0.5, 0.75], [0.0, 1.0]))
    times = along(ramp, Condition("stop", since=2.0, within=0.25)).corners()
    assert {0.0, 0.5, 0.75, 2.0, 2.25} <= set(times)


def test_drift_from_what_is_prescribed_is_fed_back() -> None:
    end = along(Condition("rate", Curve.constant(2.0)))
    end.follow(np.array([0.0, 0.0, 0.9, 0.0, 0.0, 0.0]))
    # at t = 0.5 s it should be at 1.0 m
    assert value(end, 0.5, gain=2.0) == pytest.approx(2.0 + 2.0 * 0.1)


def test_a_position_is_followed_from_where_its_curve_is_when_it_comes_into_force() -> None:
    curve = Curve.table([0.0, 4.0], [0.0, 8.0])
    end = along(FREE[0], Condition("position", curve, since=1.0))
    end.follow(np.array([0.0, 0.0, 0.3, 0.0, 0.0, 0.0]))
    end.switch(1.0, AT_REST)
    assert value(end, 1.0, gain=5.0) == pytest.approx(2.0)
    end.follow(np.array([0.0, 0.0, 1.0, 0.0, 0.0, 0.0]))
    assert value(end, 2.0, gain=5.0) == pytest.approx(2.0 + 5.0 * 1.0)


def test_at_a_corner_of_a_position_the_rate_is_the_one_of_the_step_that_ends_there() -> None:
    end = along(Condition("position", Curve.table([0.0, 1.0, 2.0], [0.0, 3.0, 3.0])))
    assert value(end, 0.9, dt=0.1) == pytest.approx(3.0)


def test_the_rotation_prescribed_adds_up_over_switches() -> None:
    first = Condition("rate", Curve.constant(2.0))
    second = Condition("position", Curve.table([0.0, 10.0], [0.0, 5.0]), since=3.0)
    end = DrivenEnd(End((FIXED, FIXED, FIXED), (FIXED, FIXED, (first, second))))
    assert end.prescribed(ABOUT_A3, 1.0) == pytest.approx(2.0)
    assert end.prescribed(ABOUT_A3, 3.0) == pytest.approx(6.0)
    assert end.prescribed(ABOUT_A3, 7.0) == pytest.approx(6.0 + 2.0)


def test_a_rotation_that_was_ever_free_is_not_prescribed() -> None:
    held = Condition("rate", since=2.0)
    assert DrivenEnd(End((FIXED, FIXED, FIXED), (FIXED, FIXED, (FREE[0], held)))).prescribed(ABOUT_A3, 5.0) is None
    stop = Condition("stop", since=2.0, within=0.1)
    end = DrivenEnd(End((FIXED, FIXED, FIXED), (FIXED, FIXED, (FIXED[0], stop))))
    assert end.prescribed(ABOUT_A3, 1.0) == 0.0
    assert end.prescribed(ABOUT_A3, 3.0) is None


TURNED = 3.0
"""rad, within 2 s."""
RATE_OF_TURN = Curve.table([0.0, 1.0, 2.0], [0.0, TURNED, 0.0], "smoothstep")
ANGLE = Curve.table([0.0, 2.0], [0.0, TURNED], "smoothstep")


@pytest.mark.parametrize("condition", [Condition("rate", RATE_OF_TURN), Condition("position", ANGLE)])
@pytest.mark.parametrize("dt", [0.1, 0.31])
def test_a_prescribed_rotation_is_met_exactly_however_coarse_the_steps(condition: Condition, dt: float) -> None:
    """Drift from what is prescribed is fed back: nothing of it is left 130 steps after the motion."""
    t_end = 2.0 + 130 * dt
    scene = Scene(
        rod=ROD, initial=Initial.straight(), start=turned_clamp(condition), end=End.slider(), t_end=t_end,
        output_interval=t_end, damping=20.0, numerics=fixed_steps(10, dt),
    )  # fmt: skip
    frame = last(scene)
    # Lk counts from the first frame on, which follows the tiny steps that find consistent accelerations
    began = TURNED * (2 * CONSISTENT_STEPS[0] * dt) ** 2
    assert frame.Lk == pytest.approx(-TURNED / (2 * pi), abs=began)
    # and the rod is twisted by just that, once the drift of its frames is taken back as well
    assert frame.Tw + frame.Wr == pytest.approx(-TURNED / (2 * pi), abs=1e-12)


def test_an_end_moved_by_position_in_the_lab_frame_arrives_exactly() -> None:
    """Drift from what is prescribed is fed back: nothing of it is left 100 steps after the motion."""
    shift = [Curve.table([0.0, 1.0], [0.0, x], "smoothstep") for x in (0.1, -0.05, -0.2)]
    scene = Scene(
        rod=ARC_ROD, initial=ARC, start=End.clamp(), end=moved_clamp(*shift), t_end=6.0,
        output_interval=0.5, damping=5.0, numerics=fixed_steps(16, 0.04),
    )  # fmt: skip
    frames = list(simulate(scene))
    target = frames[0].r[-1] + np.array([[curve.value(f.t) for curve in shift] for f in frames])
    ends = np.array([f.r[-1] for f in frames])
    arrived = [f.t >= 5.0 for f in frames]
    assert_allclose(ends[arrived], target[arrived], atol=1e-9)
    # On the way, an error of at most dt^3 / 6 times the third derivative, 12 * 0.2 / s^3, is made in each step; the
    # feedback's rate is 5 / s, so that it keeps what was made within 0.2 s.
    assert_allclose(ends, target, atol=0.2 * 12 * 0.2 * 0.04**2 / 6)


def test_an_end_let_go_moves_and_an_end_caught_stays() -> None:
    """The tip of a cantilever is pushed aside while it is free, and held from 1 s on."""
    push = Condition("load", Curve.table([0.0, 0.2], [0.0, 0.02], "smoothstep"))
    tip = End(((push, Condition("stop", since=1.0, within=0.1)), FREE, FREE), (FREE, FREE, FREE), frame="lab")
    scene = Scene(
        rod=ROD, initial=Initial.straight(), start=End.clamp(), end=tip, t_end=3.0, output_interval=0.1,
        numerics=fixed_steps(16, 0.02),
    )  # fmt: skip
    frames = list(simulate(scene))
    x = np.array([f.r[-1, 0] for f in frames])
    assert x[10] > 1e-3
    # caught within 0.1 s; what generalized-alpha remembers of the motion halves in each of 20 more steps
    assert_allclose(x[11:], x[11], rtol=1e-3)
    assert_allclose(x[15:], x[15], atol=1e-9)


@pytest.mark.parametrize(("within", "begin"), [(0.1, 0.25), (0.03, 0.25), (0.03, 0.3), (1e-3, 0.25), (3e-4, 0.25),
                                               (1e-4, 0.25), (1e-5, 0.25), (1e-6, 0.25)])  # fmt: skip
def test_an_end_that_turns_from_rest_to_rest_within_a_step_takes_the_rod_along(within: float, begin: float) -> None:
    """Both rates of a box step were nothing, and the turn came frames later, by what ends are corrected by; or at once,
    faster than twist runs along an interval, of which it made turns there."""
    turn = Curve.table([begin, begin + within], [0.0, 1.0], "smoothstep")
    scene = Scene(ROD, Initial.straight(), End.slider(), turned_clamp(Condition("position", turn)), 1.0, 0.1,
                  damping=3.0, numerics=Numerics(method="box", intervals=10, dt_max=0.1, rho_inf=1.0))  # fmt: skip
    assert max(abs(frame.Tw + frame.Wr - frame.Lk) for frame in simulate(scene)) < 1e-4


@pytest.mark.parametrize(("way", "within"), [(0.02, 0.05), (0.02, 0.03), (0.05, 0.05), (0.05, 0.01)])
def test_one_that_is_moved_from_rest_to_rest_within_a_step_is_where_it_has_to_be(way: float, within: float) -> None:
    """The rod was to follow it within a step that saw none of it, and Newton's iteration stalled."""
    moved = Curve.table([0.25, 0.25 + within], [0.0, way], "smoothstep")
    scene = Scene(ROD, Initial.straight(), moved_clamp(moved, ZERO, ZERO), End.free(), 1.0, 0.1, damping=3.0,
                  numerics=Numerics(method="box", intervals=20, dt_max=0.1))  # fmt: skip
    for frame in simulate(scene):
        assert frame.r[0, 0] == pytest.approx(moved.value(frame.t), abs=1e-3 * way)


def test_one_that_turns_smoothly_is_followed_in_few_steps() -> None:
    """What a step would leave behind is given with the rate at its end. Half of what the step before left behind, as it
    was given, left 4e-3 rad, in 80 steps."""
    turn = Curve.table([0.0, 0.5, 1.5, 2.0], [0.0, 4.0, -4.0, 0.0], "smoothstep")
    scene = Scene(ROD, Initial.straight(), End.slider(), turned_clamp(Condition("position", turn)), 2.0, 0.1,
                  numerics=Numerics(method="box", intervals=20, dt_max=0.05))  # fmt: skip
    run = simulate(scene)
    frames = list(run)
    angles = np.unwrap([2.0 * np.arctan2(frame.orientation[-1, 3], frame.orientation[-1, 0]) for frame in frames])
    assert np.abs(angles - [turn.value(frame.t) for frame in frames]).max() < 1.5e-3
    assert run.statistics.steps < 60
