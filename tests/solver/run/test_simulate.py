"""A run: when its frames come, how it fails, what it converges to, and that its kernels compile once."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace
from itertools import pairwise
from math import asin, sqrt
from typing import Literal

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.interpolate import CubicSpline
from scipy.optimize import brentq
from scipy.special import ellipe, ellipeinc, ellipk, ellipkinc

from solver import (
    Condition,
    Curve,
    DistributedLoad,
    End,
    Initial,
    Numerics,
    Outcome,
    PointLoad,
    RunFailed,
    Scene,
    simulate,
)
from solver.arrays import Array
from tests.solver.scenes import ARC, ARC_ROD, EJ, LENGTH, ROD, fixed_steps, last, turned_clamp

ZERO = Curve.constant(0.0)
CRITICAL = 1.6
"""1/s: twice the 0.8 rad/s at which the cantilever swings, so that it comes to rest soonest."""


def cantilever(**others: object) -> Scene:
    """Clamped at its start; `others` replace what else there is."""
    scene = Scene(
        rod=ROD, initial=Initial.straight(), start=End.clamp(), end=End.free(), t_end=1.0, output_interval=0.25,
        numerics=fixed_steps(10, 0.1),
    )  # fmt: skip
    return replace(scene, **others)  # type: ignore[arg-type]


def tip_force(size: float, within: float = 0.5) -> tuple[PointLoad, ...]:
    """A dead force along e1 at the tip, growing smoothly."""
    return (PointLoad(LENGTH, force=(Curve.table([0.0, within], [0.0, size], "smoothstep"), ZERO, ZERO)),)


@pytest.mark.parametrize(
    ("t_end", "interval", "times"),
    [
        (1.0, 0.25, [0.0, 0.25, 0.5, 0.75, 1.0]),
        (1.0, 0.3, [0.0, 0.3, 0.6, 0.9, 1.0]),
        (1.0, 0.4, [0.0, 0.4, 0.8, 1.0]),
        (1.0, 0.35, [0.0, 0.35, 0.7, 1.0]),
        (0.7, 0.1, [0.1 * k for k in range(8)]),
        (1.0, 1.0, [0.0, 1.0]),
        (1.0, 0.6, [0.0, 0.6, 1.0]),
    ],
)
def test_frames_come_at_the_output_times_and_at_the_end(t_end: float, interval: float, times: list[float]) -> None:
    scene = cantilever(t_end=t_end, output_interval=interval, points=tip_force(0.01))
    assert [frame.t for frame in simulate(scene)] == pytest.approx(times, rel=1e-12)


def test_the_state_of_a_frame_is_that_of_its_time() -> None:
    """A rod in uniform flight is where its velocity has taken it, whatever the steps."""
    scene = cantilever(
        initial=Initial.straight(velocity=(0.5, 0.0, -1.0)), start=End.free(), t_end=1.0, output_interval=0.3,
        numerics=fixed_steps(10, 0.07),
    )  # fmt: skip
    first, *frames = list(simulate(scene))
    for frame in frames:
        assert_allclose(frame.r - np.outer(np.linspace(0.0, 1.0, 11), [0.0, 0.0, 1.0]),
                        np.tile([0.5 * frame.t, 0.0, -frame.t], (11, 1)), atol=1e-9)  # fmt: skip
    assert_allclose(first.r[0], 0.0, atol=1e-15)


@pytest.mark.parametrize("corner", [0.3, 3 * 0.1, 0.3 + 1e-12, 0.7])
@pytest.mark.parametrize("dt_max", [0.05, 0.5])
@pytest.mark.parametrize("method", ["box", "staggered"])
def test_a_frame_is_of_its_time_where_that_differs_from_a_corner_by_rounding(
    corner: float, dt_max: float, method: Literal["box", "staggered"]
) -> None:
    """3 * 0.1 is the next number after 0.3: a step that ends on one of the two has reached the other one."""
    bent = Curve.table([0.0, corner, 2.0], [0.0, 1e-12, 0.0])
    scene = cantilever(
        initial=Initial.straight(velocity=(0.0, 0.0, 1.0)), start=End.free(), t_end=1.0, output_interval=0.1,
        points=(PointLoad(LENGTH, (bent, Curve.constant(0.0), Curve.constant(0.0))),),
        numerics=Numerics(method=method, intervals=10, dt_max=dt_max),
    )  # fmt: skip
    frames = list(simulate(scene))
    assert_allclose([frame.r[0, 2] for frame in frames], [frame.t for frame in frames], atol=1e-9)


def test_a_frame_sooner_than_the_shortest_steps_is_refused_by_name() -> None:
    numerics = replace(fixed_steps(10, 0.1), rho_inf_space=0.5)
    with pytest.raises(RunFailed, match=r"no_consistent_start.*the first frame comes sooner"):
        list(simulate(cantilever(numerics=numerics, t_end=1e-4, output_interval=1e-4)))


@pytest.mark.parametrize("since", [0.3, 3 * 0.1])
@pytest.mark.parametrize("interval", [0.1, 0.3])
def test_an_end_is_switched_though_a_frame_is_due_an_instant_before(since: float, interval: float) -> None:
    let_go = (Condition("rate", Curve.constant(0.0)), Condition("load", Curve.constant(0.0), since=since))
    hold = End((let_go,) * 3, (let_go,) * 3)
    scene = cantilever(start=hold, gravity=(0.0, 0.0, -1.0), t_end=1.3, output_interval=interval)
    *_, frame = simulate(scene)
    assert frame.r[0, 2] == pytest.approx(-0.5 * (1.3 - since) ** 2, rel=0.02)


def test_the_first_frame_of_a_spinning_rod_is_its_start_with_the_force_that_holds_it_together() -> None:
    spin = 3.0
    initial = Initial.straight(velocity=(0.5, 0.0, -1.0), angular_velocity=(0.0, spin, 0.0))
    frame = next(iter(simulate(cantilever(initial=initial, start=End.free()))))
    s = np.linspace(0.0, LENGTH, 11)
    arm = s - 0.5 * LENGTH
    assert_allclose(frame.r, np.outer(s, [0.0, 0.0, 1.0]), atol=1e-15)
    assert_allclose(frame.v, np.outer(np.ones(11), [0.5, 0.0, -1.0]) + np.outer(arm, [spin, 0.0, 0.0]), atol=1e-14)
    assert_allclose(frame.omega, np.tile([0.0, spin, 0.0], (11, 1)), atol=1e-15)
    assert frame.energy_balance == 0.0
    mass = float(ROD.mass(s)[0])
    centrifugal = 0.5 * mass * spin**2 * ((0.5 * LENGTH) ** 2 - arm**2)
    assert_allclose(frame.f[:, 2], centrifugal, rtol=1e-3, atol=1e-9)


def test_the_first_frame_is_the_initial_state() -> None:
    frame = next(iter(simulate(cantilever(initial=Initial.straight(origin=(1.0, 2.0, 3.0))))))
    assert_allclose(frame.r[0], [1.0, 2.0, 3.0], atol=1e-12)
    assert_allclose(frame.r[-1], [1.0, 2.0, 4.0], atol=1e-12)
    assert frame.t == 0.0
    assert_allclose([frame.work_ends, frame.work_loads, frame.dissipation, frame.energy_balance], 0.0, atol=1e-30)


def test_the_nodes_are_even_along_the_rod() -> None:
    simulation = simulate(cantilever())
    assert_allclose(simulation.s, np.linspace(0.0, LENGTH, 11), atol=1e-15)
    assert all(len(frame.r) == 11 for frame in simulation)


def test_statistics_grow_with_the_run() -> None:
    simulation = simulate(cantilever(points=tip_force(0.02)))
    frames = iter(simulation)
    next(frames)
    told = simulation.statistics
    seen = [(told.steps, told.newton_iterations), *((told.steps, told.newton_iterations) for _ in frames)]
    assert all(before < after for before, after in pairwise(seen))
    # at least the ten steps of 0.1 s, each with an iteration, and the two that begin
    assert seen[-1][0] >= 12
    assert seen[-1][1] >= seen[-1][0]
    assert simulation.statistics.failed_steps == 0
    assert simulation.statistics.cpu_time > 0.0


def test_steps_end_on_the_corners_of_what_drives_the_rod() -> None:
    """A load that jumps in slope between two steps would otherwise be smeared over one."""
    scene = cantilever(points=tip_force(0.02, within=0.537), numerics=fixed_steps(10, 0.1), output_interval=1.0)
    reached: list[float] = []
    simulation = simulate(scene)
    take = simulation._method.take_step
    simulation._method.take_step = lambda t, dt: (reached.append(t + dt), take(t, dt))[1]  # type: ignore[method-assign]
    list(simulation)
    assert min(abs(t - 0.537) for t in reached) < 1e-9


def test_a_run_that_fails_tells_when_where_and_what_to_do() -> None:
    """A force that no step is short enough for."""
    jump = (PointLoad(LENGTH, force=(Curve.table([0.3, 0.3 + 1e-12], [0.0, 1e12]), ZERO, ZERO)),)
    with pytest.raises(RunFailed) as caught:
        list(simulate(cantilever(points=jump)))
    failure = caught.value
    assert failure.outcome is Outcome.STEP_TOO_SMALL
    assert failure.t == pytest.approx(0.3, abs=1e-6)
    assert failure.step > 3
    told = str(failure)
    assert told.startswith(f"step_too_small at t = {failure.t:.6g} s, step {failure.step}")
    assert told.endswith(Outcome.STEP_TOO_SMALL.remedy)


def test_shooting_that_loses_its_digits_says_so() -> None:
    thin = Numerics(intervals=20, dt_max=0.003, linear_solver="shooting")
    with pytest.raises(RunFailed, match=r"shooting_lost_digits at t = .* s, step \d+.*block_elimination") as caught:
        list(simulate(cantilever(numerics=thin)))
    assert caught.value.outcome is Outcome.SHOOTING_LOST_DIGITS


def test_a_rod_that_cannot_move_as_told_is_singular() -> None:
    """A straight inextensible rod held at both ends: the force along it is not determined."""
    with pytest.raises(RunFailed) as caught:
        list(simulate(cantilever(end=End.clamp())))
    assert caught.value.outcome in (Outcome.SINGULAR_SYSTEM, Outcome.NO_CONSISTENT_START)
    assert caught.value.t == 0.0


def test_a_rod_held_along_its_axis_is_told_so_where_a_load_hides_it() -> None:
    """Rounding makes the force along the axis look determined: what is said must still be what to do."""
    across = (PointLoad(0.3, force=(Curve.constant(1.0), ZERO, ZERO)),)
    scene = cantilever(end=End.pin(), points=across, numerics=Numerics(method="box", intervals=15))
    with pytest.raises(RunFailed, match="along its axis at both ends") as caught:
        list(simulate(scene))
    assert caught.value.t == 0.0


@pytest.mark.parametrize("method", ["box", "staggered"])
def test_a_rod_that_curls_up_between_two_nodes_is_refused_by_name(method: Literal["box", "staggered"]) -> None:
    """Found under stress: the box method made energy out of such bends, and said that it was done."""
    turn = turned_clamp(Condition("position", Curve.table([0.0, 1.0], [0.0, 40.0])))
    scene = Scene(ARC_ROD, ARC, End.clamp(), turn, 1.0, 0.05, damping=5.0,
                  numerics=Numerics(method=method, intervals=5, dt_max=0.05))  # fmt: skip
    with pytest.raises(RunFailed, match="rad within an interval") as caught:
        list(simulate(scene))
    assert caught.value.outcome is Outcome.MESH_TOO_COARSE


@pytest.mark.parametrize("method", ["box", "staggered"])
def test_a_rod_that_curls_up_between_two_frames_is_refused_when_it_does(method: Literal["box", "staggered"]) -> None:
    """Found among the stress test's random cases, [1, 210]: past half a turn a relative rotation looks small again."""
    turn = turned_clamp(Condition("position", Curve.table([0.0, 1.0], [0.0, 40.0])))
    scene = Scene(ARC_ROD, ARC, End.clamp(), turn, 1.0, 1.0, damping=5.0,
                  numerics=Numerics(method=method, intervals=5, dt_max=0.05))  # fmt: skip
    with pytest.raises(RunFailed, match="rad within an interval") as caught:
        list(simulate(scene))
    assert caught.value.outcome is Outcome.MESH_TOO_COARSE
    # five intervals and as much again as the arc bends: half a turn each, but waves on the way from the end
    assert 0.1 < caught.value.t < 5 * np.pi / 40.0


@pytest.mark.parametrize("outcome", [o for o in Outcome if o is not Outcome.COMPLETED])
def test_every_outcome_that_is_no_success_has_a_remedy(outcome: Outcome) -> None:
    assert outcome.remedy in str(RunFailed(outcome, 1.25, 7, "why"))
    assert "t = 1.25 s, step 7 (why)" in str(RunFailed(outcome, 1.25, 7, "why"))
    assert len(outcome.remedy) > 10


def test_a_clamped_rod_at_rest_stays_at_rest_exactly() -> None:
    first, *frames = list(simulate(cantilever(t_end=10.0, output_interval=5.0)))
    for frame in frames:
        for name in ("v", "omega", "f", "kappa"):
            assert_allclose(getattr(frame, name), 0.0, atol=1e-14)
        assert_allclose(frame.r, first.r, atol=1e-14)


def test_an_arc_that_is_free_of_stress_stays_at_rest() -> None:
    scene = cantilever(rod=ARC_ROD, initial=ARC, numerics=fixed_steps(20, 0.1), t_end=2.0)
    first, *frames = list(simulate(scene))
    for frame in frames:
        # the spline through the arc gives its curvature to (BEND / 160)^2 / 12 of BEND
        assert_allclose(frame.r, first.r, atol=3e-5)
        assert_allclose(frame.q, 0.0, atol=1e-4 * EJ)


WAVY = 4.0
"""rad/m: a curvature of WAVY sin^2(3 s)."""


def wavy_curvature(s: Array) -> Array:
    return np.asarray(WAVY * np.sin(3 * s) ** 2, dtype=float)


def wavy(s: Array) -> Array:
    fine = np.linspace(0.0, LENGTH, 2001)
    angle = CubicSpline(fine, wavy_curvature(fine)).antiderivative()(fine)
    tangent = np.column_stack([np.sin(angle), np.zeros_like(angle), np.cos(angle)])
    return np.asarray(CubicSpline(fine, tangent).antiderivative()(s), dtype=float)


def test_a_rod_of_uneven_curvature_that_is_free_of_stress_stays_at_rest() -> None:
    """Its curvature is known from a spline eight times finer than the nodes: to kappa'' (ds/8)^2 / 12."""
    intervals = 20
    rod = replace(ROD, kappa0=(ZERO, wavy_curvature, ZERO))
    scene = cantilever(rod=rod, initial=Initial(wavy), numerics=fixed_steps(intervals, 0.05), damping=2.0)
    unknown = 18 * WAVY * (LENGTH / intervals / 8) ** 2 / 12
    first, *frames = list(simulate(scene))
    # let go, a cantilever swings to twice the deflection L^2 / 2 per curvature
    assert max(np.abs(frame.r - first.r).max() for frame in frames) < unknown * LENGTH**2


def elastica(alpha: float) -> tuple[float, float]:
    """Deflection and shortening of the tip, over L, for P L^2 / EI = alpha (Bisshopp & Drucker 1945)."""

    def load_at(m: float) -> float:
        return float(ellipk(m) - ellipkinc(asin(1.0 / sqrt(2.0 * m)), m)) ** 2

    m = brentq(lambda m: load_at(m) - alpha, 0.5 + 1e-12, 1.0 - 1e-12, xtol=1e-16, rtol=1e-15)
    arc = float(ellipe(m) - ellipeinc(asin(1.0 / sqrt(2.0 * m)), m))
    return 1.0 - 2.0 * arc / sqrt(alpha), 1.0 - sqrt(2.0 * (2.0 * m - 1.0) / alpha)


@pytest.mark.parametrize("rho_inf_space", [1.0, 0.5])
def test_the_rod_comes_to_rest_at_the_elastica_with_order_two(rho_inf_space: float) -> None:
    alpha = 2.0
    exact = np.array(elastica(alpha))
    errors = []
    for intervals in (10, 20, 40):
        numerics = replace(fixed_steps(intervals, 0.25), rho_inf_space=rho_inf_space)
        frame = last(cantilever(
            points=tip_force(alpha * EJ / LENGTH**2, within=5.0), damping=CRITICAL, numerics=numerics,
            t_end=45.0, output_interval=45.0, topology=False,
        ))  # fmt: skip
        # exp(-0.8 * 40) of the motion is left
        assert frame.energy_kinetic < 1e-20 * frame.energy_bending
        errors.append(np.abs(np.array([frame.r[-1, 0] / LENGTH, 1.0 - frame.r[-1, 2] / LENGTH]) - exact))
    orders = np.log2(np.array(errors[:-1]) / np.array(errors[1:]))
    # the next term is of order 4 (3 with rho_inf_space < 1): by 20 intervals it has faded to a tenth
    assert_allclose(orders[-1], 2.0, atol=0.2)


@pytest.mark.parametrize("rho_inf", [1.0, 0.5])
def test_the_time_scheme_is_of_order_two_on_a_smooth_load(rho_inf: float) -> None:
    growth = Curve.table([0.0, 2.0], [0.0, 1.0], "smoothstep")
    force = (Curve.constant(4.0 * EJ), Curve.table([0.0, LENGTH], [0.0, 4.0 * EJ]), ZERO)
    load = DistributedLoad(force, schedule=growth)
    scene = cantilever(distributed=(load,), damping=20.0, t_end=2.0, output_interval=2.0, topology=False)
    # the feedback of drift is the same at these steps; at longer ones it is limited
    frames = [last(replace(scene, numerics=fixed_steps(10, dt, rho_inf))) for dt in (0.01, 0.005, 0.0025)]
    for name in ("r", "v", "omega", "kappa", "f"):
        values = [getattr(frame, name) for frame in frames]
        coarse, fine = (np.abs(a - b).max() for a, b in pairwise(values))
        assert np.log2(coarse / fine) == pytest.approx(2.0, abs=0.2), name


@pytest.mark.parametrize("solver", ["shooting", "banded"])
def test_all_linear_solves_give_the_same_run(solver: str) -> None:
    """Where shooting keeps its digits: thick, and at large steps."""
    scene = cantilever(points=tip_force(0.02))
    by_another = replace(scene, numerics=replace(scene.numerics, linear_solver=solver))
    # growth of some 1e3 at dt = 0.1 costs as many of 1e-16, and Newton stops at 1e-9 rod lengths a step
    assert_allclose(last(by_another).r, last(scene).r, atol=1e-8)


def test_a_run_is_repeatable_to_the_bit() -> None:
    scene = cantilever(points=tip_force(0.02))
    for name in ("r", "v", "omega", "kappa", "f", "orientation"):
        assert np.array_equal(getattr(last(scene), name), getattr(last(scene), name))


COMPILE_ONCE = """
import sys
from dataclasses import replace
from numba.core.dispatcher import Dispatcher
from solver import *
from solver.run.warming import load
from tests.solver.scenes import ARC, ARC_ROD, ROD, fixed_steps, moved_clamp, turned_clamp

ONE, ZERO = Curve.constant(1), Curve.constant(0)
GROWTH = Curve.table([0, 1], [0, 1], "smoothstep")
LINEAR = eval(sys.argv[1])


def run(**others):
    scene = Scene(rod=ROD, initial=Initial.straight(), start=End.clamp(), end=End.free(), t_end=1, output_interval=1,
                  numerics=Numerics(intervals=8, dt_max=1, rho_inf=1, **LINEAR))
    try:
        for frame in simulate(replace(scene, **others)):
            pass
    except RunFailed as failure:
        print("ended with", failure, file=sys.stderr)


load("box", True, LINEAR.get("linear_solver", Numerics.linear_solver), "rho_inf_space" in LINEAR)
force = (Curve.constant(1e-3), ZERO, ZERO)
run(rod=Rod.circular(1, 1, 10**7, 5 * 10**6, 1500))
run(distributed=(DistributedLoad(force), DistributedLoad(force, frame="material", schedule=GROWTH)), damping=1)
run(points=(PointLoad(1, force=force), PointLoad(0.3, force=force, frame="material"), PointLoad(0, moment=force)))
run(gravity=(0, 0, -1), fluid=Fluid(1000, 1, 1, 1, current=(1, 0, 0)))
run(initial=Initial.straight(velocity=(1, 0, 0), angular_velocity=(0, 1, 0)), start=End.free())
run(rod=ARC_ROD, initial=ARC, end=moved_clamp(GROWTH, ZERO, ZERO))
run(start=turned_clamp(Condition("rate", ONE)), end=End.slider())
run(start=End.pin(), gravity=(1, 0, 0))
run(contact=Contact(1, 2, 0, 1, 1, 0.01, 0.1, 0.01))
run(contact=Contact(k1=1e-9, k2=3, k3=0, k4=1, aperture=1, cutoff=0.6, skip=0.5, spacing=0.05, sum="grid_points"))
run(numerics=Numerics(intervals=8, dt_max=0.1, rho_inf=0, **LINEAR))
if "rho_inf_space" in LINEAR:
    run(numerics=Numerics(intervals=8, dt_max=0.1, rho_inf_space=0.5))

for name, module in sorted(sys.modules.items()):
    if name == "solver" or name.startswith("solver."):
        for attribute, value in vars(module).items():
            if isinstance(value, Dispatcher) and value.py_func.__module__ == name and len(value.signatures) > 1:
                print(f"{name}.{attribute}: {value.signatures}")
"""


@pytest.mark.parametrize("linear", [{}, {"linear_solver": "shooting"}, {"rho_inf_space": 0}])
def test_every_kernel_compiles_once(linear: dict[str, object]) -> None:
    """Two signatures of one kernel cost a user a second compilation in the middle of a run.

    Integers in the place of floats, loads of every kind and contact must all find the kernels that warming has made for
    the linear solver. In a process of its own, since tests call kernels as they please.
    """
    program = [sys.executable, "-c", COMPILE_ONCE, repr(linear)]
    done = subprocess.run(program, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout == ""


@pytest.mark.parametrize("method", ["box", "staggered"])
def test_what_a_run_gives_does_not_depend_on_when_it_ends(method: str) -> None:
    """To the bit, but for the last frame of the shorter one, at which it judges itself."""
    numerics = Numerics(method=method, intervals=20, dt_max=0.02)  # type: ignore[arg-type]
    scene = Scene(rod=ROD, initial=Initial.straight(), start=End.clamp(), end=End.free(), gravity=(-9.81, 0.0, 0.0),
                  t_end=0.4, output_interval=0.1, numerics=numerics)  # fmt: skip
    shorter, longer = list(simulate(scene)), list(simulate(replace(scene, t_end=0.6)))
    for early, late in zip(shorter[:-1], longer, strict=False):
        assert (early.r == late.r).all() and (early.f == late.f).all()
