"""A static analysis to a tolerance: its errors are what it says, on as many intervals as it needs."""

from __future__ import annotations

from dataclasses import replace
from math import pi

import numpy as np
import pytest

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
    RunFailed,
    Scene,
    VerifiedFrame,
    simulate,
)
from solver.physics.loads.solids import Floor
from solver.run import refined
from solver.run.first_mesh import first_mesh
from solver.run.refined import Refined
from solver.run.trial import AT_REST, intervals_of
from tests.solver.scenes import ARC, ARC_ROD, EJ, LENGTH, ROD
from tests.solver.statics.resting import ZERO, ramp, static

TO_TOLERANCE = Numerics("staggered", tolerance=1e-3)


def tip_loaded(numerics: Numerics) -> Scene:
    """A cantilever that a dead load at its tip bends by more than a right angle."""
    point = PointLoad(LENGTH, (ramp(10.0 * EJ / LENGTH**2), ZERO, ZERO))
    return static(points=(point,), numerics=numerics, output_interval=0.25)


def frames_of(scene: Scene) -> list[VerifiedFrame]:
    return [frame for frame in simulate(scene) if isinstance(frame, VerifiedFrame)]


@pytest.mark.parametrize("tolerance", [1e-3, 1e-5])
def test_every_frame_has_its_error_and_keeps_the_tolerance(tolerance: float) -> None:
    scene = tip_loaded(replace(TO_TOLERANCE, tolerance=tolerance))
    run = Refined(scene)
    frames = [frame for frame in run if isinstance(frame, VerifiedFrame)]
    truth = frames_of(tip_loaded(Numerics("staggered", intervals=512, verify=True)))
    assert run.accuracy is not None and run.accuracy.met
    assert {attempt.steps for attempt in run._attempts} == {AT_REST}
    every = 512 // (len(run.s) - 1)
    for frame, true in zip(frames, truth, strict=True):
        assert np.all(np.abs(frame.r - true.r[::every]) <= 3.0 * frame.error.r + 1e-9 * LENGTH)
        assert abs(frame.energy_bending - true.energy_bending) <= 3.0 * frame.error.energy_bending + 1e-9 * EJ / LENGTH
        assert np.abs(frame.error.r).max() <= tolerance * LENGTH
        assert not frame.error.v.any() and not frame.error.omega.any()


def test_what_bends_evenly_needs_no_fine_mesh() -> None:
    run = Refined(tip_loaded(TO_TOLERANCE))
    for _ in run:
        pass
    assert len(run.s) - 1 < 200


def test_a_branch_that_ends_has_frames_and_errors_until_there() -> None:
    pulled = End((FIXED, FIXED, (Condition("position", ramp(0.5)),)), (FIXED,) * 3, frame="lab")
    run = Refined(static(rod=ARC_ROD, initial=ARC, end=pulled, numerics=TO_TOLERANCE, output_interval=0.05))
    frames: list[Frame] = []
    with pytest.raises(RunFailed) as failure:
        frames.extend(run)
    assert failure.value.outcome is Outcome.ROD_STRETCHED
    assert len(frames) > 2
    assert all(isinstance(frame, VerifiedFrame) and np.isfinite(frame.error.r).all() for frame in frames)
    assert len(run._attempts) == 4


def test_a_rod_that_no_floor_holds_is_refused_on_few_meshes() -> None:
    run = Refined(static(start=End.free(), gravity=(1.0, 0.0, -9.81), numerics=TO_TOLERANCE,
                         loads=(Floor(height=1e-4, stiffness=1e6),)))  # fmt: skip
    with pytest.raises(RunFailed) as failure:
        for _ in run:
            pass
    assert failure.value.outcome is Outcome.SINGULAR_SYSTEM
    assert len(run._attempts) <= 4


def test_a_shape_that_is_not_let_go_of_in_the_work_that_may_be_done_is_told_so(monkeypatch: pytest.MonkeyPatch) -> None:
    """Not as a run that its frames or its waves make long: a fibre that lay across itself was 165 CPU s about it."""
    monkeypatch.setattr(refined, "LETTING_GO", 1e-4)
    run = Refined(static(initial=ARC, numerics=TO_TOLERANCE))
    with pytest.raises(RunFailed) as failure:
        list(run)
    assert (failure.value.outcome, failure.value.t) == (Outcome.EQUILIBRIUM_LOST, 0.0)


def test_the_first_mesh_shows_the_corners_of_the_shape() -> None:
    s = np.linspace(0.0, 0.5, 60)
    frame = np.array([*([0.0, 0.0, x] for x in s), *([x, 0.0, 0.5] for x in s[1:])]) * LENGTH
    cornered = static(initial=Initial.through(frame, LENGTH))
    assert intervals_of(first_mesh(cornered, pressed=False)) >= 64
    dynamic = replace(cornered, analysis="dynamic")
    assert intervals_of(first_mesh(dynamic, pressed=False)) == 64  # a spline bends to and fro about a corner


def test_twist_that_is_the_same_all_along_needs_no_fine_mesh() -> None:
    turn = (Condition("position", Curve.table([0.0, 1.0], [0.0, 12.0 * pi])),)
    end = replace(End.clamp(), rotation=(*End.clamp().rotation[:2], turn))
    twisted = static(end=end)
    assert intervals_of(first_mesh(twisted, pressed=False)) == 16
    assert intervals_of(first_mesh(replace(twisted, analysis="dynamic"), pressed=False)) == 32


def test_contact_keeps_the_meshes_to_what_can_be_counted() -> None:
    scene = tip_loaded(replace(TO_TOLERANCE, tolerance=1e-6))
    assert Refined(scene)._most == 2000
    assert Refined(replace(scene, rod=ROD, contact=Contact()))._most == 1000
