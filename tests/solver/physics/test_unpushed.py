"""A straight rod that its ends press, and that nothing else pushes aside, buckles by a push that it is given."""

from __future__ import annotations

from dataclasses import replace
from math import pi

import numpy as np
import pytest

from solver import Condition, Curve, DistributedLoad, End, Initial, Numerics, Scene, constant_vector, simulate
from solver.physics.elasticity import Stretch
from solver.physics.loads.solids import Floor
from solver.physics.unpushed import SMALL, push_for, pushed
from solver.scene.ends import FIXED, FREE
from tests.solver.scenes import DIAMETER, EJ, LENGTH, ROD

TIME = LENGTH**2 * np.sqrt(float(ROD.mass(0.0)) / EJ)
CRITICAL = pi**2 / 16.0 * (DIAMETER / LENGTH) ** 2
"""Strain of a bar between pins that buckles: P = EA eps, EA = 16 EJ / D^2."""


def pressed(by: float, **changes: object) -> Scene:
    """A rod between pins, of which one comes nearer by a part of its length."""
    near = Condition("position", Curve.table([0.0, 4.0 * TIME], [0.0, -by * LENGTH], "smoothstep"))
    end = End((FIXED, FIXED, (near,)), (FREE,) * 3, "lab")
    scene = Scene(ROD, Initial.straight(), End.pin(), end, 6.0 * TIME, 0.5 * TIME, damping=2.0 / TIME,
                  numerics=Numerics("staggered", intervals=20))  # fmt: skip
    return replace(scene, **changes)  # type: ignore[arg-type]


@pytest.mark.parametrize("numerics", [Numerics("staggered", intervals=20), Numerics("staggered", tolerance=1e-2)])
def test_it_buckles_and_says_so(numerics: Numerics) -> None:
    run = simulate(pressed(0.2, numerics=numerics))
    *_, frame = run
    across = float(np.abs(frame.r[:, :2]).max())
    assert across == pytest.approx(0.2633 * LENGTH, rel=0.05)  # the elastica's
    assert run.attributes()["push_aside"] == pytest.approx(SMALL * EJ / LENGTH**3)
    assert any("push aside" in note for note in run.notes())


@pytest.mark.parametrize("softer", [0, 1])
def test_it_goes_to_where_it_bends_most_easily(softer: int) -> None:
    stiffness = [Curve.constant(4.0 * EJ), Curve.constant(4.0 * EJ), ROD.stiffness[2]]
    stiffness[softer] = Curve.constant(EJ)
    push = push_for(pressed(0.1, rod=replace(ROD, stiffness=tuple(stiffness))))
    assert push is not None
    force = np.array([float(part(np.zeros(1))[0]) for part in push.force])
    assert force == pytest.approx(SMALL * EJ / LENGTH**3 * np.eye(3)[1 - softer])


@pytest.mark.parametrize("changes", [
    {"analysis": "static"}, {"gravity": (9.81, 0.0, 0.0)}, {"end": End.slider()}, {"loads": (Floor(1.0),)},
    {"distributed": (DistributedLoad(constant_vector((0.0, 1e-9, 0.0))),)},
])  # fmt: skip
def test_none_is_given_where_something_else_says_where_to_or_may_hold_it(changes: dict[str, object]) -> None:
    scene = pressed(0.1, **changes)
    assert push_for(scene) is None and pushed(scene) is scene


@pytest.mark.parametrize("rod", [ROD, replace(ROD, laws=(Stretch(Curve.constant(16.0 * EJ / DIAMETER**2)),))])
@pytest.mark.parametrize(("part", "given"), [(0.95, False), (1.05, True), (-100.0, False)])
def test_none_is_given_to_what_is_pressed_less_than_it_bears(rod: object, part: float, given: bool) -> None:
    assert (push_for(pressed(part * CRITICAL, rod=rod)) is not None) == given
