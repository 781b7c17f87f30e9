"""Equilibria: they agree with theory and with damped motion, and branches go past folds."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from math import pi

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import solve_bvp, solve_ivp
from scipy.optimize import brentq, fsolve

from solver import (
    FIXED,
    FREE,
    Condition,
    Curve,
    End,
    Fluid,
    Frame,
    Initial,
    Numerics,
    Outcome,
    PointLoad,
    Rod,
    RunFailed,
    Scene,
    Shear,
    constant_vector,
    simulate,
)
from solver.arrays import Array
from solver.kernels.rotation import rotate
from solver.physics.elasticity import Stretch
from solver.physics.loads.solids import Floor, Obstacle
from solver.statics.equations import Equations
from solver.statics.point import FORCE, PSI, X
from solver.statics.tangent import levers
from tests.solver.scenes import (
    ARC,
    ARC_ROD,
    DENSITY,
    DIAMETER,
    EJ,
    GJ,
    LENGTH,
    ROD,
    last,
    turned_clamp,
)
from tests.solver.statics.resting import PRESSED, ZERO, ramp, static

ELASTIC = replace(ROD, laws=(Stretch(Curve.constant(0.02)),))
SOFT = {f"{name}, of a rod that can stretch": {"rod": ELASTIC, **PRESSED[name]}
        for name in ("current", "free start", "pin and clamp")}  # fmt: skip


@pytest.mark.parametrize("loads", [*PRESSED.values(), *SOFT.values()], ids=[*PRESSED, *SOFT])
def test_the_tangent_is_the_derivative_of_the_residual(loads: dict[str, object]) -> None:
    random = np.random.default_rng(1)
    equations = Equations(static(numerics=Numerics(intervals=4), initial=Initial.straight(twist=ramp(2.0)), **loads))
    n = len(equations.start.quaternion)
    away = random.normal(size=(n, 9)) * np.repeat([0.3, 0.01, EJ], 3)
    for side, end in enumerate(equations.ends):
        away[-side, PSI][end.held[3:]] = 0.0
    point = equations.start.moved(away, 0.5)
    _, solver = equations.linearise(point)
    lever, opens = levers(equations.stages.R[0].copy(), equations.chain.h), equations.tangents.opens.copy()
    for _ in range(5):
        z = random.normal(size=(n, 9)) * equations.units
        for side, end in enumerate(equations.ends):
            # a held angle is the end's rotation to first order only where it is met
            if end.held[3:].any():
                z[-side, PSI] = 0.0
        z[0, FORCE] = 0.0
        for a in range(1, n):
            z[a, X] = z[a - 1, X] - lever[a].T @ z[a, PSI] - lever[a - 1].T @ z[a - 1, PSI]
            z[a, X] += opens[a - 1, 0] @ z[a - 1, PSI] + opens[a - 1, 1] @ z[a, PSI] + opens[a - 1, 2] @ z[a, FORCE]
        up, down = (equations.residual(point.moved(step * z, 0.0)) for step in (1e-6, -1e-6))
        assert solver.solve((up - down) / 2e-6) / equations.units == pytest.approx(z / equations.units, abs=1e-4)


def test_a_cantilever_under_a_tip_load_is_eulers_elastica() -> None:
    errors = []
    for intervals in (10, 20, 40):
        load = PointLoad(LENGTH, (ramp(5.0 * EJ / LENGTH**2), ZERO, ZERO))
        frame = last(static(points=(load,), numerics=Numerics(intervals=intervals)))
        assert frame.parameter == pytest.approx(1.0, abs=1e-12)
        errors.append(abs(frame.r[-1, 0] / LENGTH - 0.713792))
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.1)
    assert np.log2(errors[1] / errors[2]) == pytest.approx(2.0, abs=0.1)


LOADED = {
    "weight and a tip load": {"gravity": (0.3, 0.0, 0.2), "points": (PointLoad(
        LENGTH, (ramp(3.0 * EJ), ramp(2.0 * EJ), ZERO)),)},
    "a turned clamp on an arc": {"rod": ARC_ROD, "initial": ARC, "end": turned_clamp(Condition("position", ramp(1.0)))},
    "current": {"fluid": Fluid(1000.0, 1.0, 1.0, 0.1, (0.05, 0.0, 0.02))},
}  # fmt: skip


@pytest.mark.parametrize("loads", LOADED.values(), ids=LOADED)
def test_damped_motion_comes_to_rest_at_the_equilibrium(loads: dict[str, object]) -> None:
    moving = static(analysis="dynamic", t_end=120.0, output_interval=120.0, damping=1.0, **loads)
    moved, rest = last(moving), last(static(**loads))
    assert rest.r == pytest.approx(moved.r, abs=1e-8)
    assert rest.q == pytest.approx(moved.q, abs=1e-6 * EJ)
    assert rest.f == pytest.approx(moved.f, abs=1e-6 * EJ)
    assert rest.negative_modes == 0


RISE = 0.6
"""Angle (rad) through which half an arch turns: it rises along e1 to its crown."""
ARCH_ROD = replace(ROD, kappa0=(ZERO, Curve.constant(-RISE / LENGTH), ZERO))


def half_arch(s: Array) -> Array:
    angle, radius = RISE * (1.0 - s / LENGTH), LENGTH / RISE
    return radius * np.column_stack([np.cos(angle) - np.cos(RISE), 0.0 * s, np.sin(RISE) - np.sin(angle)])


def arch(condition: Condition, t_end: float, interval: float) -> Scene:
    """Half an arch whose crown is pressed down, along e1, and does not turn."""
    crown = End(((condition,), FIXED, FIXED), (FIXED, FIXED, FIXED), frame="lab")
    return static(rod=ARCH_ROD, initial=Initial(half_arch), end=crown, t_end=t_end, output_interval=interval)


@pytest.fixture(scope="module")
def pressed() -> list[Frame]:
    """The arch under a load of EJ/L^2 times the parameter, through both folds of its snapping."""
    return list(simulate(arch(Condition("load", ramp(-10.0 * EJ / LENGTH**2, 10.0)), 10.0, 0.25)))


def test_the_branch_goes_past_both_folds_and_only_its_middle_is_unstable(pressed: list[Frame]) -> None:
    back = [frame for before, frame in pairwise(pressed) if frame.parameter < before.parameter]
    unstable = [frame.t for frame in pressed if frame.negative_modes == 1]
    assert 8 < len(back) < 15
    # the frame behind each fold may lie on either side of where the parameter was a frame before
    assert len({frame.t for frame in back} ^ set(unstable)) <= 2
    assert all(frame.negative_modes in (0, 1) for frame in pressed)
    crown = [frame.r[-1, 0] for frame in pressed]
    assert all(a > b for a, b in pairwise(crown))
    # the time that frames count is how far the parameter has travelled
    steps = np.abs(np.diff([frame.parameter for frame in pressed]))
    assert np.count_nonzero(np.abs(steps - 0.25) > 1e-4) == 2


def test_a_branch_past_folds_is_the_one_on_which_the_displacement_is_given(pressed: list[Frame]) -> None:
    held = next(iter(simulate(arch(Condition("rate"), 10.0, 0.25))))
    times, crown = [0.25 * k for k in range(len(pressed))], [f.r[-1, 0] - held.r[-1, 0] for f in pressed]
    # the arch is laid out a little off its rest, and a position is followed by its change
    driven = list(simulate(arch(Condition("position", Curve.table(times, [0.0, *crown[1:]])), 10.0, 0.25)))
    for frame, same in zip(pressed[1:], driven[1:], strict=True):
        assert same.r == pytest.approx(frame.r, abs=1e-8)
        force = rotate(same.orientation, same.f)[-1, 0]
        assert force == pytest.approx(-frame.parameter * EJ / LENGTH**2, abs=1e-6 * EJ)
        assert same.negative_modes == 0


def test_a_bent_start_is_let_go_to_where_it_has_no_stress() -> None:
    first = next(iter(simulate(static(initial=ARC))))
    assert first.t == 0.0
    assert first.kappa == pytest.approx(0.0, abs=1e-9)
    assert np.hypot(first.r[-1, 0], first.r[-1, 2]) == pytest.approx(LENGTH, abs=1e-10)


@pytest.mark.parametrize("diameter", [0.0131, 0.05, 0.2])
def test_a_bent_start_is_let_go_all_the_way(diameter: float) -> None:
    rod = Rod.circular(LENGTH, diameter, 1.25e7, 5e6, 1500.0)
    first = next(iter(simulate(static(rod=rod, initial=ARC, gravity=(-9.81, 0.0, 0.0)))))
    weight = 9.81 * 1500.0 * pi * diameter**2 / 4.0 * LENGTH
    F = rotate(first.orientation, first.f)
    assert F[-1] - F[0] == pytest.approx([weight, 0.0, 0.0], abs=1e-8 * weight)


def test_a_column_just_below_its_critical_weight_is_let_go_by_the_way_that_does_not_lead_away() -> None:
    """Forces that turn with the rod would push it aside as they hold it up: that branch goes far back, on and on."""
    mass = DENSITY * pi * DIAMETER**2 / 4.0
    down, aside = (weight * EJ / (mass * LENGTH**3) for weight in (6.8, 0.035))
    scene = static(gravity=(aside, 0.0, -down), numerics=Numerics("staggered", tolerance=1e-3))
    run = simulate(scene)
    tip = list(run)[-1].r[-1]

    def slopes(s: Array, y: Array) -> Array:
        load = mass * (LENGTH - s) / EJ
        return np.stack([y[1], -load * (aside * np.cos(y[0]) + down * np.sin(y[0])), np.sin(y[0])])

    s = np.linspace(0.0, LENGTH, 101)
    def ends(start: Array, end: Array) -> Array:
        return np.array([start[0], start[2], end[1]])

    exact = solve_bvp(slopes, ends, s, np.zeros((3, 101)), tol=1e-8).y[2, -1]
    assert tip[0] == pytest.approx(exact, rel=1e-3)
    assert run.statistics.steps < 150


def test_a_rod_between_pins_may_spin_and_still_has_its_sag() -> None:
    # the arc bulges towards -e1 + e3
    scene = static(rod=ARC_ROD, initial=ARC, start=End.pin(), end=End.pin(), gravity=(-0.3, 0.0, 0.2))
    frame = last(scene)
    weight = DENSITY * pi * DIAMETER**2 / 4.0 * 0.3 * LENGTH
    reaction = rotate(frame.orientation, frame.f)
    assert reaction[-1, 0] - reaction[0, 0] == pytest.approx(weight, rel=1e-9)
    assert frame.q[[0, -1]] == pytest.approx(0.0, abs=1e-9 * EJ)


def test_a_load_that_goes_up_and_down_leads_back() -> None:
    load = Curve.table([0.0, 0.5, 1.0], [0.0, 6.0 * EJ, 0.0])
    frames = list(simulate(static(points=(PointLoad(LENGTH, (load, ZERO, ZERO)),), output_interval=0.5)))
    assert frames[1].r[-1, 0] > 0.7 * LENGTH
    assert frames[2].r == pytest.approx(frames[0].r, abs=1e-9)


def test_a_rod_pulled_beyond_its_length_ends_by_name() -> None:
    pulled = End((FIXED, FIXED, (Condition("position", ramp(0.5)),)), (FIXED,) * 3, frame="lab")
    with pytest.raises(RunFailed) as failure:
        list(simulate(static(rod=ARC_ROD, initial=ARC, end=pulled)))
    assert failure.value.outcome == Outcome.ROD_STRETCHED
    assert 0.0 < failure.value.t <= 1.0


def test_a_branch_that_leads_back_past_the_start_ends_by_name() -> None:
    high = replace(ROD, kappa0=(ZERO, Curve.constant(-RISE / LENGTH), ZERO))
    scene = arch(Condition("load", ramp(-10.0 * EJ, 10.0)), 40.0, 0.25)
    lifted = replace(scene, rod=high, points=(PointLoad(LENGTH, constant_vector((-2.0 * EJ, 0.0, 0.0))),))
    with pytest.raises(RunFailed) as failure:
        list(simulate(lifted))
    assert failure.value.outcome == Outcome.PATH_TURNED_BACK


REFUSED = {
    "switches": End((FIXED, FIXED, (*FIXED, Condition("load", since=0.5))), (FIXED,) * 3),
    "held about all": End((FIXED,) * 3, (FIXED, FREE, FREE)),
    "lab axes": End((FIXED, FIXED, FREE), (FREE,) * 3),
}  # fmt: skip


@pytest.mark.parametrize("end", REFUSED.values(), ids=REFUSED)
def test_ends_that_do_not_say_where_they_are_are_refused(end: End, request: pytest.FixtureRequest) -> None:
    with pytest.raises(ValueError, match=request.node.callspec.id):
        simulate(static(end=end))


def test_motion_at_the_start_is_refused() -> None:
    with pytest.raises(ValueError, match="velocity"):
        static(initial=Initial.straight(velocity=(1.0, 0.0, 0.0)))


ALONG_LAB = End((FIXED, FIXED, FREE), (FIXED,) * 3, "lab")
LOOSE = {"free": (End.free(), End.free()), "along itself": (End.slider(), End.slider()),
         "a slider": (End.slider(), End.free()),
         "along e3": (ALONG_LAB, End((FREE, FREE, FREE), (FIXED,) * 3))}  # fmt: skip


@pytest.mark.parametrize("ends", LOOSE.values(), ids=LOOSE)
def test_a_rod_that_no_end_holds_in_place_is_refused(ends: tuple[End, End]) -> None:
    start, end = ends
    with pytest.raises(ValueError, match=r"neither holds it along \(-?[\d., -]+\)"):
        simulate(static(start=start, end=end))


def test_a_ring_that_no_end_holds_in_place_is_told_to_be_held_at_both() -> None:
    def ring(s: Array) -> Array:
        angle = 2.0 * np.pi * s / LENGTH
        return LENGTH / (2.0 * np.pi) * np.stack([np.sin(angle), 0.0 * s, 1.0 - np.cos(angle)], axis=1)

    with pytest.raises(ValueError, match="clamp both of them, as this is a ring"):
        simulate(static(start=End.free(), end=End.free(), initial=Initial(centreline=ring)))


def test_two_sliders_across_each_other_hold_a_rod_in_place() -> None:
    across = End((FREE, FIXED, FIXED), (FIXED,) * 3, "lab")
    assert last(static(start=ALONG_LAB, end=across)).r[-1] == pytest.approx([0.0, 0.0, LENGTH])


SMOOTH = Curve.table([0.0, 1.0], [0.0, EJ], "smoothstep")
TURNED_BY_LOADS = {
    "on a pin": static(start=End.pin(), points=(PointLoad(LENGTH, (ramp(EJ), ZERO, ZERO)),)),
    "on a pin, by little": static(start=End.pin(), points=(PointLoad(LENGTH, (ramp(1e-3 * EJ), ZERO, ZERO)),)),
    "on a pin, smoothly": static(start=End.pin(), points=(PointLoad(LENGTH, (SMOOTH, ZERO, ZERO)),)),
    "an arch between pins": static(rod=ARC_ROD, initial=ARC, start=End.pin(), end=End.pin(),
                                   points=(PointLoad(0.6 * LENGTH, (ZERO, SMOOTH, ZERO)),)),
}  # fmt: skip


@pytest.mark.parametrize("scene", TURNED_BY_LOADS.values(), ids=TURNED_BY_LOADS)
def test_a_rod_that_its_first_loads_turn_as_a_whole_rests_where_they_pull(scene: Scene) -> None:
    first, *_, last = simulate(scene)
    s, load = np.linspace(0.0, LENGTH, len(first.r)), scene.points[0]
    assert_allclose(first.r, scene.initial.centreline(s), atol=2e-3 * LENGTH)
    place = np.array([np.interp(load.s, s, axis) for axis in last.r.T])
    if scene.end == End.pin():  # about the line between both pins
        along = last.r[-1] / np.linalg.norm(last.r[-1])
        place -= (place @ along) * along
    pull = np.array([float(component.value(1.0)) for component in load.force])
    assert place @ pull == pytest.approx(np.linalg.norm(place) * np.linalg.norm(pull), rel=1e-5)
    assert last.negative_modes == 0


def test_a_rod_that_is_laid_down_level_swings_about_its_pin_until_it_hangs() -> None:
    run = simulate(static(start=End.pin(), end=End.free(), gravity=(0.0, -9.81, 0.0)))
    *_, frame = run
    assert_allclose(frame.r[-1], [0.0, -LENGTH, 0.0], atol=1e-6)
    assert (frame.negative_modes, frame.neutral_modes) == (0, 1)
    assert run.statistics.steps <= 200


@pytest.mark.parametrize("clamped", ["start", "end"])
def test_at_a_clamp_the_moment_is_the_one_that_acts_there_and_curvature_goes_with_it(clamped: str) -> None:
    force, torque = np.array([0.3, 0.1, 0.0]) * EJ, np.array([0.0, 0.0, GJ])
    at, ends = (LENGTH, (End.clamp(), End.free())) if clamped == "start" else (0.0, (End.free(), End.clamp()))
    pull = PointLoad(at, *(tuple(ramp(float(value)) for value in vector) for vector in (force, torque)))
    frame = last(static(points=(pull,), start=ends[0], end=ends[1]))
    here, there, sign = (0, -1, 1.0) if clamped == "start" else (-1, 0, -1.0)
    acting = sign * (torque + np.cross(frame.r[there] - frame.r[here], force))
    assert rotate(frame.orientation[[here]], frame.q[[here]])[0] == pytest.approx(acting, abs=1e-9 * EJ)
    assert frame.kappa[here] == pytest.approx(frame.q[here] / [EJ, EJ, GJ], abs=1e-9)


@pytest.mark.parametrize("solid", [Floor(2000.0, -0.05), Obstacle((0.5, -1.0, -0.1), (0.5, 1.0, -0.1), 0.05, 2000.0)])
def test_a_cantilever_comes_to_lie_on_a_solid_as_one_that_falls_there_does(solid: Floor | Obstacle) -> None:
    """Where a node touches, the branch turns sharply: back across the direction that it had, on the floor."""
    rod, initial = Rod.circular(1.0, 0.01, 1e7, 4e6, 1500.0), Initial.straight((0, 0, 0), (1, 0, 0), a1=(0, 1, 0))
    scene = Scene(rod, initial, End.clamp(), End.free(), 20.0, 20.0, gravity=(0.0, 0.0, -9.81), damping=10.0,
                  loads=(solid,), numerics=Numerics(method="staggered", intervals=40, dt_max=0.05))  # fmt: skip
    *_, fallen = simulate(scene)
    *_, lying = simulate(replace(scene, analysis="static", t_end=1.0, output_interval=1.0))
    assert np.abs(fallen.v).max() < 1e-6
    assert_allclose(lying.r, fallen.r, atol=1e-5)
    assert lying.negative_modes == 0


def test_an_end_that_is_swung_changes_the_linking_number_by_what_its_tangent_sweeps() -> None:
    """An arc, whose end is swung out of its plane."""
    free, swing = (FREE, FREE, FREE), (Condition("position", ramp(1.5)),)
    scene = static(rod=ARC_ROD, initial=ARC, end=End(free, (swing, FIXED, FIXED)), output_interval=0.05)
    frames = list(simulate(scene))
    assert abs(frames[-1].Lk - frames[0].Lk) > 0.1
    assert max(abs(frame.Tw + frame.Wr - frame.Lk) for frame in frames) < 1e-9


HEIGHTS, FACTORS = [-40.0, -10.0, 0.0], [0.1, 0.3, 1.0]


@pytest.mark.parametrize("heights", [[-40.0, 0.0], HEIGHTS], ids=["uniform", "sheared"])
def test_a_limp_rope_that_hangs_straight_finds_its_way_into_a_current(heights: list[float]) -> None:
    """Against a string without stiffness: (T tau)' + drag + weight = 0, from the free end, where both are in line."""
    factors = [1.0, 1.0] if len(heights) == 2 else FACTORS
    speed, weight = 1.2, (3000.0 - 1025.0) * 9.81 * pi * 0.02**2 / 4
    across, along = 0.5 * 1025.0 * 0.02 * 1.2, 0.5 * 1025.0 * pi * 0.02 * 0.02
    fluid = Fluid(1025.0, drag_normal=1.2, drag_tangential=0.02, current=(speed, 0.0, 0.0),
                  shear=Shear(Curve.table(heights, factors)))  # fmt: skip
    rope = Scene(Rod.circular(40.0, 0.02, 1e7, 4e6, 3000.0), Initial.straight(direction=(0.0, 0.0, -1.0)), End.pin(),
                 End.free(), 1.0, 1.0, fluid=fluid, gravity=(0.0, 0.0, -9.81), analysis="static",
                 numerics=Numerics(intervals=200))  # fmt: skip
    run = simulate(rope)
    *_, frame = run
    assert run.statistics.steps < 20

    def pull(z: float, angle: float) -> tuple[float, float]:
        u = speed * np.interp(z, heights, factors)
        return across * abs(u * np.cos(angle)) * u * np.cos(angle), along * abs(u * np.sin(angle)) * u * np.sin(angle)

    def rates(_s: float, y: Array) -> list[float]:
        n, t = pull(y[1], y[3])
        return [np.sin(y[3]), np.cos(y[3]), weight * np.cos(y[3]) - t, -(n + weight * np.sin(y[3])) / y[2]]

    def top(at: Array) -> Array:
        angle = brentq(lambda angle: pull(at[1], angle)[0] + weight * np.sin(angle), -1.5, 0.0)
        begin = [*at, 1e-9 * weight, angle]
        return np.asarray(solve_ivp(rates, (0.0, 40.0), begin, method="LSODA", rtol=1e-8, atol=1e-10).y[:2, -1])

    tip = fsolve(top, frame.r[-1, [0, 2]])
    assert_allclose(frame.r[-1, [0, 2]], tip, atol=1e-3 * 40.0)
    assert tip[0] > 2.0


def twisted(turned: Curve, intervals: int) -> Scene:
    """A rod under a pull that keeps it straight."""
    pull = (Condition("load", Curve.constant(500.0 * EJ)),)
    end = End((FIXED, FIXED, pull), (FIXED, FIXED, (Condition("position", turned),)))
    return static(end=end, numerics=Numerics("staggered", intervals=intervals))


@pytest.mark.parametrize("until", [1e-3, 1e-6])
def test_no_turn_of_an_end_is_missed_however_soon_it_is_there(until: float) -> None:
    frame = last(twisted(Curve.table([0.0, until], [0.0, 6.0 * pi], "smoothstep"), 16))
    assert frame.Tw == pytest.approx(3.0)
    assert frame.Lk == pytest.approx(3.0)


@pytest.mark.parametrize(("intervals", "wide"), [(3, True), (6, True), (7, False), (16, False)])
def test_a_rod_is_not_twisted_by_more_than_an_interval_can_tell(intervals: int, wide: bool) -> None:
    """By three turns: 2.7 rad in each of seven intervals."""
    run = simulate(twisted(ramp(6.0 * pi), intervals))
    if wide:
        with pytest.raises(RunFailed) as failure:
            list(run)
        assert failure.value.outcome == Outcome.MESH_TOO_COARSE
    else:
        *_, frame = run
        assert frame.Tw == pytest.approx(3.0)
