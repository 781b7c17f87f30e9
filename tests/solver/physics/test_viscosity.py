"""A material that resists its own bending and twisting, as Kelvin and Voigt have it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from service.cases import CaseError, apply_settings, build_scene, load_case, parse_case
from solver import FREE, Condition, Curve, End, Frame, Initial, Numerics, Scene, simulate
from solver.methods.registry import discretized
from solver.methods.space.segments.viscosity import resist_rates
from solver.physics.elasticity import Viscosity
from tests.solver.methods.as_in_runs import call
from tests.solver.methods.test_staggered_tangents import STAGE, N
from tests.solver.methods.test_staggered_tangents import problem as staggered_problem
from tests.solver.scenes import EJ, GJ, LENGTH, MASS, ROD, SPIN_INERTIA, fixed_steps, last

TAU = 0.1
VISCOUS = replace(ROD, laws=(Viscosity(Curve.constant(TAU)),))
STEPS = replace(fixed_steps(40, 0.005), method="staggered", increment_tolerance=1e-4)


def ringing(**changes: object) -> Scene:
    """A cantilever, let go as a part of a circle in its plane."""
    circle = Initial(lambda s: np.stack([(1 - np.cos(0.1 * s)) / 0.1, 0.0 * s, np.sin(0.1 * s) / 0.1], axis=1))
    scene = Scene(VISCOUS, circle, End.clamp(), End.free(), 6.0, 0.01, numerics=STEPS)
    return replace(scene, **changes)  # type: ignore[arg-type]


def decay(frames: list[Frame], values: list[float], frequency: float) -> float:
    """By how much a vibration falls in a second, as log of the ratio of its largest values a period apart."""
    period = 2.0 * np.pi / frequency
    t, x = np.array([frame.t for frame in frames]), np.array(values)
    early, late = (np.abs(x[(t >= start) & (t < start + period)]).max() for start in (period, 3.0 * period))
    return float(np.log(early / late) / (2.0 * period))


def test_bending_waves_decay_as_their_frequency_says() -> None:
    """A mode of frequency w falls as exp(- tau w^2 t / 2)."""
    frequency = 3.516 * np.sqrt(EJ / MASS) / LENGTH**2
    frames = list(simulate(ringing(t_end=30.0, output_interval=0.1, numerics=replace(STEPS, dt_max=0.1))))
    moved = [float(frame.r[-1, 0]) for frame in frames]
    assert decay(frames, moved, frequency) == pytest.approx(0.5 * TAU * frequency**2, rel=0.05)


def test_torsional_waves_decay_as_their_frequency_says() -> None:
    """A rod that a moment has twisted is let go: its first mode has the frequency (pi / 2 L) sqrt(GJ / I)."""
    frequency = 0.5 * np.pi / LENGTH * np.sqrt(GJ / SPIN_INERTIA)
    tau = 0.02 / frequency
    pulse = Curve.table([0.0, 0.2 / frequency, 0.4 / frequency], [0.0, 0.01 * GJ, 0.0], "smoothstep")
    end = End((FREE, FREE, FREE), (FREE, FREE, (Condition("load", pulse),)))
    scene = Scene(replace(ROD, laws=(Viscosity(Curve.constant(tau)),)), Initial.straight(), End.clamp(), end,
                  40.0 / frequency, 0.05 / frequency, numerics=replace(STEPS, dt_max=0.05 / frequency))  # fmt: skip
    frames = list(simulate(scene))
    mode = np.sin(0.5 * np.pi * np.linspace(0.0, 1.0, 41))
    turned = [float(frame.orientation[:, 3] @ mode) for frame in frames]
    assert decay(frames, turned, frequency) == pytest.approx(0.5 * tau * frequency**2, rel=0.05)


@pytest.mark.parametrize("gravity", [(0.0, 0.0, 0.0), (0.0, 1.0, 0.0)])
def test_what_it_takes_is_dissipated(gravity: tuple[float, float, float]) -> None:
    """In a plane and out of it."""
    frames = list(simulate(ringing(gravity=gravity, t_end=1.0)))
    assert frames[-1].dissipation > 1e-3 * frames[0].energy_bending
    assert max(abs(frame.energy_balance) for frame in frames) < 1e-7 * frames[-1].dissipation


def test_in_a_plane_it_turns_about_one_axis_and_does_the_same() -> None:
    plane, space = ringing(t_end=0.5), ringing(t_end=0.5, gravity=(0.0, 1e-9, 0.0))
    assert [type(discretized(scene)).__name__ for scene in (plane, space)] == ["OneAxisMethod", "StaggeredMethod"]
    one, other = last(plane), last(space)
    for name in ("r", "q", "kappa", "v"):
        size = np.abs(getattr(other, name)).max()
        assert_allclose(getattr(one, name), getattr(other, name), atol=1e-5 * size)
    assert one.dissipation == pytest.approx(other.dissipation, rel=1e-5)


def test_its_tangents_by_rates_are_derivatives() -> None:
    method = staggered_problem("nothing else", "free", rod=VISCOUS).method
    bend, tangents = method.stages.bend[STAGE], method.work.tangents
    for a in range(N + 2):
        for axis in range(3):
            omega, (moment, left, right) = np.zeros((N + 2, 3)), np.zeros((3, N + 1, 3))
            omega[a, axis] = 1.0
            call(resist_rates, method.chain, omega, bend, moment, left, right)
            found = np.concatenate([np.zeros((1, 3)), right]) - np.concatenate([left, np.zeros((1, 3))])
            expected = np.zeros((N + 2, 3))
            expected[a] = tangents.stiff_t[a, :, axis]
            if a > 0:
                expected[a - 1] = tangents.behind_t[a - 1, :, axis]
            if a <= N:
                expected[a + 1] = tangents.before_t[a + 1, :, axis]
            assert np.abs(found - expected).max() <= 1e-7 * np.abs(tangents.stiff_t).max()


def test_it_is_refused_where_it_is_not_known() -> None:
    with pytest.raises(ValueError, match="resists the rates of bending"):
        last(ringing(numerics=Numerics(method="box")))
    raw = apply_settings(load_case("free-flight"), {"rod.retardation_time": 0.1})
    (law,) = build_scene(parse_case(apply_settings(raw, {"numerics": {}}))).rod.laws
    assert isinstance(law, Viscosity)
    with pytest.raises(CaseError, match="must be staggered for a rod that resists its own bending"):
        parse_case(apply_settings(raw, {"numerics": {"method": "box"}}))
