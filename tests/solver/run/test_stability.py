"""Whether a straight or a plane rod would stay so, if it were disturbed: what a run to a tolerance says of it."""

from __future__ import annotations

from itertools import islice

import numpy as np
import pytest

from solver import Curve, End, Initial, Numerics, PointLoad, Scene, simulate
from tests.solver.scenes import ARC, ARC_ROD, LENGTH, ROD


def loaded(force: float, seed: float, numerics: Numerics) -> Scene:
    """A straight cantilever with a force (EJ/L^2) on its free end, along it, and as `seed` says across it."""
    EJ, mass = float(ROD.stiffness[0](0.0)), float(ROD.mass(0.0))
    unit, time = EJ / LENGTH**2, LENGTH**2 * np.sqrt(mass / EJ)
    load = PointLoad(LENGTH, tuple(map(Curve.constant, (seed * unit, 0.0, -force * unit))))  # type: ignore[arg-type]
    return Scene(ROD, Initial.straight(), End.clamp(), End.free(), 4.0 * time, 0.25 * time, points=(load,),
                 damping=1.0 / time, numerics=numerics)  # fmt: skip


@pytest.mark.parametrize("numerics", [Numerics("staggered", tolerance=1e-2)])
@pytest.mark.parametrize(("force", "seed", "told"), [(20.0, 0.0, True), (2.0, 0.0, False), (20.0, 1e-3, False)])
def test_a_rod_that_stays_straight_beyond_its_critical_load_says_so(force: float, seed: float, told: bool,
                                                                           numerics: Numerics) -> None:  # fmt: skip
    run = simulate(loaded(force, seed, numerics))
    *_, frame = run
    assert (np.abs(frame.kappa[:, :2]).max() * LENGTH > 1.0) == (seed > 0.0)
    assert ("disturbance_growth" in run.attributes()) == told
    assert any("stays straight" in note for note in run.notes()) == told


@pytest.mark.parametrize(("across", "told"), [(0.0, True), (1e-3, False)])
def test_an_arc_between_pins_that_is_pushed_through_in_its_plane_says_so(across: float, told: bool) -> None:
    """It would rather turn about the line between the pins."""
    EJ, mass = float(ROD.stiffness[0](0.0)), float(ROD.mass(0.0))
    time, push = LENGTH**2 * np.sqrt(mass / EJ), 30.0 * EJ / LENGTH**2
    force = Curve.table([0.0, time], [0.0, push]), Curve.constant(across * push), Curve.constant(0.0)
    run = simulate(Scene(
        ARC_ROD, ARC, End.pin(), End.pin(), 4.0 * time, 0.125 * time, damping=2.0 / time,
        points=(PointLoad(0.5 * LENGTH, force),), numerics=Numerics("staggered", tolerance=1e-2),
    ))  # fmt: skip
    farthest = max(float(np.abs(frame.r[:, 1]).max()) for frame in run)
    assert (farthest > 0.1 * LENGTH) == (across > 0.0)
    assert ("disturbance_growth" in run.attributes()) == told


def test_a_run_that_was_interrupted_says_the_same() -> None:
    scene = loaded(20.0, 0.0, Numerics("staggered", tolerance=1e-2))
    whole = simulate(scene)
    frames = list(whole)
    run = simulate(scene)
    list(islice(run, len(frames) // 2))
    other = simulate(scene)
    other.restore(run.checkpoint())
    assert list(other)[-1].t == frames[-1].t
    assert other.attributes()["disturbance_growth"] == whole.attributes()["disturbance_growth"]
