"""Rods that fall from where they are held at first: statics finds where they rest."""

from __future__ import annotations

from dataclasses import replace
from math import pi

import numpy as np
import pytest
from numpy.testing import assert_allclose

from solver import (
    Condition,
    Contact,
    Curve,
    DistributedLoad,
    End,
    Frame,
    Initial,
    Numerics,
    PointLoad,
    RunFailed,
    Scene,
    simulate,
)
from solver.arrays import Array
from solver.physics.loads.solids import Floor
from solver.run.settling import settled
from solver.statics.equations import Equations
from solver.statics.point import FORCE, X
from tests.solver.scenes import ARC, ARC_ROD, EJ, LENGTH, ROPE
from tests.solver.statics.resting import ramp, static

WEIGHT = (0.0, 0.0, -9.81)
N = 32


def coil(s: Array) -> Array:
    """Three turns that rise from the origin."""
    turn, pitch = 2.0 * pi * 3.0 / LENGTH, 0.3
    radius = np.sqrt(1.0 - pitch**2) / turn
    return np.column_stack([radius * (np.cos(turn * s) - 1.0), radius * np.sin(turn * s), pitch * s])


def above_its_pin(**changes: object) -> Scene:
    """A limp rope, coiled above the pin from which it will hang."""
    return static(rod=ROPE, initial=Initial(coil), start=End.pin(), gravity=WEIGHT,
                  numerics=Numerics("staggered", intervals=N), **changes)  # fmt: skip


@pytest.mark.parametrize("contact", [None, Contact()], ids=["", "with contact"])
def test_a_rope_above_its_pin_falls_and_hangs(contact: Contact | None) -> None:
    first = next(iter(simulate(above_its_pin(contact=contact))))
    assert first.negative_modes == 0
    assert_allclose(first.r[-1], [0.0, 0.0, -LENGTH], atol=1e-6)
    weight = 9.81 * float(ROPE.mass(0.0)) * LENGTH
    assert_allclose(first.f[:, 2], weight * (1.0 - np.linspace(0.0, 1.0, N + 1)), atol=1e-6 * weight)
    assert first.energy_contact == 0.0
    assert first.energy_kinetic == 0.0


def test_a_stiff_rod_that_stands_on_a_pin_does_not_stay_there() -> None:
    """Upright it is balanced, and in two directions falls: it rests below."""
    leaning = Initial.straight(direction=(0.3, 0.1, 1.0))
    frames = list(simulate(static(initial=leaning, start=End.pin(), gravity=WEIGHT)))
    assert {frame.negative_modes for frame in frames} == {0}
    assert_allclose(frames[0].r[-1], [0.0, 0.0, -LENGTH], atol=1e-8)


def test_where_it_rests_all_is_balanced() -> None:
    equations = Equations(above_its_pin())
    rest = settled(equations, above_its_pin())
    equations.begin(rest.point, rest.energy_contact)
    equations.let_go()
    left = equations.residual(rest.point)
    assert np.abs(left[:, X]).max() < 1e-3 * equations.loading()
    assert np.abs(left[:, FORCE]).max() < 1e-9


def test_loads_and_ends_stay_as_they_are_at_first_while_a_rod_settles() -> None:
    """What they do later changes nothing of where it rests."""
    loads = {"points": (PointLoad(LENGTH, (ramp(5.0), ramp(0.0), ramp(0.0))),),
             "distributed": (DistributedLoad((Curve.constant(1.0),) * 3, schedule=ramp(3.0)),)}  # fmt: skip
    pin = End.pin()
    moved = replace(pin, frame="lab", translation=((Condition("position", ramp(0.2)),), *pin.translation[1:]))
    plain, other = above_its_pin(), replace(above_its_pin(**loads), start=moved)
    rests = [settled(Equations(scene), scene).point for scene in (plain, other)]
    assert_allclose(rests[1].quaternion, rests[0].quaternion, atol=1e-12)


def test_a_rod_that_falls_onto_a_floor_lies_on_it() -> None:
    floor = Floor(height=-0.3, stiffness=1e3)
    first: Frame = next(iter(simulate(above_its_pin(loads=(floor,)))))
    assert first.negative_modes == 0
    assert first.r[:, 2].min() > -0.3 - ROPE.diameter(0.0)


ASIDE = (ramp(3.0 * EJ / LENGTH**2), ramp(-4.0 * EJ / LENGTH**2), Curve.constant(0.0))


def test_a_rod_on_a_pin_turns_to_where_its_first_loads_pull() -> None:
    """Nothing holds it at t = 0: there it stays as it was laid."""
    pulled = (PointLoad(LENGTH, ASIDE),)
    first, *later = simulate(static(start=End.pin(), points=pulled, output_interval=0.25))
    assert_allclose(first.r[-1], [0.0, 0.0, LENGTH], atol=1e-9)
    for frame in later:
        assert_allclose(frame.r[-1], [0.6 * LENGTH, -0.8 * LENGTH, 0.0], atol=1e-6)
        assert frame.negative_modes == 0
        assert_allclose(np.linalg.norm(frame.f, axis=1), 5.0 * EJ / LENGTH**2 * frame.t, rtol=1e-6)


@pytest.mark.parametrize(("load", "free"), [(Curve.table([0.05, 1.0], [0.0, EJ]), 5),
                                            (Curve.table([0.0, 1.0], [0.0, EJ], "smoothstep"), 0)])  # fmt: skip
def test_until_its_first_loads_are_there_a_rod_stays_as_it_lies(load: Curve, free: int) -> None:
    still = Curve.constant(0.0)
    pulled = static(start=End.pin(), points=(PointLoad(LENGTH, (load, still, still)),), output_interval=0.01)
    frames = list(simulate(pulled))
    assert [frame.parameter for frame in frames] == pytest.approx(np.linspace(0.0, 1.0, 101), abs=1e-9)
    for frame in frames[: free + 1]:
        assert_allclose(frame.r[-1], [0.0, 0.0, LENGTH], atol=1e-9)
    for frame in frames[free + 1 :]:
        assert_allclose(frame.r[-1], [LENGTH, 0.0, 0.0], atol=1e-6)


def test_a_hook_that_hangs_turns_about_the_vertical_to_its_first_load() -> None:
    """Its tip goes where the load has it lowest, in the plane of weight and load."""
    hook = static(rod=ARC_ROD, initial=ARC, start=End.pin(), gravity=(0.0, 0.0, 1.0), output_interval=0.1,
                  points=(PointLoad(LENGTH, ASIDE),))  # fmt: skip
    first, *later = simulate(hook)
    assert_allclose(first.r[:, 1], 0.0, atol=1e-9)
    across = np.array([0.8, 0.6, 0.0])
    for frame in later:
        assert_allclose(frame.r @ across, 0.0, atol=1e-4 * LENGTH)
        assert frame.r[-1] @ [0.6, -0.8, 0.0] > 0.0
        assert frame.negative_modes == 0


@pytest.mark.parametrize("scene", [
    above_its_pin(output_interval=0.25, points=(PointLoad(LENGTH, ASIDE),)),
    static(start=End.pin(), points=(PointLoad(LENGTH, ASIDE),), output_interval=0.25),
], ids=["settled", "turned"])  # fmt: skip
@pytest.mark.parametrize("many", [1, 2])
def test_a_run_that_is_restored_goes_on_as_it_would_have(scene: Scene, many: int) -> None:
    run, again = simulate(scene), simulate(scene)
    frames = iter(run)
    for _ in range(many):
        next(frames)
    again.restore(run.checkpoint())
    for expected, frame in zip(frames, again, strict=True):
        assert (frame.r == expected.r).all()
        assert frame.negative_modes == expected.negative_modes


def test_what_turns_as_a_whole_while_an_end_moves_is_refused() -> None:
    pin = End.pin()
    moved = replace(pin, frame="lab", translation=((Condition("position", ramp(0.2)),), *pin.translation[1:]))
    with pytest.raises(RunFailed, match="nothing holds the rod"):
        list(simulate(static(start=moved, points=(PointLoad(LENGTH, ASIDE),))))


def test_what_motion_does_not_take_is_held_where_it_lies() -> None:
    """A force that follows the rod, at an end that is free along lab axes: a static analysis alone takes it."""
    free = replace(End.free(), frame="lab")
    push = PointLoad(LENGTH, (Curve.constant(0.0), Curve.constant(0.0), Curve.constant(-30.0 * EJ)), frame="material")
    first = next(iter(simulate(static(end=free, points=(push,)))))
    assert first.negative_modes > 0


def test_a_rod_whose_first_way_is_stable_is_not_set_in_motion(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("solver.run.equilibria.settled", lambda *_: pytest.fail("it was"))
    first = next(iter(simulate(static(gravity=(0.0, 1.0, 0.0)))))
    assert first.negative_modes == 0
