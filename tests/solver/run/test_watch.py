"""What a run says of strands that pass through each other, hop over an end, or overlap, of solids, and of buckling."""

from __future__ import annotations

from dataclasses import replace
from math import nan

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
    RunFailed,
    Simulation,
    simulate,
)
from solver.measures.topology import writhe
from solver.methods.status import STALLED
from solver.physics.loads.solids import Floor, Obstacle, deepest_within
from solver.run.remarks import Remarks
from solver.run.watch import Watch
from solver.scene.scene import Scene
from tests.solver.measures.test_passages import hooked
from tests.solver.physics.contact.test_self_contact import looped
from tests.solver.scenes import LENGTH, ROD, last

PLAIN = Scene(
    rod=ROD, initial=Initial.straight(), start=End.clamp(), end=End.free(), t_end=0.01, output_interval=0.01,
    numerics=Numerics(intervals=4),
)  # fmt: skip


@pytest.fixture(scope="module")
def frame() -> Frame:
    return last(PLAIN)


def looks(frame: Frame, height: float, reach: float, t: float) -> Frame:
    """A frame with the hooked shape, whose tangents at the ends are e3 and e1."""
    shape = hooked(height, reach)
    Wr = writhe(shape.r, shape.tangents)
    orientation = np.tile([1.0, 0.0, 0.0, 0.0], (len(shape.r), 1))
    orientation[-1] = [np.sqrt(0.5), 0.0, np.sqrt(0.5), 0.0]
    return replace(frame, t=t, r=shape.r, orientation=orientation, Tw=0.0, Wr=Wr, Lk=0.0, min_gap=nan)


def watched(frame: Frame, height: float, holds: bool) -> tuple[str, Remarks]:
    remarks = Remarks()
    watch = Watch(remarks, holds)
    watch.see(looks(frame, height, 0.3, 1.0))
    return watch.see(looks(frame, height, -0.3, 2.0)), remarks


def test_a_hop_over_an_end_ends_no_run(frame: Frame) -> None:
    for holds in (True, False):
        refusal, remarks = watched(frame, -0.52, holds)
        assert not refusal
        assert remarks.attributes() == {"end_hops": 1}
        assert "hopped over an end of the rod once" in remarks.sentences()[0]


def test_a_jump_between_frames_that_show_neither_is_told_too(frame: Frame) -> None:
    """As where a rod snaps over: on the straight way from one frame to the next nothing may meet."""
    remarks = Remarks()
    watch = Watch(remarks, holds=False)
    watch.see(looks(frame, 0.52, 0.3, 1.0))
    still = looks(frame, 0.52, 0.3, 2.0)
    assert not watch.see(replace(still, Tw=still.Tw - 2.0))
    assert remarks.attributes() == {"unclear_jumps": 1}
    assert "too far apart to tell which" in remarks.sentences()[0]


def test_a_crossing_ends_a_run_with_contact_and_is_told_without(frame: Frame) -> None:
    assert watched(frame, 0.52, True)[0]
    refusal, remarks = watched(frame, 0.52, False)
    assert not refusal
    assert remarks.attributes() == {"crossings": 1, "first_crossing": 2.0}


def test_a_jump_that_hops_do_not_explain_ends_no_run_while_the_rod_is_near_a_ray(frame: Frame) -> None:
    """As in a ring of DNA whose ends lie closer together than a step goes, which is no straight way."""
    remarks = Remarks()
    watch = Watch(remarks, True)
    watch.see(looks(frame, -0.52, 0.3, 1.0))
    hopped = looks(frame, -0.52, -0.3, 2.0)
    assert not watch.see(replace(hopped, Tw=hopped.Tw - 2.0))
    assert remarks.attributes() == {"end_hops": 1, "unclear_jumps": 1}
    assert watch.see(replace(hopped, Tw=hopped.Tw + 2.0))  # nowhere near: nothing but a crossing is left


def test_the_deepest_overlap_is_kept(frame: Frame) -> None:
    remarks = Remarks()
    watch = Watch(remarks, True)
    for t, gap in ((1.0, nan), (2.0, 1e-4), (3.0, -2e-4), (4.0, -1e-4)):
        watch.see(replace(frame, t=t, min_gap=gap))
    assert remarks.attributes() == {"deepest_overlap": 2e-4, "deepest_overlap_at": 3.0}
    assert "overlapped" in remarks.sentences()[0]


def test_a_run_without_contact_goes_on_and_says_that_it_crossed() -> None:
    simulation = Simulation(looped(None, 0.05))
    times = [frame.t for frame in simulation]
    assert times[-1] == 1.0
    assert simulation.remarks.crossings == 1
    assert 0.0 < simulation.remarks.first_crossing <= 1.0


@pytest.mark.parametrize(("jumped", "outcome"), [(4.0, Outcome.ROD_CROSSED_ITSELF), (0.0, Outcome.STEP_TOO_SMALL)])
def test_a_run_that_fails_between_frames_says_if_the_rod_had_passed_through_itself(
    monkeypatch: pytest.MonkeyPatch, jumped: float, outcome: Outcome
) -> None:
    run = Simulation(looped(Contact(), 0.0))
    while run.advance() is None or run.t == 0.0:
        pass
    monkeypatch.setattr(run._method, "try_step", lambda *_: (STALLED, 1))
    twist = run._method.twist()
    monkeypatch.setattr(run._method, "twist", lambda: twist + jumped)
    with pytest.raises(RunFailed) as failed:
        list(run)
    assert failed.value.outcome is outcome


@pytest.mark.parametrize("analysis", ["dynamic", "static"])
@pytest.mark.parametrize(("pushed", "sunk"), [(0.0, False), (0.3, True)])
def test_a_rod_that_is_pushed_into_a_floor_end_first_is_told(analysis: str, pushed: float, sunk: bool) -> None:
    """Nothing lets it bend aside; at first it stands on the floor."""
    down = Condition("position", Curve.table([0.0, 1.0], [0.0, -pushed * LENGTH]))
    above = End(((Condition("position", Curve.constant(0.0)),),) * 2 + ((down,),), (FIXED,) * 3, "lab")
    scene = Scene(
        ROD, Initial.straight(), End.free(), above, 1.0, 0.25, gravity=(0.0, 0.0, -9.81), loads=(Floor(1e5),),
        numerics=Numerics("staggered", intervals=8), analysis=analysis, damping=10.0,
    )  # fmt: skip
    run = simulate(scene)
    *_, frame = run
    if sunk:
        assert run.attributes()["deepest_in_solid"] == pytest.approx(-frame.r[0, 2], rel=1e-6)
        assert run.attributes()["deepest_in_solid_at"] == 1.0
        assert any("pressed into a floor" in note for note in run.notes())
    else:
        assert "deepest_in_solid" not in run.attributes()


def test_only_what_is_deeper_than_the_diameter_counts() -> None:
    D, s = float(ROD.diameter(0.0)), np.array([0.0, 0.5, 1.0])
    scene = Scene(ROD, Initial.straight(), End.clamp(), End.free(), 1.0, 1.0,
                  loads=(Floor(1.0), Obstacle((0.0, 1.0, 5.0), (0.0, 1.0, 5.0), 3.0 * D, 1.0)))  # fmt: skip
    beside = np.array([[0.0, 1.0, 5.0 + 0.5 * D], [0.0, 0.0, -0.9 * D], [0.0, 0.0, 1.0]])
    assert deepest_within(scene, s, beside) == pytest.approx(2.5 * D)
    assert deepest_within(scene, s, beside + np.array([0.0, 5.0, 0.0])) == 0.0
    assert deepest_within(replace(scene, loads=()), s, beside) == 0.0
