"""Curvature where a taut rod is clamped at an angle or kinked by a load, and bends in a layer thinner than an
interval."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from math import atan, cos, pi, sin, sqrt

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from solver import (
    FIXED,
    FREE,
    Condition,
    Curve,
    DistributedLoad,
    End,
    Frame,
    Initial,
    Numerics,
    PointLoad,
    Scene,
    constant_vector,
    simulate,
)
from solver.methods.space.segments.layers import Layers
from solver.physics.elasticity import Softening
from tests.solver.scenes import EJ, LENGTH, ROD, last
from tests.solver.statics.resting import ZERO, static

THIN = 0.01 * LENGTH
"""lambda; an interval of N = 16 is six times as long."""


def pulled(angle: float, intervals: int = 16, around: float = 0.0, held: str = "start", **changes: object) -> Scene:
    """A rod clamped at one end under a tension that makes its layer THIN, first along itself, then at an angle, in the
    plane that lies `around` e3 by so much."""
    T = EJ / THIN**2 if held == "start" else -EJ / THIN**2
    aside = [Curve.table([0.0, 0.5, 1.0], [0.0, 0.0, T * sin(angle) * part]) for part in (cos(around), sin(around))]
    along = Curve.table([0.0, 0.5, 1.0], [0.0, T, T * cos(angle)])
    start, end, s = (End.clamp(), End.free(), LENGTH) if held == "start" else (End.free(), End.clamp(), 0.0)
    return static(start=start, end=end, points=(PointLoad(s, (*aside, along)),),
                  numerics=Numerics("staggered", intervals=intervals), **changes)  # fmt: skip


def at_clamp(angle: float) -> float:
    """2 / lambda sin(angle / 2), of the half infinite elastica."""
    return 2.0 / THIN * sin(0.5 * angle)


@pytest.mark.parametrize("intervals", [8, 16, 32, 64, 128])
@pytest.mark.parametrize(("angle", "within"), [(0.1, 5e-4), (0.6, 0.01), (1.5, 0.06)])
def test_a_clamped_end_has_the_elastica_s_curvature_on_any_mesh(intervals: int, angle: float, within: float) -> None:
    frame = last(pulled(angle, intervals, around=0.5))
    assert np.hypot(*frame.kappa[0, :2]) == pytest.approx(at_clamp(angle), rel=within)
    # the moment is the one that balances the load at the tip as this mesh has it
    T = EJ / THIN**2 * np.array([sin(angle) * cos(0.5), sin(angle) * sin(0.5), cos(angle)])
    assert frame.q[0] == pytest.approx(np.cross(frame.r[-1], T), abs=1e-6 * EJ / THIN)


def test_without_it_the_first_joint_tells_the_mesh(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Layers, "complete", lambda layers, fields, held, t: 0.0)
    assert last(pulled(0.1)).kappa[0, 1] < 0.35 * at_clamp(0.1)


@pytest.mark.parametrize("held", ["start", "end"])
@pytest.mark.parametrize("around", [0.0, 0.7])
def test_at_both_ends_and_in_motion_it_is_as_at_rest(around: float, held: str) -> None:
    """About one axis, where it lies in a plane of the frame, and in space."""
    still, at = last(pulled(0.4, around=around)), {"start": 0, "end": -1}[held]
    moving = pulled(0.4, around=around, held=held, analysis="dynamic", damping=2.0 * WAVE)
    moving = replace(moving, numerics=replace(moving.numerics, dt_max=0.05), t_end=3.0, output_interval=3.0)
    assert np.hypot(*last(moving).kappa[at, :2]) == pytest.approx(np.hypot(*still.kappa[0, :2]), rel=1e-3)


WAVE = pi / LENGTH * sqrt(EJ / THIN**2 / float(ROD.mass(0.0)))
"""Circular frequency of the first wave under the tension, rad/s."""


def without(scene: Scene, monkeypatch: pytest.MonkeyPatch) -> Frame:
    """The last frame of a scene whose layers are left as the mesh has them."""
    with monkeypatch.context() as changed:
        changed.setattr(Layers, "complete", lambda layers, fields, held, t: 0.0)
        return last(scene)


def test_where_the_rod_is_pressed_nothing_is_added(monkeypatch: pytest.MonkeyPatch) -> None:
    pressed = End((FIXED, FIXED, (Condition("load", Curve.constant(-EJ)),)), (FREE, FREE, FREE), "lab")
    scene = static(start=End.clamp(), end=pressed, gravity=(0.01, 0.0, 0.0))
    frame = last(scene)
    assert np.abs(frame.kappa[:, 1]).max() > 1e-3
    assert_array_equal(frame.kappa, without(scene, monkeypatch).kappa)


def test_where_tension_falls_to_nothing_at_a_free_end_nothing_is_added(monkeypatch: pytest.MonkeyPatch) -> None:
    aside = (DistributedLoad(constant_vector((10.0 * EJ, 0.0, 0.0))),)
    scene = static(start=End.pin(), end=End.free(), gravity=(0.0, 0.0, 2e4), distributed=aside,
                   numerics=Numerics("staggered", intervals=40))  # fmt: skip
    frame, plain = last(scene), without(scene, monkeypatch)
    assert not np.array_equal(frame.kappa[:5], plain.kappa[:5])
    assert_array_equal(frame.kappa[25:], plain.kappa[25:])


@pytest.mark.parametrize("around", [0.0, 0.7])
@pytest.mark.parametrize(
    ("thin", "intervals"), [(0.01, 16), (0.02, 16), (0.02, 64), (0.05, 32), (0.05, 128), (0.1, 32)]
)
def test_at_a_pin_the_curvature_is_that_of_a_taut_beam(thin: float, intervals: int, around: float) -> None:
    """K (1 - cosh((L / 2 - s) / lambda) / cosh(L / 2 lambda)) under a load K T, which was off by up to 4 % of K."""
    T, K = EJ / (thin * LENGTH) ** 2, 2e-3
    taut = End((FIXED, FIXED, (Condition("load", Curve.constant(T)),)), (FREE, FREE, FREE), "lab")
    load = DistributedLoad(constant_vector((K * T * cos(around), K * T * sin(around), 0.0)))
    frame = last(static(start=End.pin(), end=taut, distributed=(load,),
                        numerics=Numerics("staggered", intervals=intervals)))  # fmt: skip
    s = np.linspace(0.0, LENGTH, intervals + 1)
    exact = K * (1.0 - np.cosh((0.5 * LENGTH - s) / thin) / np.cosh(0.5 * LENGTH / thin))
    assert_allclose(np.hypot(*frame.kappa[:, :2].T), exact, atol=3e-4 * K)


def plucked(place: float, intervals: int, force: float = 1e-3, **changes: object) -> Scene:
    """A taut rod between pins that a load pulls aside at a place; `force` in the tension."""
    T = EJ / THIN**2
    along = (FIXED, FIXED, (Condition("load", Curve.table([0.0, 0.5, 1.0], [0.0, T, T])),))
    aside = (
        Curve.table([0.0, 0.5, 1.0], [0.0, 0.0, 0.6 * force * T]),
        Curve.table([0.0, 0.5, 1.0], [0.0, 0.0, 0.8 * force * T]),
    )
    return static(start=End.pin(), end=End(along, (FREE, FREE, FREE), "lab"),
                  points=(PointLoad(place * LENGTH, (*aside, ZERO)),),
                  numerics=Numerics("staggered", intervals=intervals), **changes)  # fmt: skip


@pytest.mark.parametrize("intervals", [18, 32, 47, 96, 200])
@pytest.mark.parametrize("place", [0.5, 0.4337, 0.6, 0.5 + 1e-9])
def test_on_both_sides_of_a_load_the_curvature_is_that_of_a_taut_beam(place: float, intervals: int) -> None:
    """P lambda / (2 EJ) exp(-s / lambda), wherever the load lies between the nodes."""
    run = simulate(plucked(place, intervals))
    *_, frame = run
    exact = 1e-3 / (2.0 * THIN) * np.exp(-np.abs(run.s - place * LENGTH) / THIN)
    assert_allclose(np.hypot(*frame.kappa[:, :2].T), exact, atol=0.01 * exact.max())


@pytest.mark.parametrize("intervals", [16, 32, 128])
def test_at_a_large_kink_it_is_the_elastica_s(intervals: int) -> None:
    """By twice the angle theta: each side is as if it were clamped at theta. The pull along the pins is T."""
    theta = atan(0.5)
    peak = 2.0 / THIN / sqrt(cos(theta)) * sin(0.5 * theta)
    frame = last(plucked(0.5, intervals, force=1.0))
    assert np.hypot(*frame.kappa[intervals // 2, :2]) == pytest.approx(peak, rel=0.01)


def test_in_motion_a_kink_is_as_at_rest() -> None:
    """And the energy that flows is that of the mesh."""
    still = last(plucked(0.4337, 32))
    moving = plucked(0.4337, 32, analysis="dynamic", damping=2.0 * WAVE)
    moving = replace(moving, numerics=replace(moving.numerics, dt_max=0.05), t_end=3.0, output_interval=3.0)
    moved = last(moving)
    assert_allclose(moved.kappa, still.kappa, atol=1e-3 * np.abs(still.kappa).max())
    assert moved.energy_bending == pytest.approx(still.energy_bending, rel=2e-3)
    assert abs(moved.energy_balance) < 0.02 * still.energy_bending


@pytest.mark.parametrize("intervals", [16, 32, 64, 128, 256])
@pytest.mark.parametrize(("scene", "exact"), [
    (lambda intervals: pulled(0.6, intervals, around=0.5), 4.0 * EJ / THIN * sin(0.25 * 0.6) ** 2),
    (lambda intervals: pulled(1.5, intervals, around=0.5), 4.0 * EJ / THIN * sin(0.25 * 1.5) ** 2),
    (lambda intervals: plucked(0.4337, intervals, force=0.1), 0.1**2 * EJ / (8.0 * THIN)),
])  # fmt: skip
def test_at_rest_the_bending_energy_is_that_of_the_layers(
    scene: Callable[[int], Scene], exact: float, intervals: int
) -> None:
    """Of the elastica (4 EJ / lambda) sin^2(theta / 4), on each side."""
    assert last(scene(intervals)).energy_bending == pytest.approx(exact, rel=0.02)


@pytest.mark.parametrize("intervals", [32, 64])
def test_of_a_rod_that_springs_back_next_to_nothing_is_added(intervals: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """A motion of waves far longer than an interval, which has no such layer."""
    bent = Initial(lambda s: np.stack([(1.0 - np.cos(3.0 * s)) / 3.0, 0.0 * s, np.sin(3.0 * s) / 3.0], axis=1))
    time = LENGTH**2 * sqrt(float(ROD.mass(0.0)) / EJ)
    scene = Scene(ROD, bent, End.clamp(), End.free(), 2.0 * time, 0.05 * time,
                  numerics=Numerics("staggered", intervals=intervals))  # fmt: skip
    completed = [frame.energy_bending for frame in simulate(scene)]
    monkeypatch.setattr(Layers, "complete", lambda layers, fields, held, t: 0.0)
    plain = [frame.energy_bending for frame in simulate(scene)]
    assert_allclose(completed, plain, atol=1e-2 * max(plain))


def test_two_loads_side_by_side_bend_the_rod_as_both_do() -> None:
    both, (place, other) = plucked(0.5, 50), (0.5, 0.53)
    half = PointLoad(place * LENGTH, (both.points[0].force[0], ZERO, ZERO))
    scene = replace(both, points=(half, replace(half, s=other * LENGTH)))
    run = simulate(scene)
    *_, frame = run
    exact = sum(6e-4 / (2.0 * THIN) * np.exp(-np.abs(run.s - at * LENGTH) / THIN) for at in (place, other))
    assert_allclose(np.abs(frame.kappa[:, 1]), exact, atol=0.01 * np.max(exact))


@pytest.mark.parametrize("intervals", range(2, 20))
def test_a_mesh_of_any_size_has_its_layers(intervals: int) -> None:
    run = simulate(pulled(0.1, intervals))
    *_, frame = run
    exact = at_clamp(0.1) * np.exp(-run.s / THIN)
    if intervals > 4:
        assert_allclose(np.hypot(*frame.kappa[:, :2].T), exact, atol=1e-3 * exact[0])


@pytest.mark.parametrize(("place", "layers"), [(0.1, 2), (0.2, 3), (0.5, 3), (0.85, 3), (0.95, 2)])
def test_a_kink_beside_an_end_is_left_alone(place: float, layers: int) -> None:
    scene = static(points=(PointLoad(place * LENGTH, (Curve.constant(1.0), ZERO, ZERO)),))
    assert len(Layers.of(scene, np.linspace(0.0, LENGTH, 17)).layers) == layers


def test_a_law_whose_moment_is_not_proportional_to_curvature_has_none() -> None:
    softening = Softening(Curve.constant(EJ), Curve.constant(1.0))
    s = np.linspace(0.0, LENGTH, 17)
    assert not Layers.of(static(rod=replace(ROD, laws=(softening,))), s).layers
    assert len(Layers.of(static(), s).layers) == 2
