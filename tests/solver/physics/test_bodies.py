"""A body at an end of the rod: pendulums, springs, cantilevers and tethers with a mass, against closed forms."""

from __future__ import annotations

from dataclasses import replace
from math import cos, cosh, pi, sin, sinh, sqrt

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.optimize import brentq

from solver import Condition, Curve, End, Frame, Initial, Numerics, Rod, Scene, simulate
from solver.arrays import Array
from solver.methods.one_axis import OneAxisMethod
from solver.physics.elasticity import Stretch
from solver.scene.ends import FIXED, FREE
from tests.solver.scenes import EJ, LENGTH, ROD, last

MASS = float(ROD.mass(0.0)) * LENGTH
G = 9.81
FIXED_STEPS = Numerics("staggered", intervals=20, dt_max=0.05)


def with_body(mass: float, frame: str = "lab") -> End:
    return End((FREE,) * 3, (FREE,) * 3, frame, mass)  # type: ignore[arg-type]


def period(t: Array, x: Array) -> float:
    """The mean of a swing's periods."""
    down = np.flatnonzero((x[:-1] > 0.0) & (x[1:] <= 0.0))
    zeros = t[down] - x[down] * (t[down + 1] - t[down]) / (x[down + 1] - x[down])
    return float(np.mean(np.diff(zeros)))


@pytest.mark.parametrize("frame", ["lab", "material"])
@pytest.mark.parametrize("side", ["start", "end"])
@pytest.mark.parametrize("numerics", [FIXED_STEPS, Numerics("staggered", tolerance=1e-3, most_intervals=64)])
def test_a_heavy_bob_swings_as_a_pendulum(side: str, frame: str, numerics: Numerics) -> None:
    """T = 2 pi sqrt(I / (L g (M + m/2))) (1 + a^2/16), I = (M + m/3) L^2, where its weight keeps the rod straight."""
    M, angle = 100.0 * MASS, 0.1
    down = np.array([sin(angle), 0.0, -cos(angle)])
    ends = (End.pin(), with_body(M, frame))
    start, end = ends if side == "end" else ends[::-1]
    hung = Initial.straight(direction=tuple(down if side == "end" else -down))
    frames = list(simulate(Scene(ROD, hung, start, end, 2.7, 0.05, gravity=(0.0, 0.0, -G), numerics=numerics)))
    at, pin = (-1, 0) if side == "end" else (0, -1)
    swing = np.array([frame.r[at, 0] - frame.r[pin, 0] for frame in frames])
    exact = 2.0 * pi * sqrt(LENGTH * (M + MASS / 3.0) / (G * (M + MASS / 2.0))) * (1.0 + angle**2 / 16.0)
    assert period(np.array([frame.t for frame in frames]), swing) == pytest.approx(exact, rel=2e-4)
    assert abs(frames[-1].energy_balance) < 1e-5 * M * G * LENGTH * (1.0 - cos(angle))


@pytest.mark.parametrize("ratio", [0.2, 1.0, 5.0])
def test_a_cantilever_with_a_body_at_its_tip_vibrates_at_its_frequency(ratio: float) -> None:
    """1 + cos b cosh b + (M/m) b (cos b sinh b - sin b cosh b) = 0, omega = b^2 sqrt(EJ/m) / L^2."""
    b = brentq(lambda b: 1.0 + cos(b) * cosh(b) + ratio * b * (cos(b) * sinh(b) - sin(b) * cosh(b)), 0.1, 1.88)
    exact = 2.0 * pi / (b**2 * sqrt(EJ * LENGTH / MASS) / LENGTH**2)
    s = np.linspace(0.0, LENGTH, 41)
    bent = Initial.through(np.stack([1e-3 * s**2 * (3.0 * LENGTH - s), 0.0 * s, s], axis=1), LENGTH)
    scene = Scene(ROD, bent, End.clamp(), with_body(ratio * MASS), 6.0 * exact,
                  exact / 40.0, numerics=Numerics("staggered", intervals=20, dt_max=exact / 40.0))  # fmt: skip
    frames = list(simulate(scene))
    tip = np.array([frame.r[-1, 0] for frame in frames])
    assert period(np.array([frame.t for frame in frames]), tip) == pytest.approx(exact, rel=2e-3)


def elastic(EA: float) -> Scene:
    """A rod that can stretch, and hangs from a pin."""
    rod = replace(ROD, laws=(Stretch(Curve.constant(EA)),))
    return Scene(rod, Initial.straight(direction=(0.0, 0.0, -1.0)), End.pin(), End.free(), 1.0, 1.0,
                 gravity=(0.0, 0.0, -G), numerics=FIXED_STEPS)  # fmt: skip


def test_at_rest_its_weight_stretches_the_rod() -> None:
    """By (M + m/2) g L / EA."""
    M, EA = 10.0 * MASS, 1e3 * MASS * G
    frame: Frame = last(replace(elastic(EA), end=with_body(M), analysis="static"))
    assert -frame.r[-1, 2] - LENGTH == pytest.approx((M + MASS / 2.0) * G * LENGTH / EA, rel=1e-6)
    assert frame.f[0, 2] == pytest.approx((M + MASS) * G, rel=1e-6)


@pytest.mark.parametrize("frame", ["lab", "material"])
def test_on_a_rod_that_stretches_it_bounces_as_on_a_spring(frame: str) -> None:
    """omega = sqrt(EA/L / (M + m/3)), about where it hangs at rest. It falls from where the rod has no stretch."""
    M, EA = 100.0 * MASS, 1e3 * MASS * G
    cycle = 2.0 * pi / sqrt(EA / LENGTH / (M + MASS / 3.0))
    held = (Condition("rate"), Condition("load", Curve.constant(0.0), since=0.1 * cycle))
    body = End((held,) * 3, (FREE,) * 3, frame, M)  # type: ignore[arg-type]
    scene = replace(elastic(EA), end=body, t_end=4.1 * cycle, output_interval=0.02 * cycle)
    frames = list(simulate(scene))
    fallen = np.array([f.r[-1, 2] for f in frames[5:]])
    assert period(np.array([f.t for f in frames[5:]]), fallen - fallen.mean()) == pytest.approx(cycle, rel=5e-3)
    assert -np.ptp(fallen) == pytest.approx(-2.0 * M * G * LENGTH / EA, rel=0.02)


LIMP = Rod.circular(2.8, 0.0098, 1e7, 1e7, 836.0)


def bow(s: Array) -> Array:
    """A half circle below e1."""
    radius = float(LIMP.length) / pi
    return np.stack([radius * np.sin(s / radius), 0.0 * s, radius * (np.cos(s / radius) - 1.0)], axis=1)


@pytest.mark.parametrize(("mass", "intervals"), [(0.1, 16), (1.0, 16), (1.0, 64), (80.0, 16)])
def test_on_a_bent_rope_that_stretches_it_begins_to_move(mass: float, intervals: int) -> None:
    """Steps that find the first forces began without any, which the stretch there is would not let jump."""
    rope = replace(LIMP, laws=(Stretch(Curve.constant(25000.0)),))
    scene = Scene(rope, Initial(bow), End.pin(), with_body(mass, "material"), 0.02, 0.02, gravity=(0.0, 0.0, -G),
                  numerics=Numerics("staggered", intervals=intervals, dt_max=0.01))  # fmt: skip
    first, frame = simulate(scene)
    assert frame.r[-1, 2] - first.r[-1, 2] == pytest.approx(-0.5 * G * 0.02**2, rel=0.1)  # the rope hangs on it


def test_caught_by_a_limp_rope_it_gives_the_rope_what_it_loses() -> None:
    """Its energy and the work on the rope's end: a fifth of its largest motion was lost where Newton's iteration ended
    as soon as the rope's rotations and forces were good enough."""
    rope, mass = replace(LIMP, laws=(Stretch(Curve.constant(25000.0)),)), 80.0
    scene = Scene(rope, Initial(bow), End.pin(), with_body(mass, "material"), 1.4, 0.02, gravity=(0.0, 0.0, -G),
                  numerics=Numerics("staggered", intervals=16, dt_max=0.01, increment_tolerance=0.1))  # fmt: skip
    frames = list(simulate(scene))
    motion = np.array([0.5 * mass * np.sum(frame.v[-1] ** 2) for frame in frames])
    energy = motion + [mass * G * frame.r[-1, 2] + frame.work_ends for frame in frames]
    assert np.abs(energy - energy[0]).max() < 0.12 * motion.max()


def test_two_bodies_that_turn_about_each_other_keep_the_rod_taut() -> None:
    """f3 = omega^2 (M L/2 + m L/8) in its middle, and nothing slows them down."""
    M, omega = 10.0 * MASS, 2.0
    spun = replace(Initial.straight(direction=(1.0, 0.0, 0.0)), angular_velocity=(0.0, 0.0, omega))
    frame = last(Scene(ROD, spun, with_body(M), with_body(M), 10.0, 1.0, numerics=FIXED_STEPS))
    assert frame.f[10, 2] == pytest.approx(omega**2 * (M * LENGTH / 2.0 + MASS * LENGTH / 8.0), rel=1e-4)
    assert_allclose(frame.omega[:, :], [[0.0, omega, 0.0]] * 21, atol=1e-4 * omega)
    assert_allclose(frame.r.mean(axis=0), [LENGTH / 2.0, 0.0, 0.0], atol=1e-5 * LENGTH)


def test_bodies_on_a_rod_that_stretches_turn_about_the_centre_of_mass_of_all() -> None:
    """By far the heavier one hardly moves, though the rod is stretched by a hundredth from the start on."""
    bodies, spin, speed = (50.0 * MASS, 10.0 * MASS), 2.0, 0.7
    all_of_it = MASS + sum(bodies)
    arm = (0.5 * MASS + bodies[1]) / all_of_it * LENGTH
    pull = bodies[0] * spin**2 * arm
    whirled = Initial.straight(velocity=(speed, spin * (arm - 0.5 * LENGTH), 0.0), angular_velocity=(spin, 0.0, 0.0))
    scene = Scene(replace(ROD, laws=(Stretch(Curve.constant(100.0 * pull)),)), whirled,
                  with_body(bodies[0]), with_body(bodies[1]), 6.0, 0.05, numerics=FIXED_STEPS)  # fmt: skip
    for frame in simulate(scene):
        rods = np.average(0.5 * (frame.r[1:] + frame.r[:-1]), axis=0)
        centre = (MASS * rods + bodies[0] * frame.r[0] + bodies[1] * frame.r[-1]) / all_of_it
        assert_allclose(centre, [speed * frame.t, 0.0, arm], atol=1e-5 * LENGTH)


def test_on_a_rail_it_moves_along_the_rail_alone() -> None:
    """A body that a constant force pulls along e1, its rod straight behind it: a = f / (M + m)."""
    M, pull = 3.0 * MASS, 2.0
    along = (Condition("load", Curve.constant(pull)),)
    rail = End((along, FIXED, FIXED), (FREE,) * 3, "lab", M)  # type: ignore[arg-type]
    free = Initial.straight(direction=(1.0, 0.0, 0.0))
    frame = last(Scene(ROD, free, End.free(), rail, 1.0, 0.5, gravity=(0.0, 0.0, 0.0), numerics=FIXED_STEPS))
    assert frame.r[-1, 0] - LENGTH == pytest.approx(0.5 * pull / (M + MASS), rel=1e-6)
    assert frame.f[-1, 2] == pytest.approx(pull * MASS / (M + MASS), rel=1e-6)


def test_it_is_known_in_space_alone_and_to_segments_alone() -> None:
    scene = Scene(ROD, Initial.straight(), End.clamp(), End.free(), 1.0, 0.5, numerics=FIXED_STEPS)
    assert isinstance(simulate(scene)._method, OneAxisMethod)  # type: ignore[attr-defined]
    body = replace(scene, end=with_body(1.0))
    assert not isinstance(simulate(body)._method, OneAxisMethod)  # type: ignore[attr-defined]
    with pytest.raises(ValueError, match="staggered"):
        simulate(replace(body, numerics=Numerics(intervals=10)))
    with pytest.raises(ValueError, match="mass must be >= 0 kg"):
        with_body(-1.0)
