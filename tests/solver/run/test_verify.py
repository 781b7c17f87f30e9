"""A verified run: the extrapolated solution and its error bars."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from solver import Condition, Contact, Curve, End, Initial, Numerics, Scene, VerifiedFrame, simulate
from solver.run.verify import refine, unseen
from solver.scene.ends import FREE
from solver.scene.scene import MOST_AT_REST
from tests.solver.bent import bent_cantilever
from tests.solver.scenes import GJ, LENGTH, MASS, ROD, SPIN_INERTIA, turned_clamp
from validation.error_bars import elastica_rows, missed, misses, run, scene, true

WAVE_SPEED = np.sqrt(GJ / SPIN_INERTIA)
VERIFIED = Numerics(method="staggered", intervals=10, dt_max=0.05, verify=True)


@pytest.fixture(scope="module")
def frames() -> list[VerifiedFrame]:
    return run(bent_cantilever(VERIFIED))[1]


@pytest.fixture(scope="module")
def truth() -> list[VerifiedFrame]:
    return true(bent_cantilever(VERIFIED))


def test_the_true_error_is_within_three_times_the_estimate(frames, truth):
    assert missed(misses(frames, truth)) <= 0.05


def test_the_extrapolated_solution_is_better_than_the_finer_run(frames, truth):
    fine = list(simulate(refine(bent_cantilever(replace(VERIFIED, verify=False)))))
    true = truth[-1].r[:: (len(truth[-1].r) - 1) // 10]
    assert np.abs(frames[-1].r - true).max() < 0.1 * np.abs(fine[-1].r[::2] - true).max()


def test_a_static_scene_with_contact_may_have_the_finest_mesh_but_one():
    resting = replace(bent_cantilever(replace(VERIFIED, intervals=MOST_AT_REST // 2)), analysis="static",
                      contact=Contact())  # fmt: skip
    assert len(simulate(resting).s) == MOST_AT_REST // 2 + 1


def test_rotations_stay_rotations(frames):
    for frame in frames:
        assert np.linalg.norm(frame.orientation, axis=1) == pytest.approx(np.ones(11), abs=1e-14)


def twisted(numerics: Numerics) -> Scene:
    """A straight rod whose end begins to spin within the time in which a torsional wave runs along it three times."""
    turned = turned_clamp(Condition("rate", Curve.table([0.0, 3.0 * LENGTH / WAVE_SPEED], [0.0, 1.0], "smoothstep")))
    slides = End((turned.translation[0], turned.translation[1], FREE), turned.rotation)
    return Scene(rod=ROD, initial=Initial.straight(), start=End.clamp(), end=slides, t_end=2.0, output_interval=0.25,
                 numerics=numerics, topology=False)  # fmt: skip


def test_waves_that_both_runs_damp_away_are_within_the_error_bars_of_what_has_an_energy():
    frames = run(twisted(replace(VERIFIED, dt_max=0.25)))[1]
    truth = run(twisted(replace(VERIFIED, intervals=40, dt_max=2e-3)))[1]
    assert frames[-1].dt > 4.0 * LENGTH / WAVE_SPEED  # its longest period
    found = misses(frames, truth)
    assert missed({name: found[name] for name in ("v", "omega", "kappa", "q")}) <= 0.05


def test_what_an_energy_that_was_lost_may_be():
    lost, dt = 1e-6, 0.25
    found = unseen(ROD, np.linspace(0.0, LENGTH, 11), lost, dt)
    assert 0.5 * GJ * LENGTH * found["kappa"][:, 2] ** 2 == pytest.approx(lost)
    assert 0.5 / GJ * LENGTH * found["q"][:, 2] ** 2 == pytest.approx(lost)
    assert 0.5 * MASS * LENGTH * found["v"][:, 0] ** 2 == pytest.approx(lost)
    assert 0.5 * SPIN_INERTIA * LENGTH * found["omega"][:, 2] ** 2 == pytest.approx(lost)
    # a bending wave v = V sin(k s) cos(t / dt): omega = v_s, f_s = m v_t, and m v_t = -EJ v_ssss dt in size
    V, k, EJ = found["v"][0, 0], found["omega"][0, 0] / found["v"][0, 0], float(ROD.stiffness[0](0.0))
    assert MASS * V / dt == pytest.approx(EJ * k**4 * V * dt) == pytest.approx(k * found["f"][0, 0])
    assert found["orientation"][0, 0] == pytest.approx(0.5 * dt * np.sqrt(2.0) * k * V)
    assert 2.0 * np.pi * found["Tw"] == pytest.approx(2.0 * found["orientation"].max())
    assert not found["f"][:, 2].any()


def test_equilibria_have_error_bars_too():
    told, frames = run(scene("static-elastica", {"numerics.intervals": 10, "t_end": 5.0}))
    assert missed(misses(frames, true(told))) <= 0.05
    assert all(row.passed for row in elastica_rows("", frames[-1]))
