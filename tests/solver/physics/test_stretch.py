"""A rod with a law of stretch: bars, cables and columns of textbooks, energy, and what does not take it."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from math import asinh, pi, sqrt

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.interpolate import CubicSpline
from scipy.optimize import brentq

from service.cases import CaseError, apply_settings, load_case, parse_case
from solver import (
    FIXED,
    Condition,
    Contact,
    Curve,
    End,
    Frame,
    Initial,
    Numerics,
    Outcome,
    PointLoad,
    Rod,
    RunFailed,
    Scene,
    constant_vector,
    simulate,
)
from solver.arrays import Array
from solver.methods.registry import discretized
from solver.physics.axial import axial_compliance
from solver.physics.elasticity import Stretch, elasticity_of
from solver.run.equilibria import Equilibria
from solver.run.verify import VerifiedFrame
from tests.solver.scenes import ARC_ROD, EJ, FIXED_STEPS, LENGTH, MASS, ROD, arc, energy, last
from tests.solver.statics.resting import ZERO, ramp, static

G = 9.81
WEIGHT = MASS * G * LENGTH
EA = 50.0 * WEIGHT


def elastic(stiffness: float, rod: Rod = ROD) -> Rod:
    return replace(rod, laws=(Stretch(Curve.constant(stiffness)),))


def hanging(**changes: object) -> Scene:
    """A rod below a clamp, which its weight begins to lengthen at t = 0."""
    scene = Scene(elastic(EA), Initial.straight(), End.clamp(), End.free(), 2.0, 2.0, gravity=(0.0, 0.0, G),
                  damping=50.0, numerics=Numerics("staggered", intervals=10, dt_max=0.05))  # fmt: skip
    return replace(scene, **changes)  # type: ignore[arg-type]


@pytest.mark.parametrize("analysis", ["dynamic", "static"])
def test_a_hanging_rod_lengthens_by_its_weight(analysis: str) -> None:
    frame = last(hanging(analysis=analysis))
    s = np.linspace(0.0, LENGTH, 11)
    along = s + WEIGHT / EA * (s - 0.5 * s**2 / LENGTH)
    assert frame.r[-1, 2] - LENGTH == pytest.approx(0.5 * WEIGHT * LENGTH / EA, rel=1e-6)
    assert_allclose(frame.r[:, 2], along, atol=1e-3 * WEIGHT / EA)
    assert_allclose(frame.strain, WEIGHT / EA * (1.0 - s / LENGTH), atol=1e-6 * WEIGHT / EA)
    assert_allclose(frame.f[:, 2], EA * frame.strain, atol=1e-6 * WEIGHT)
    assert frame.energy_stretching == pytest.approx(WEIGHT**2 * LENGTH / (6.0 * EA), rel=1e-2)


@pytest.mark.parametrize("analysis", ["dynamic", "static"])
def test_a_bungee_cord_is_several_times_as_long_and_says_so(analysis: str) -> None:
    """Its weight makes it three times as long; the law is linear, so the hanging rod's formulas hold."""
    run = simulate(hanging(analysis=analysis, rod=elastic(WEIGHT / 4.0)))
    *_, frame = run
    assert frame.r[-1, 2] == pytest.approx(3.0 * LENGTH, rel=1e-6)
    assert_allclose(frame.strain, 4.0 * np.linspace(1.0, 0.0, 11), atol=1e-6)
    assert run.attributes()["largest_strain"] == pytest.approx(frame.strain.max(), abs=0.3)
    assert "by a factor of up to" in run.notes()[-1]


@pytest.mark.parametrize(("scene", "factor"), [
    (hanging(rod=elastic(WEIGHT / 4.5)), "5.5"),
    (hanging(rod=elastic(WEIGHT), contact=Contact()), "2"),
])  # fmt: skip
def test_a_rod_that_is_stretched_too_far_ends_by_name(scene: Scene, factor: str) -> None:
    with pytest.raises(RunFailed, match=f"by a factor of {factor}") as failure:
        list(simulate(scene))
    assert failure.value.outcome is Outcome.ROD_STRETCHED


def test_a_hanging_rod_hangs_from_the_start_on() -> None:
    first, *frames = simulate(hanging(damping=0.0, output_interval=0.5))
    assert first.r[-1, 2] - LENGTH == pytest.approx(0.5 * WEIGHT * LENGTH / EA, rel=1e-6)
    for frame in frames:
        assert_allclose(frame.r, first.r, atol=1e-9)
        assert abs(frame.energy_balance) < 1e-6 * first.energy_stretching


def test_a_rod_whose_end_is_jerked_has_to_be_stretched_first() -> None:
    """It was as long at once as if it bore the acceleration of a body at its other end. Until sound has come there and
    back the end bears the impedance of the rod times its speed."""
    impedance, speed = sqrt(EA * MASS), 1e-3 * sqrt(EA / MASS)
    pulled = Condition("rate", Curve.table([0.0, 1e-4], [0.0, -speed]))
    way = LENGTH / sqrt(EA / MASS)
    start = End((FIXED, FIXED, (pulled,)), End.clamp().rotation)
    end = replace(End.free(), mass=20.0 * MASS * LENGTH)
    scene = Scene(elastic(EA), Initial.straight(), start, end, way, 0.5 * way,
                  numerics=Numerics("staggered", intervals=64, dt_max=0.01 * way))  # fmt: skip
    first, middle, _ = simulate(scene)
    assert np.abs(first.strain).max() == 0.0
    assert middle.f[0, 2] == pytest.approx(impedance * speed, rel=0.05)
    assert abs(middle.f[-1, 2]) < 0.02 * impedance * speed


@pytest.mark.parametrize("held", ["the end", "neither"])
def test_what_is_not_held_is_where_the_stretch_brings_it(held: str) -> None:
    """The rod hangs from its end, or flies with its middle pulled apart by a load at either end."""
    ends = (End.free(), End.clamp()) if held == "the end" else (End.free(), End.free())
    pulls = constant_vector((0.0, 0.0, -WEIGHT)), constant_vector((0.0, 0.0, WEIGHT))
    points = () if held == "the end" else (PointLoad(0.0, pulls[0]), PointLoad(LENGTH, pulls[1]))
    gravity = (0.0, 0.0, -G) if held == "the end" else (0.0, 0.0, 0.0)
    first, frame = simulate(hanging(start=ends[0], end=ends[1], gravity=gravity, points=points, damping=0.0,
                                    t_end=0.1, output_interval=0.1))  # fmt: skip
    longer = WEIGHT * LENGTH / EA
    expected = [-0.5 * longer, 0.0] if held == "the end" else [-0.5 * longer, 0.5 * longer]
    assert first.r[[0, -1], 2] - [0.0, LENGTH] == pytest.approx(expected, abs=1e-6 * longer)
    assert_allclose(frame.r, first.r, atol=1e-9)


def test_a_bar_that_is_let_go_swings_with_the_period_of_its_sound() -> None:
    """4 L / c, to and fro at the velocity of its sound: it is let go at .055 of the period, in the middle of a ramp."""
    period, pull = 4.0 * LENGTH / sqrt(EA / MASS), 0.01 * EA
    load = Curve.table([0.0, 0.01 * period, 0.1 * period], [pull, pull, 0.0], "smoothstep")
    numerics = Numerics("staggered", intervals=20, dt_max=period / 400, increment_tolerance=FIXED_STEPS)
    frames = list(simulate(hanging(t_end=2.5 * period, output_interval=0.25 * period, damping=0.0, numerics=numerics,
                                   gravity=(0.0, 0.0, 0.0), points=(PointLoad(LENGTH, (ZERO, ZERO, load)),))))
    longer = np.array([frame.r[-1, 2] - LENGTH for frame in frames]) / (0.01 * LENGTH)
    assert longer[0] == pytest.approx(1.0, rel=1e-6)
    at_quarters = 1.0 - 4.0 * (0.25 - 0.055)
    assert longer[1::2] * [1.0, -1.0, 1.0, -1.0, 1.0] == pytest.approx(at_quarters, abs=4e-3)
    balance = [frame.energy_balance for frame in frames]
    assert max(balance) - min(balance) < 1e-6 * frames[0].energy_stretching


def test_sound_that_nobody_follows_costs_no_steps() -> None:
    """A rod that swings and is so stiff that its sound is a thousand times as fast."""
    swinging = hanging(gravity=(0.3 * G, 0.1 * G, G), damping=1.0)
    rigid, stiff = (simulate(replace(swinging, rod=rod)) for rod in (ROD, elastic(1e5 * WEIGHT)))
    *_, one = rigid
    *_, other = stiff
    assert stiff.statistics.newton_iterations < 1.1 * rigid.statistics.newton_iterations
    assert_allclose(other.r, one.r, atol=1e-4 * LENGTH)


@cache
def in_free_motion(dt: float) -> tuple[Frame, ...]:
    numerics = Numerics("staggered", intervals=8, dt_max=dt, increment_tolerance=FIXED_STEPS)
    thrown = Initial(arc, angular_velocity=(1.0, 2.0, 3.0))
    scene = Scene(elastic(20.0, ARC_ROD), thrown, End.free(), End.free(), 0.4, 0.1, numerics=numerics)
    return tuple(simulate(scene))


def test_energy_is_conserved_in_free_motion_the_better_the_shorter_the_steps() -> None:
    lost = []
    for dt in (0.004, 0.001):
        first, *frames = in_free_motion(dt)
        assert max(frame.energy_stretching for frame in frames) > 0.004 * energy(first)
        lost.append(max(abs(frame.energy_balance) for frame in frames) / energy(first))
    assert lost[0] < 1e-8
    assert lost[1] < 0.2 * lost[0]


def pulled(**changes: object) -> Scene:
    """A soft cantilever, with a tip load across and along it."""
    load = PointLoad(LENGTH, (ramp(5.0 * EJ), ramp(1.0 * EJ), ramp(4.0 * EJ)))
    return static(rod=elastic(100.0 * EJ), points=(load,), numerics=Numerics("staggered", intervals=20), **changes)


def test_the_error_falls_with_the_square_of_the_interval() -> None:
    tips = [last(replace(pulled(), numerics=Numerics("staggered", intervals=n))).r[-1] for n in (10, 20, 40)]
    assert np.log2(np.linalg.norm(tips[0] - tips[1]) / np.linalg.norm(tips[1] - tips[2])) == pytest.approx(2.0, abs=0.1)


def test_damped_motion_comes_to_rest_at_the_equilibrium() -> None:
    rest, moved = last(pulled()), last(pulled(analysis="dynamic", t_end=60.0, output_interval=60.0, damping=1.0))
    assert rest.strain.max() > 0.05
    assert rest.r == pytest.approx(moved.r, abs=1e-8)
    assert rest.f == pytest.approx(moved.f, abs=1e-6 * EJ)
    assert rest.q == pytest.approx(moved.q, abs=1e-6 * EJ)
    assert rest.energy_stretching == pytest.approx(moved.energy_stretching, rel=1e-6)
    assert rest.negative_modes == 0


SPAN, LIMP = 0.95 * LENGTH, 1e-6 * WEIGHT


def catenary(stiffness: float, s: Array) -> tuple[Array, Array]:
    """Irvine, Cable Structures (1981), 1.4: (x, z) and the tension of a cable between supports at one height."""

    def reach(H: float) -> float:
        return H * LENGTH / stiffness + 2.0 * H * LENGTH / WEIGHT * asinh(0.5 * WEIGHT / H)

    H = brentq(lambda H: reach(H) - SPAN, 1e-3 * WEIGHT, 1e3 * WEIGHT)
    V, down = 0.5 * WEIGHT, 0.5 * WEIGHT - WEIGHT * s / LENGTH
    x = H * s / stiffness + H * LENGTH / WEIGHT * (np.arcsinh(V / H) - np.arcsinh(down / H))
    z = (V * s - 0.5 * WEIGHT * s**2 / LENGTH) / stiffness
    z += H * LENGTH / WEIGHT * (np.hypot(1.0, V / H) - np.hypot(1.0, down / H))
    return np.stack([x, -z], axis=1), np.hypot(H, down)


def test_a_cable_between_pins_is_the_extensible_catenary() -> None:
    s, stiffness = np.linspace(0.0, LENGTH, 41), 20.0 * WEIGHT
    rigid, (taut, tension) = catenary(1e9 * WEIGHT, s)[0], catenary(stiffness, s)
    initial = Initial(CubicSpline(s, rigid @ [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]), a1=(0.0, 1.0, 0.0))
    rod = replace(elastic(stiffness), stiffness=(Curve.constant(LIMP),) * 3)
    frame = last(static(rod=rod, initial=initial, start=End.pin(), end=End.pin(), gravity=(0.0, 0.0, -G),
                        numerics=Numerics("staggered", intervals=40)))  # fmt: skip
    assert np.abs(taut - rigid).max() > 0.04 * LENGTH
    assert_allclose(frame.r[:, [0, 2]], taut, atol=5e-5 * LENGTH)
    assert_allclose(frame.strain[1:-1], tension[1:-1] / stiffness, rtol=1e-3)


def test_a_column_between_clamps_is_unstable_from_its_load_on() -> None:
    """P (1 - P / EA) = 4 pi^2 EJ / L^2: pressed shorter, it bears more."""
    soft = 600.0 * EJ
    load = brentq(lambda P: P * (1.0 - P / soft) - 4.0 * pi**2 * EJ, 0.0, 0.5 * soft)
    pressed = End((FIXED, FIXED, (Condition("position", ramp(-1.1 * load / soft)),)), (FIXED,) * 3, frame="lab")
    # without a seed, so that it stays straight
    frames = Equilibria(static(rod=elastic(soft), end=pressed, output_interval=0.005,
                               numerics=Numerics("staggered", intervals=32)))  # fmt: skip
    first = next(frame for frame in frames if frame.negative_modes > 0)
    assert -first.f[0, 2] == pytest.approx(load, rel=8e-3)
    assert load > 1.07 * 4.0 * pi**2 * EJ


def test_a_bar_between_clamps_bears_its_own_law() -> None:
    apart = End((FIXED, FIXED, (Condition("position", ramp(0.02)),)), (FIXED,) * 3, frame="lab")
    run = simulate(static(rod=elastic(EA), end=apart))
    *_, frame = run
    assert_allclose(frame.f[:, 2], 0.02 * EA)
    assert_allclose(frame.strain, 0.02)
    assert axial_compliance(static(rod=elastic(EA), end=apart)) == 0.0
    assert "axial_stiffness" not in run.attributes()


def test_strands_of_a_stiff_rod_press_as_those_of_one_that_cannot_stretch() -> None:
    from tests.solver.run.test_checkpoint import staggered_pressed

    scene = replace(staggered_pressed(), t_end=0.3)
    stiff = replace(scene, rod=elastic(1e6 * EJ / LENGTH**2, scene.rod))
    one, other = last(scene), last(stiff)
    assert other.contacts == one.contacts > 0
    assert_allclose(other.r, one.r, atol=1e-4)
    assert np.abs(other.strain).max() > 0.0
    assert abs(other.energy_balance) < 2.0 * abs(one.energy_balance) + 1e-9


def test_a_rod_that_can_stretch_is_never_taken_for_another_one() -> None:
    scene = hanging()
    assert type(discretized(scene)).__name__ == "StaggeredMethod"
    assert type(discretized(replace(scene, rod=ROD))).__name__ == "OneAxisMethod"
    with pytest.raises(ValueError, match='method must be "staggered" for a rod that can stretch, got "box"'):
        simulate(replace(scene, numerics=Numerics("box", intervals=10)))


def test_a_stiffness_that_is_none_is_refused() -> None:
    with pytest.raises(ValueError, match=r"EA must be > 0 N everywhere along the rod, got 0\.0"):
        elasticity_of(elastic(0.0), np.array([0.0]))


@pytest.mark.parametrize("numerics", [Numerics("staggered", intervals=10, dt_max=0.05, verify=True),
                                      Numerics("staggered", tolerance=1e-2)])  # fmt: skip
def test_errors_of_energy_and_tension_are_at_least_those_of_sound_that_nobody_followed(numerics: Numerics) -> None:
    frame = last(hanging(rod=elastic(1e6 * WEIGHT), gravity=(0.3 * G, 0.0, G), damping=0.5, t_end=1.0,
                         output_interval=0.5, numerics=numerics))  # fmt: skip
    assert isinstance(frame, VerifiedFrame)
    assert frame.error.energy_stretching > 0.0
    assert frame.error.energy_stretching >= frame.error.energy_torsion  # which there is none of
    assert (frame.error.f[:, 2] > 0.0).all()


def test_a_case_says_how_stiff_it_is() -> None:
    raw = apply_settings(load_case("free-flight"), {"rod.axial_stiffness": 30.0})
    given = {"method": "staggered", "intervals": 20, "dt_max": 0.1}
    assert parse_case({**raw, "numerics": given}).rod.build().laws[0].EA(np.zeros(1)) == 30.0  # type: ignore[attr-defined]
    for named in ({"method": "box"}, {"rho_inf": 0.9}):
        with pytest.raises(CaseError, match=r"/method must be staggered for a rod that can stretch.*got 'box'"):
            parse_case({**raw, "numerics": {"intervals": 20, **named}})
    with pytest.raises(CaseError, match=r"/rod/axial_stiffness must be > 0, got 0\.0"):
        parse_case(apply_settings(raw, {"rod.axial_stiffness": 0.0}))


def test_a_rod_that_cannot_stretch_has_no_strain() -> None:
    frame = last(replace(hanging(), rod=ROD))
    assert frame.energy_stretching == 0.0
    assert (frame.strain == 0.0).all()
