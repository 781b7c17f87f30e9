"""A run that is interrupted and restored goes on bit by bit as it would have, wherever it was interrupted."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from dataclasses import fields, replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from solver import Condition, Curve, DistributedLoad, End, Fluid, Frame, Numerics, Scene, VerifiedFrame, simulate
from solver.kernels import kernel
from solver.physics.elasticity import Stretch
from solver.run import checkpoint as checkpoints
from solver.scene.ends import FIXED
from tests.solver.bent import bent_cantilever
from tests.solver.physics.contact.test_self_contact import CONTACT, looped
from tests.solver.scenes import ARC, ARC_ROD, EJ, FIXED_STEPS, LENGTH, rope_let_go
from tests.solver.statics.test_statics import arch, ramp

SPIN = Curve.table([0.0, 0.3, 1.0], [0.0, 6.0, 6.0], "smoothstep")
STOPPED = (Condition("rate", Curve.constant(0.05)), Condition("stop", since=0.45, within=0.1))


def switched() -> Scene:
    """Water, weight, a spinning end and one whose drive stops within the run: steps of many lengths."""
    end = End((FIXED, FIXED, STOPPED), (FIXED, FIXED, (Condition("rate", SPIN),)))
    return Scene(rod=ARC_ROD, initial=ARC, start=End.clamp(), end=end, t_end=0.8, output_interval=0.1,
                 fluid=Fluid(1000.0, 1.0, 0.1, 0.01), gravity=(0.0, 0.0, -1.0),
                 numerics=Numerics(intervals=20, dt_max=0.1, increment_tolerance=0.5))  # fmt: skip


def shot() -> Scene:
    """By shooting, where it keeps its digits: thick, and at large steps."""
    numerics = Numerics(linear_solver="shooting", intervals=8, dt_max=0.2, increment_tolerance=FIXED_STEPS)
    return replace(switched(), fluid=None, gravity=(0.0, 0.0, 0.0), damping=20.0, numerics=numerics)


def pressed() -> Scene:
    """Two strands that are pressed onto each other."""
    return looped(replace(CONTACT, k1=3e-6), 0.02, t_end=0.6)


def staggered() -> Scene:
    """The switched scene by the staggered method."""
    numerics = Numerics(method="staggered", intervals=20, dt_max=0.2, increment_tolerance=4e-2)
    return replace(switched(), numerics=numerics)


def about_one_axis() -> Scene:
    """In the plane: a clamp that is turned, let go and stopped, and a load that follows."""
    growth = Curve.table([0.0, 0.3, 1.0], [0.0, 1e-3, 1e-3], "smoothstep")
    load = DistributedLoad((growth, Curve.constant(0.0), growth), frame="material", schedule=growth)
    turned = (Condition("rate", growth), Condition("load", since=0.3), Condition("stop", since=0.5, within=0.1))
    start = End((FIXED, FIXED, FIXED), (FIXED, turned, FIXED))
    end = End((FIXED, FIXED, STOPPED), (FIXED, FIXED, FIXED))
    return replace(staggered(), start=start, end=end, distributed=(load,))


def staggered_pressed() -> Scene:
    """The pressed strands by the staggered method."""
    numerics = Numerics(method="staggered", intervals=30, dt_max=0.02, increment_tolerance=3e-2)
    return replace(pressed(), numerics=numerics)


def stretched() -> Scene:
    """The same strands, of a rod that can stretch."""
    scene = staggered_pressed()
    return replace(scene, rod=replace(scene.rod, laws=(Stretch(Curve.constant(1e3 * EJ / LENGTH**2)),)))


def balanced() -> Scene:
    """A branch of equilibria, past a fold."""
    return arch(Condition("load", ramp(-10.0 * EJ / LENGTH**2, 10.0)), 6.0, 0.5)


def verified() -> Scene:
    """Two resolutions side by side."""
    return replace(bent_cantilever(Numerics(method="staggered", intervals=10, dt_max=0.05, verify=True)), t_end=1.0)


def refined() -> Scene:
    """One mesh after the other."""
    return bent_cantilever(Numerics(method="staggered", tolerance=3e-3))


def damped() -> Scene:
    """One mesh, then the other, then with viscosity."""
    rope = rope_let_go()
    return replace(rope, t_end=2.0, numerics=replace(rope.numerics, most_intervals=32))


def refined_at_rest() -> Scene:
    """The branch on one mesh after the other."""
    return replace(balanced(), numerics=Numerics("staggered", tolerance=1e-3))


@cache
def undisturbed(make: Callable[[], Scene]) -> list[Frame]:
    """The frames of a run that is not interrupted."""
    return list(simulate(make()))


def interrupted(scene: Scene, after: int) -> list[Frame]:
    """The frames of a run that is begun anew, and restored, after each `after` steps."""
    found: list[Frame | None] = []
    run = simulate(scene)
    while not run.finished:
        found += [run.advance() for _ in range(after) if not run.finished]
        checkpoint = run.checkpoint()
        run = simulate(scene)
        run.restore(checkpoint)
    return [frame for frame in found if frame is not None]


def assert_same(one: list[Frame], other: list[Frame]) -> None:
    assert len(one) == len(other)
    for a, b in zip(one, other, strict=True):
        for field in fields(Frame):
            assert np.array_equal(getattr(a, field.name), getattr(b, field.name), equal_nan=True), (a.t, field.name)
    errors = [[frame.error for frame in frames if isinstance(frame, VerifiedFrame)] for frames in (one, other)]
    if any(errors):
        assert_same(*errors)


@pytest.mark.parametrize("make", [switched, shot, pressed, staggered, about_one_axis, staggered_pressed, stretched,
                                  balanced, verified])  # fmt: skip
@pytest.mark.parametrize("after", [1, 7])
def test_an_interrupted_run_gives_the_same_frames_to_the_bit(make: Callable[[], Scene], after: int) -> None:
    assert_same(undisturbed(make), interrupted(make(), after))


@pytest.mark.parametrize(("make", "after"), [
    *((make, after) for make in (refined, damped, refined_at_rest) for after in (7, 40)), (damped, 300),
])  # fmt: skip
def test_a_run_that_is_interrupted_while_it_is_refined_gives_the_same_frames_to_the_bit(
    make: Callable[[], Scene], after: int
) -> None:
    assert_same(undisturbed(make), interrupted(make(), after))


@pytest.mark.parametrize("make", [pressed, staggered_pressed])
def test_strands_press_in_the_run_that_is_interrupted_in_contact(make: Callable[[], Scene]) -> None:
    assert undisturbed(make)[-1].contacts > 0


def test_what_a_run_has_cost_goes_on_too() -> None:
    whole, part = simulate(switched()), simulate(switched())
    frames = sum(1 for _ in whole)
    for _ in range(15):
        part.advance()
    rest = simulate(switched())
    rest.restore(part.checkpoint())
    assert 0 < sum(1 for _ in rest) < frames
    for name in ("steps", "newton_iterations", "failed_steps"):
        assert getattr(rest.statistics, name) == getattr(whole.statistics, name)


def test_a_checkpoint_is_not_changed_by_the_run_that_goes_on() -> None:
    run = simulate(switched())
    run.advance()
    checkpoint = run.checkpoint()
    before = {name: np.copy(value) for name, value in checkpoint.items() if isinstance(value, np.ndarray)}
    for _ in range(5):
        run.advance()
    assert all(np.array_equal(checkpoint[name], value) for name, value in before.items())
    assert any(not np.array_equal(run.checkpoint()[name], value) for name, value in before.items())


def test_a_checkpoint_with_something_unknown_is_refused() -> None:
    checkpoint = simulate(shot()).checkpoint()
    with pytest.raises(ValueError, match=r"nothing here is called \._method\.mood"):
        simulate(shot()).restore(checkpoint | {"._method.mood": 1.0})


def test_a_run_that_grew_more_room_for_contact_is_restored() -> None:
    """The list of pairs is made anew, and larger, where it is too short."""
    run = simulate(pressed())
    for _ in range(10):
        run.advance()
    checkpoint = run.checkpoint()
    contact = run._method.contact
    contact._make_room(contact.touch.points, 5000)
    grown = run.checkpoint()
    other = simulate(pressed())
    other.restore(grown)
    assert other._method.contact.touch.pairs.first.shape == contact.touch.pairs.first.shape
    assert checkpoint.keys() == grown.keys()


def test_what_a_checkpoint_cannot_hold_is_refused_rather_than_forgotten() -> None:
    run = simulate(shot())
    run._method.memory = {"of": 1.0}
    with pytest.raises(TypeError, match=r"\._method\.memory is a dict"):
        run.checkpoint()


@pytest.mark.parametrize("change", ["run/step_control.py", "physics/section.py"])
def test_a_state_is_of_all_of_the_code_that_computed_it(monkeypatch, tmp_path, change: str) -> None:
    """It was of the kernels' alone: one with other steps went on from it, and was the run of no version."""
    solver = Path(shutil.copytree(Path(kernel.__file__).parents[1], tmp_path / "solver"))
    monkeypatch.setattr(kernel, "__file__", str(solver / "kernels" / "kernel.py"))
    monkeypatch.setattr(checkpoints, "__file__", str(solver / "run" / "checkpoint.py"))
    monkeypatch.setattr(checkpoints, "kernels_digest", kernel.code_digest.__wrapped__)
    before = checkpoints.code_digest.__wrapped__()
    assert checkpoints.code_digest.__wrapped__() == before
    with (solver / change).open("a") as source:
        source.write("# changed\n")
    assert checkpoints.code_digest.__wrapped__() != before
