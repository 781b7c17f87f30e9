"""Runs of the staggered method: what is exact by construction, its orders, and its steps."""

from __future__ import annotations

from dataclasses import replace
from itertools import islice

import numpy as np
import pytest

from solver import (
    Condition,
    Curve,
    DistributedLoad,
    End,
    Initial,
    Numerics,
    Outcome,
    PointLoad,
    Rod,
    RunFailed,
    Scene,
    simulate,
)
from solver.arrays import Array
from solver.methods.staggered import StaggeredMethod
from solver.scene.curve import constant_vector
from tests.solver.scenes import ARC, ARC_ROD, EJ, FIXED_STEPS, LENGTH, ROD, turned_clamp
from validation.free_flight import curled

ROUNDING = 1e-12
LARGEST_MISS = 1e-10
"""Of Tw + Wr - Lk: the end lags behind its prescribed angle by as much while that is accelerated."""


def staggered(intervals: int, dt: float, tolerance: float = FIXED_STEPS) -> Numerics:
    return Numerics(method="staggered", intervals=intervals, dt_max=dt, increment_tolerance=tolerance)


def twisted_arc(turns: float, numerics: Numerics, t_end: float = 1.0) -> Scene:
    """The arc, one end turned about its tangent: it bends out of its plane."""
    turned = Curve.table([0.0, 0.4, t_end], [0.0, 2 * np.pi * turns, 2 * np.pi * turns], "smoothstep")
    return Scene(ARC_ROD, ARC, End.clamp(), turned_clamp(Condition("position", turned)), t_end, 0.1, damping=2.0,
                 numerics=numerics)  # fmt: skip


def test_what_is_exact_by_construction_is_exact() -> None:
    frames = list(simulate(twisted_arc(1.0, staggered(40, 0.02))))
    assert max(abs(frame.Wr) for frame in frames) > 0.1
    for frame in frames:
        assert np.abs(np.linalg.norm(np.diff(frame.r, axis=0), axis=1) * 40 / LENGTH - 1.0).max() <= ROUNDING
        assert abs(frame.Tw + frame.Wr - frame.Lk) <= LARGEST_MISS


def test_an_end_that_is_held_stays_where_it_is() -> None:
    first, *_, last = simulate(twisted_arc(1.0, staggered(40, 0.02, 1e-4)))
    assert np.abs(last.r[-1] - first.r[-1]).max() <= 1e-6 * LENGTH


def momenta(method: StaggeredMethod) -> tuple[Array, Array]:
    """Linear and angular momentum of the segments."""
    place, velocity, _ = method._centres
    R, omega, chain = method._R[1:-1], method.state.omega[1:-1], method.chain
    spin = np.einsum("jkm,jm->jk", R, chain.inertia * omega)
    mass = chain.mass[:, None]
    return chain.h * (mass * velocity).sum(axis=0), chain.h * (mass * np.cross(place, velocity) + spin).sum(axis=0)


def test_free_flight_conserves_momentum_and_angular_momentum() -> None:
    initial = Initial(curled, velocity=(0.1, 0.2, -0.3), angular_velocity=(1.0, 2.0, 0.5))
    scene = Scene(ROD, initial, End.free(), End.free(), 0.5, 0.5, numerics=staggered(30, 0.05, 1e-5))
    simulation = simulate(scene)
    run = iter(simulation)
    next(run)
    before = momenta(simulation._method)  # type: ignore[arg-type]
    for _ in run:
        pass
    after = momenta(simulation._method)  # type: ignore[arg-type]
    assert np.abs(after[0] - before[0]).max() <= 1e-9 * np.abs(before[0]).max()
    assert np.abs(after[1] - before[1]).max() <= 5e-7 * np.abs(before[1]).max()


def swung(numerics: Numerics) -> Scene:
    """A cantilever under a load that comes and goes smoothly."""
    schedule = Curve.table([0.0, 1.5, 3.0], [0.0, 1.0, 0.0], "smoothstep")
    load = DistributedLoad(constant_vector((5.0 * EJ / LENGTH**3, 2.0 * EJ / LENGTH**3, 0.0)), schedule=schedule)
    return Scene(ROD, Initial.straight(), End.clamp(), End.free(), 1.5, 1.5, distributed=(load,), damping=1.0,
                 numerics=numerics)  # fmt: skip


def last_r(scene: Scene) -> Array:
    *_, frame = simulate(scene)
    return frame.r


def test_the_time_scheme_is_of_order_three_at_least_on_a_smooth_load() -> None:
    """Radau IIA of order 5 has stage order 3, which is what stiff equations show of it."""
    reference = last_r(swung(staggered(20, 0.005)))
    errors = [np.abs(last_r(swung(staggered(20, dt))) - reference).max() for dt in (0.2, 0.1, 0.05)]
    assert errors[0] <= 1e-6 * LENGTH
    assert (np.log2(np.array(errors[:-1]) / errors[1:]) >= 3.0).all()


@pytest.mark.parametrize(("load", "deflection"), [(1.0, 0.301721), (5.0, 0.713792), (10.0, 0.810609)])
def test_a_damped_cantilever_comes_to_rest_at_the_elastica_with_order_two(load: float, deflection: float) -> None:
    def error(intervals: int) -> float:
        force = Curve.constant(load * EJ / LENGTH**2)
        tip = End(((Condition("load", force),), (Condition("load"),), (Condition("load"),)),
                  tuple((Condition("load"),) for _ in range(3)), frame="lab")  # type: ignore[arg-type]  # fmt: skip
        scene = Scene(ROD, Initial.straight(), End.clamp(), tip, 60.0, 60.0, damping=1.6,
                      numerics=staggered(intervals, 0.5, 1e-2))  # fmt: skip
        return float(last_r(scene)[-1, 0] / LENGTH - deflection)

    coarse, fine = error(20), error(40)
    assert abs(fine) <= 5e-4
    assert coarse / fine == pytest.approx(4.0, rel=0.15)


def test_a_run_is_repeatable_to_the_bit() -> None:
    one, two = (last_r(twisted_arc(0.5, staggered(16, 0.05), t_end=0.5)) for _ in range(2))
    assert np.array_equal(one, two)


def test_both_methods_agree_to_the_order_of_their_meshes() -> None:
    def gap(intervals: int) -> float:
        box = Numerics(intervals=intervals, dt_max=0.004, rho_inf=0.8, increment_tolerance=FIXED_STEPS)
        scene = twisted_arc(0.5, staggered(intervals, 0.02), t_end=0.6)
        return float(np.abs(last_r(scene) - last_r(replace(scene, numerics=box))).max())

    coarse, fine = gap(20), gap(40)
    assert fine <= 2e-3 * LENGTH
    assert coarse / fine == pytest.approx(4.0, rel=0.4)


def let_go(twist: float, second: float, torsional: float, intervals: int, initial: Initial = ARC) -> Scene:
    """A rod of EJ2 / EJ1 = `second` and GJ / EJ1 = `torsional`, straight when at rest, twisted (rad) and let go."""
    stiffness = (Curve.constant(EJ), Curve.constant(second * EJ), Curve.constant(torsional * EJ))
    start = replace(initial, twist=Curve.table([0.0, LENGTH], [0.0, twist]))
    return Scene(replace(ROD, stiffness=stiffness), start, End.free(), End.free(), 0.02, 0.01,
                 numerics=staggered(intervals, 1.0, 0.01))  # fmt: skip


@pytest.mark.parametrize(
    "scene",
    [
        pytest.param(let_go(0.0, 2.2, 0.018, 20), id="the first correction is smaller than the second"),
        pytest.param(let_go(5.0, 2.2, 0.018, 25), id="the ends turn at once, however short the step"),
        pytest.param(let_go(5.0, 0.32, 480.0, 8, Initial.straight()), id="only very short steps start"),
    ],
)
def test_a_bent_or_twisted_rod_that_is_let_go_starts_and_makes_no_energy(scene: Scene) -> None:
    """Found under stress: each ended in a stalled iteration, though nothing was wrong with the case.

    The stress jumps at the ends, so that the highest modes ring; Radau damps those that the steps do not resolve.
    """
    first, second = islice(simulate(scene), 2)
    stored = first.energy_bending + first.energy_torsion
    assert second.energy_kinetic > 0.01 * stored
    assert -0.5 * stored < second.energy_balance < 1e-6 * stored


def test_a_run_that_loses_much_of_its_energy_ends_by_name() -> None:
    """The joints of free ends turn at once: of 8 intervals' energy an eighth."""
    with pytest.raises(RunFailed) as caught:
        list(simulate(let_go(5.0, 0.32, 480.0, 8, Initial.straight())))
    assert caught.value.outcome is Outcome.ENERGY_LOST
    assert caught.value.t == 0.02


def test_a_tight_tolerance_does_not_shorten_steps_without_end() -> None:
    """What Newton's iteration leaves is no error of the step: beside less motion it only looks larger."""
    numerics = staggered(80, 1e-3, 1e-7)
    scene = Scene(ARC_ROD, ARC, End.clamp(), End.free(), 2e-3, 2e-3, gravity=(3.0, 5.0, 1.0), numerics=numerics)
    simulation = simulate(scene)
    assert len(list(simulation)) == 2
    assert simulation.statistics.steps < 200


def test_a_long_thin_tether_that_turns_needs_no_short_steps() -> None:
    """Its segments swing by little in a step but are far longer than thick: a force that turns with their tangents must
    not be taken for a moment about these. It once took steps of 0.02 s, 30,000 of them."""
    push = Curve.table([0.0, 10.0, 20.0], [0.0, 1e-3, 0.0])
    scene = Scene(
        Rod.circular(1000.0, 0.003, 6e10, 6e10, 2800.0),
        Initial.straight(angular_velocity=(0.05, 0.0, 0.0)), End.free(), End.free(), 120.0, 6.0,
        points=(PointLoad(700.0, (push, Curve.constant(0.0), Curve.constant(0.0))),),
        numerics=staggered(16, 6.0, 1e-2),
    )  # fmt: skip
    simulation = simulate(scene)
    first, *_, last = simulation
    assert simulation.statistics.steps < 100 and simulation.statistics.failed_steps < 5
    assert abs(last.energy_balance) < 1e-6 * first.energy_kinetic
