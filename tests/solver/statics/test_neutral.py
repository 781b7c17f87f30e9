"""Of equilibria that turn into each other a branch goes on from the nearest: no mesh turns the rod another way."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from solver import FIXED, FREE, Condition, Curve, DistributedLoad, End, Initial, Numerics, constant_vector, simulate
from solver.arrays import Array
from solver.scene.layout import nodes_at_rest
from tests.solver.scenes import LENGTH, ROD
from tests.solver.statics.resting import ramp, static

SKEWED = np.array([0.6, 0.64, 0.48])
"""The direction of a chord."""
ACROSS = np.cross(SKEWED, [1.0, 0.0, 0.0])


def bowed(angle: float) -> Initial:
    """An arc that turns by `angle` (rad), in a plane askew."""
    one, two = SKEWED, np.cross(ACROSS, SKEWED) / np.linalg.norm(ACROSS)

    def curve(s: Array) -> Array:
        turned = angle * (s / LENGTH - 0.5)
        return LENGTH / angle * (np.outer(np.sin(turned), one) + np.outer(np.cos(turned), two))

    return Initial(curve)


def pushed(distance: float) -> End:
    """A pin that comes nearer to the start by so much of the rod's length."""
    along = tuple((Condition("position", ramp(-float(x))),) for x in distance * LENGTH * SKEWED)
    return End(along, (FREE, FREE, FREE), frame="lab")


@pytest.mark.parametrize("intervals", [64, 511])
@pytest.mark.parametrize("angle", [0.02, 0.9])
def test_a_bow_between_two_pins_stays_in_its_plane(angle: float, intervals: int) -> None:
    """One that is bent without stress, and so flat at first that it has to stretch."""
    numerics, initial = Numerics("staggered", intervals=intervals), bowed(angle)
    _, _, kappa = nodes_at_rest(initial, np.linspace(0.0, LENGTH, 65))
    rod = replace(ROD, kappa0=constant_vector(tuple(kappa[32])))
    scene = static(rod=rod, initial=initial, start=End.pin(), end=pushed(0.3), numerics=numerics, output_interval=0.1)
    for frame in simulate(scene):
        assert np.abs(frame.r @ ACROSS).max() < 1e-5 * LENGTH
        assert frame.neutral_modes == 1


def test_a_bow_is_followed_to_a_tolerance_on_coarse_meshes() -> None:
    scene = static(initial=bowed(0.5), start=End.pin(), end=pushed(0.4), numerics=Numerics("staggered", tolerance=1e-3))
    run = simulate(scene)
    *_, frame = run
    assert len(run.s) - 1 <= 64
    assert_allclose(frame.r @ ACROSS, 0.0, atol=1e-4 * LENGTH)


def test_what_its_load_turns_is_turned() -> None:
    """A rod on a pin that hangs, and is pulled aside by its end."""
    curve = Curve.table([0.0, 1.0], [0.0, 9.81])
    aside = tuple((Condition("load", c),) for c in (Curve.constant(1e-2), curve, Curve.constant(0.0)))
    hanging = Initial.straight(direction=(1.0, 0.0, 0.0))
    scene = static(initial=hanging, start=End.pin(), end=End(aside, (FREE, FREE, FREE), frame="lab"))
    *_, frame = simulate(scene)
    tension = np.array([1e-2, 9.81, 0.0])
    assert_allclose(frame.r[-1], LENGTH * tension / np.linalg.norm(tension), atol=1e-6)


@pytest.mark.parametrize("side", [1e-9, 1e-7])
def test_a_buckle_that_next_to_nothing_turns_about_its_rod_is_followed_past_its_fold(side: float) -> None:
    """As an umbilical of 60 m with 7 turns, which throws a hockle when it is slack: what says to which side is 1e-9 of
    its weight, and turns the buckle about the rod by far less than rounding does."""
    length, pull = 60.0, 20.0
    rod = replace(ROD, length=length, stiffness=constant_vector((30.0, 30.0, 40.0)), diameter=Curve.constant(0.02),
                  mass=Curve.constant(0.6))  # fmt: skip
    turned = Initial.straight(direction=(1.0, 0.0, 0.0), twist=Curve.table([0.0, length], [0.0, 45.0]))
    slack = Curve.table([0.0, 1.0], [pull, 0.1 * pull])
    end = End((FIXED, FIXED, (Condition("load", slack),)), (FIXED, FIXED, FIXED))
    load = DistributedLoad(constant_vector((0.0, 0.0, side)))
    scene = static(rod=rod, initial=turned, start=End.clamp(), end=end, distributed=(load,),
                   output_interval=0.1, numerics=Numerics("staggered", intervals=128))  # fmt: skip
    *_, last = simulate(scene)
    assert last.t == 1.0
    assert last.parameter < 0.6 and last.negative_modes == 1  # back from the fold at .7, and along a loop that opens
