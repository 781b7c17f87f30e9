"""Steps that pass frames: these lie on the motion all the same, however the steps lie."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from solver import Condition, Curve, End, Frame, Numerics, Scene, simulate
from solver.methods.time.radau import tableau
from solver.physics.elasticity import Stretch
from solver.run.simulation import Simulation
from solver.scene.ends import FIXED, FREE
from tests.solver.bent import bent_cantilever
from tests.solver.run.test_checkpoint import assert_same
from tests.solver.scenes import EJ, ROD

NUMERICS = Numerics("staggered", intervals=16, dt_max=0.25, increment_tolerance=1e-2)
STATES = ("r", "orientation", "kappa", "v", "omega")


def bent() -> Scene:
    """In a plane, so that it turns about one axis."""
    return bent_cantilever(NUMERICS)


def turned() -> Scene:
    """In space: the start of a bent rod turns about itself, and comes to rest."""
    turn = Condition("rate", Curve.table([0.0, 1.0, 2.0, 4.0], [0.0, 1.0, 1.0, 0.0], "smoothstep"))
    start = End((FIXED, FIXED, FIXED), (FIXED, FIXED, (turn,)))
    return replace(bent(), start=start, topology=True)


def stretched() -> Scene:
    """The same of a rod that can stretch, pulled as it is bent."""
    pull = Condition("load", Curve.table([0.0, 3.0], [0.0, 30.0 * EJ], "smoothstep"))
    rod = replace(ROD, laws=(Stretch(Curve.constant(3e3 * EJ)),))
    return replace(turned(), rod=rod, end=End((FREE, FREE, (pull,)), (FREE, FREE, FREE), frame="lab"))


def passing(scene: Scene, strides: int = 5) -> Scene:
    return replace(scene, numerics=replace(scene.numerics, strides=strides))


def exact(scene: Scene) -> list[Frame]:
    return list(simulate(replace(scene, numerics=replace(scene.numerics, dt_max=0.02, increment_tolerance=1e-6))))


def apart(one: list[Frame], other: list[Frame], name: str) -> float:
    """The largest difference, in the largest value there is."""
    series = [np.array([getattr(frame, name) for frame in frames]) for frames in (one, other)]
    return float(np.abs(series[0] - series[1]).max() / np.abs(series[1]).max())


@pytest.mark.parametrize("make", [bent, turned, stretched])
def test_steps_pass_frames_which_lie_on_the_motion_all_the_same(make: Callable[[], Scene]) -> None:
    scene, run = passing(make()), Simulation(passing(make()))
    frames = list(run)
    ends = Simulation(make())
    assert list(ends)
    assert run.statistics.steps < ends.statistics.steps - 4
    assert [frame.t for frame in frames] == [0.0, *scene.outputs]
    truth = exact(make())
    for name in STATES:
        assert apart(frames, truth, name) < 1e-2, name
    if make is stretched:
        assert max(frame.strain.max() for frame in truth) > 5e-3
        assert apart(frames, truth, "strain") < 5e-3
    for name in ("energy_bending", "energy_kinetic", "work_ends", "dissipation"):
        assert apart(frames, truth, name) < 2e-3, name
    for one, other in zip(frames, truth, strict=True):
        assert (one.Tw, one.Wr, one.Lk) == pytest.approx((other.Tw, other.Wr, other.Lk), abs=1e-4, nan_ok=True)


def test_a_frame_within_a_step_is_nearer_the_shorter_the_steps_are() -> None:
    """By at least order 3, as the polynomial in time that is collocated."""
    scene, errors = replace(turned(), output_interval=0.1), []
    truth = exact(scene)
    for dt in (0.16, 0.08):
        numerics = replace(NUMERICS, dt_max=dt, increment_tolerance=1e9, strides=5)
        errors.append(apart(list(simulate(replace(scene, numerics=numerics))), truth, "r"))
    assert errors[1] < errors[0] / 2.0**3


def test_the_rotation_of_the_ends_is_that_of_the_frame_and_not_of_the_step() -> None:
    for frame in simulate(passing(turned())):
        assert frame.Tw + frame.Wr == pytest.approx(frame.Lk, abs=1e-4)


def test_a_free_end_has_turned_as_far_as_at_the_frame() -> None:
    """What is not prescribed is followed step by step: what comes after the frame does not count."""
    scene = replace(turned(), end=End.free())
    for frame in simulate(passing(scene)):
        assert frame.Tw + frame.Wr == pytest.approx(frame.Lk, abs=1e-4)


@pytest.mark.parametrize("make", [bent, turned, stretched])
def test_a_run_that_is_interrupted_within_a_step_gives_the_same_frames_to_the_bit(make: Callable[[], Scene]) -> None:
    alone = list(simulate(passing(make())))
    run, first = simulate(passing(make())), []
    while len(first) < 8:
        frame = run.advance()
        first += [frame] if frame else []
    assert run.t > first[-1].t, "between two frames of one step"
    other = simulate(passing(make()))
    other.restore(run.checkpoint())
    assert_same([*first, *other], alone)


def test_without_strides_steps_end_at_every_frame() -> None:
    run = Simulation(bent())
    for frame in run:
        assert run.t == frame.t or frame.t == 0.0


def test_with_strides_they_end_at_every_so_manieth_and_at_the_last() -> None:
    run, reached = Simulation(passing(bent())), []
    for frame in run:
        reached += [frame.t] if run.t == frame.t else []
    assert {1.25, 2.5, 3.75, 4.0} <= set(reached)


def test_the_box_method_takes_none() -> None:
    with pytest.raises(ValueError, match="strides must be 1, or more with the method staggered, got 2"):
        Numerics("box", strides=2)
    with pytest.raises(ValueError, match="got 0"):
        Numerics("staggered", strides=0)


@pytest.mark.parametrize("part", [0.0, 0.3, 1.0])
def test_weights_within_a_step_are_exact_for_polynomials(part: float) -> None:
    cubic, parabola, gained = tableau.within(part)
    x = tableau.C
    assert cubic @ (2 * x + 3 * x**2 - x**3) == pytest.approx(2 * part + 3 * part**2 - part**3)
    assert parabola @ (1 + x + 2 * x**2) == pytest.approx(1 + part + 2 * part**2)
    assert gained @ (1 + x + 2 * x**2) == pytest.approx(1 - part + (1 - part**2) / 2 + 2 * (1 - part**3) / 3)

