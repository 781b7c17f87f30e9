"""Torsion coupled with stretch, as in DNA and in cables whose wires lie at an angle."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from service.cases import CaseError, apply_settings, load_case, parse_case
from solver import FIXED, Condition, Curve, End, Frame, Initial, Numerics, PointLoad, Rod, Scene, simulate
from solver.arrays import Array
from solver.kernels.rotation import rotate_back
from solver.physics.elasticity import Stretch, TwistStretch, elasticity_of
from tests.solver.methods.test_staggered_tangents import check_stretch
from tests.solver.scenes import ARC_ROD, EJ, FIXED_STEPS, GJ, LENGTH, ROD, arc, energy, last, turned_clamp
from tests.solver.statics.resting import ZERO, ramp, static

EA = 4.0
G = -0.6 * float(np.sqrt(EA * GJ))
B, GJ_PULLED = G / EA, GJ - G**2 / EA


def coupled(rod: Rod = ROD, EA: float = EA, g: float = G) -> Rod:
    return replace(rod, laws=(Stretch(Curve.constant(EA)), TwistStretch(Curve.constant(g))))


def turned(frame: Frame) -> float:
    """By how much the end of a straight rod along e3 is turned about it, from a start that is not."""
    one = rotate_back(frame.orientation[[-1]], np.array([[1.0, 0.0, 0.0]]))[0]
    return float(np.arctan2(-one[1], one[0]))


@pytest.mark.parametrize("analysis", ["static", "dynamic"])
def test_a_rod_that_is_pulled_turns(analysis: str) -> None:
    pull = 0.02 * EA
    load = Curve.table([0.0, 1.0], [0.0, pull], "smoothstep")
    frame = last(static(rod=coupled(), points=(PointLoad(LENGTH, (ZERO, ZERO, load)),), analysis=analysis,
                        t_end=40.0, output_interval=40.0, damping=1.0))  # fmt: skip
    assert turned(frame) == pytest.approx(-B * pull * LENGTH / GJ_PULLED, rel=1e-6)
    assert frame.r[-1, 2] - LENGTH == pytest.approx(pull * LENGTH / (EA - G**2 / GJ), rel=1e-6)
    assert frame.energy_torsion + frame.energy_stretching == pytest.approx(0.5 * pull * (frame.r[-1, 2] - LENGTH))
    assert frame.energy_bending == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("analysis", ["static", "dynamic"])
def test_a_rod_that_is_twisted_changes_its_length(analysis: str) -> None:
    angle = Curve.table([0.0, 1.0], [0.0, 2.0], "smoothstep")
    end = replace(turned_clamp(Condition("position", angle)), translation=(FIXED, FIXED, (Condition("load"),)))
    frame = last(static(rod=coupled(), end=end, analysis=analysis, t_end=40.0, output_interval=40.0, damping=1.0))
    assert turned(frame) == pytest.approx(2.0, abs=1e-6)
    assert frame.r[-1, 2] - LENGTH == pytest.approx(-B * 2.0, rel=1e-6)
    assert_allclose(frame.strain, -B * 2.0 / LENGTH, rtol=1e-6)
    assert_allclose(frame.q[:, 2], GJ_PULLED * 2.0 / LENGTH, rtol=1e-6)


def test_its_tangents_are_derivatives() -> None:
    check_stretch(coupled(EA=3e-3, g=0.3 * float(np.sqrt(3e-3 * GJ))))


def test_energy_is_conserved_in_free_motion_the_better_the_shorter_the_steps() -> None:
    thrown, lost = Initial(arc, angular_velocity=(1.0, 2.0, 3.0)), []
    for dt in (0.004, 0.001):
        numerics = Numerics("staggered", intervals=8, dt_max=dt, increment_tolerance=FIXED_STEPS)
        scene = Scene(coupled(ARC_ROD, 20.0, 0.5 * float(np.sqrt(20.0 * GJ))), thrown, End.free(), End.free(), 0.4, 0.1,
                      numerics=numerics)  # fmt: skip
        first, *frames = simulate(scene)
        assert max(frame.energy_torsion for frame in frames) > 1e-4 * energy(first)
        lost.append(max(abs(frame.energy_balance) for frame in frames) / energy(first))
    assert lost[0] < 2e-5
    assert lost[1] < 0.02 * lost[0]


def bent(**changes: object) -> Scene:
    """A soft cantilever with a load at its tip that bends, twists and pulls it."""
    load = PointLoad(LENGTH, (ramp(3.0 * EJ), ramp(1.0 * EJ), ramp(5.0 * EJ)), (ZERO, ZERO, ramp(0.5 * GJ)))
    rod = coupled(EA=100.0 * EJ, g=0.5 * float(np.sqrt(100.0 * EJ * GJ)))
    scene = static(rod=rod, points=(load,), numerics=Numerics("staggered", intervals=20))
    return replace(scene, **changes)  # type: ignore[arg-type]


def test_damped_motion_comes_to_rest_at_the_equilibrium() -> None:
    rest, moved = last(bent()), last(bent(analysis="dynamic", t_end=60.0, output_interval=60.0, damping=1.0))
    uncoupled = last(bent(rod=coupled(EA=100.0 * EJ, g=0.0)))
    assert np.abs(rest.r - uncoupled.r).max() > 0.005 * LENGTH
    assert rest.r == pytest.approx(moved.r, abs=1e-8)
    assert rest.q == pytest.approx(moved.q, abs=1e-6 * EJ)
    assert rest.strain == pytest.approx(moved.strain, abs=1e-8)


def test_the_error_falls_with_the_square_of_the_interval() -> None:
    tips: list[Array] = [last(bent(numerics=Numerics("staggered", intervals=n))).r[-1] for n in (10, 20, 40)]
    assert np.log2(np.linalg.norm(tips[0] - tips[1]) / np.linalg.norm(tips[1] - tips[2])) == pytest.approx(2.0, abs=0.1)


def test_what_is_no_coupling_is_refused() -> None:
    s = np.array([0.0])
    with pytest.raises(ValueError, match=r"g, the coupling of torsion and stretch, must be 0 N m for a rod without EA"):
        elasticity_of(replace(ROD, laws=(TwistStretch(Curve.constant(G)),)), s)
    with pytest.raises(ValueError, match=r"must be between -sqrt\(EA GJ\) and sqrt\(EA GJ\) = .* N m, got 1\.0"):
        elasticity_of(coupled(g=1.0), s)
    raw = apply_settings(load_case("free-flight"), {"rod.twist_stretch_coupling": 1e-3})
    with pytest.raises(CaseError, match=r"/rod/twist_stretch_coupling must be 0 without axial_stiffness.*got 0\.001"):
        parse_case(raw)


def test_a_case_says_it() -> None:
    rod = {"rod.axial_stiffness": 30.0, "rod.twist_stretch_coupling": -1e-3}
    numerics = {"method": "staggered", "intervals": 20, "dt_max": 0.1}
    built = parse_case({**apply_settings(load_case("free-flight"), rod), "numerics": numerics}).rod.build()
    elastic = elasticity_of(built, np.zeros(1))
    assert elastic.by_tension == pytest.approx(-1e-3 / 30.0)
    assert elastic.K[0, 2, 2] == pytest.approx(float(built.stiffness[2](np.zeros(1))[0]) - 1e-6 / 30.0)
