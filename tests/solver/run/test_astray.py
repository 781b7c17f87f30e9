"""What went nowhere is forgotten where it would have been damped, and nowhere else."""

from __future__ import annotations

from dataclasses import replace
from math import exp, pi

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from solver import End, Initial, Numerics, Rod, Scene, VerifiedFrame, simulate
from solver.arrays import Array
from solver.run.astray import Astray
from solver.scene.fluid import Fluid
from tests.solver.scenes import rope_let_go

GLYCERINE = Fluid(1000.0, added_mass=1.0, viscosity=0.9)
FIBRE = Rod.circular(length=2e-2, diameter=8e-4, youngs_modulus=1e6, shear_modulus=4e5, density=2500.0)
SINKING = Scene(
    FIBRE, Initial.straight(direction=(1.0, 0.0, 0.0)), End.free(), End.free(), t_end=17.0, output_interval=0.4,
    gravity=(0.0, 0.0, -9.81), fluid=GLYCERINE, numerics=Numerics("staggered", tolerance=1e-3),
)  # fmt: skip


def fluids() -> st.SearchStrategy[Fluid | None]:
    return st.none() | st.builds(Fluid, st.just(1000.0), viscosity=st.floats(0.0, 1.0), added_mass=st.floats(0.0, 1.0))


def left(scene: Scene, before: float, gone: float, span: float, dt: float, looks: int = 1) -> Astray:
    """Where `gone` went astray evenly within `span`, after `before` had, and one looks so often."""
    astray = Astray(scene)
    astray.enter(before, 0.0, dt)
    for _ in range(looks):
        astray.enter(gone / looks, span / looks, dt)
    return astray


def test_what_nothing_damps_stays() -> None:
    assert left(rope_let_go(), -2.0, -1.0, 10.0, 0.01).energy == -3.0


def test_drag_by_the_square_of_the_velocity_lets_slow_waves_live() -> None:
    water = Fluid(1000.0, drag_normal=1.2, drag_tangential=0.02)
    assert left(replace(rope_let_go(), fluid=water), -2.0, -1.0, 10.0, 0.01).energy == -3.0


def test_a_swing_fades_no_faster_than_its_damping_lets_it() -> None:
    swing = replace(rope_let_go(), damping=0.3)
    assert left(swing, -1.0, 0.0, 10.0, 0.01).energy == pytest.approx(-exp(-3.0))


def test_nothing_fades_within_less_than_a_step() -> None:
    assert left(SINKING, 1.0, 0.0, 0.5, 0.5).energy == pytest.approx(exp(-1.0))


def test_what_was_made_does_not_hide_what_was_lost_before() -> None:
    assert left(rope_let_go(), -2.0, 1.5, 1.0, 0.01).most == 2.0
    damped = left(replace(rope_let_go(), damping=1.0), -2.0, 1.5, 1.0, 0.01)
    assert damped.most == pytest.approx(2.0 * exp(-1.0))


@given(fluids(), st.floats(0.0, 100.0), st.floats(0.0, 100.0), st.floats(1e-6, 1e3), st.floats(1e-6, 1e3))
@settings(deadline=None)
def test_how_often_one_looks_does_not_matter(
    fluid: Fluid | None, before: float, gone: float, span: float, dt: float
) -> None:
    once, often = (left(replace(SINKING, fluid=fluid), before, gone, span, dt, looks) for looks in (1, 3))
    assert often.energy == pytest.approx(once.energy, abs=1e-12)
    assert 0.0 <= once.energy <= once.most <= (before + gone) * (1.0 + 1e-15)


def half_circle(s: Array) -> Array:
    """As long as the fibre."""
    angle, radius = pi * s / FIBRE.length, FIBRE.length / pi
    return np.column_stack([radius * (1.0 - np.cos(angle)), np.zeros_like(s), radius * np.sin(angle)])


def test_what_a_start_lost_is_gone_within_the_first_frame_but_for_what_was_dissipated() -> None:
    """In glycerine a fibre springs straight within the first frame."""
    _, frame, *_ = simulate(replace(SINKING, initial=Initial(half_circle)))
    assert isinstance(frame, VerifiedFrame)
    assert frame.astray < 1e-4 * abs(frame.energy_balance)
    assert frame.error.energy_bending < 1e-4 * frame.dissipation
    assert frame.error.dissipation > 0.3 * abs(frame.energy_balance)


def test_a_fibre_that_sinks_is_right_though_its_start_stirred_up_more_than_it_has() -> None:
    frames = list(simulate(SINKING))
    middle = np.array([0.5 * FIBRE.length])
    diameter, mass = FIBRE.diameter(middle), float(FIBRE.mass(middle)[0])
    drag = float(GLYCERINE.creeping_drag(diameter, FIBRE.length)[0, 0])
    weight = (mass - GLYCERINE.density * pi / 4.0 * float(diameter[0]) ** 2) * 9.81
    energy = 0.5 * mass * FIBRE.length * (weight / drag) ** 2
    for frame in frames[1:]:
        assert isinstance(frame, VerifiedFrame)
        assert frame.energy_kinetic == pytest.approx(energy, rel=1e-4)
        assert frame.error.energy_kinetic < 1e-3 * energy
