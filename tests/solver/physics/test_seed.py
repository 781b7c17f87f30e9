"""A straight rod that its ends shorten beyond its critical load buckles by a load that is added across it."""

from __future__ import annotations

from dataclasses import replace
from math import pi

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.special import ellipe, ellipk

from solver import Condition, Curve, DistributedLoad, End, Initial, Numerics, Scene, constant_vector, simulate
from solver.physics.elasticity import Stretch
from solver.physics.loads.solids import Floor
from solver.physics.seed import SMALL, seed_of, seeded
from solver.scene.ends import FIXED, FREE
from tests.solver.scenes import DIAMETER, EJ, LENGTH, ROD

TIME = LENGTH**2 * np.sqrt(float(ROD.mass(0.0)) / EJ)
CRITICAL = pi**2 / 16.0 * (DIAMETER / LENGTH) ** 2
"""Strain of a bar between pins that buckles: P = EA eps, EA = 16 EJ / D^2."""


def shortened(by: float, **changes: object) -> Scene:
    """A rod between pins, of which one comes nearer by a part of its length, and stays there."""
    near = Condition("position", Curve.table([0.0, 4.0 * TIME], [0.0, -by * LENGTH], "smoothstep"))
    end = End((FIXED, FIXED, (near,)), (FREE,) * 3, "lab")
    scene = Scene(ROD, Initial.straight(), End.pin(), end, 6.0 * TIME, 0.5 * TIME, damping=2.0 / TIME,
                  numerics=Numerics("staggered", intervals=20))  # fmt: skip
    return replace(scene, **changes)  # type: ignore[arg-type]


def elastica(shorter: float) -> float:
    """How far, in lengths, the middle of one between pins goes that is shorter by a part of its length (Love 1927)."""
    k = brentq(lambda k: 2.0 - 2.0 * ellipe(k * k) / ellipk(k * k) - shorter, 1e-3, 0.99)
    return float(k / ellipk(k * k))


@pytest.mark.parametrize("analysis", ["dynamic", "static"])
@pytest.mark.parametrize("numerics", [
    Numerics("staggered", intervals=20), Numerics("staggered", tolerance=1e-2, most_intervals=80),
])  # fmt: skip
def test_it_buckles_and_says_so(numerics: Numerics, analysis: str) -> None:
    run = simulate(shortened(0.2, numerics=numerics, analysis=analysis))
    *_, frame = run
    across = float(np.abs(frame.r[:, :2]).max())
    assert across == pytest.approx(elastica(0.2) * LENGTH, rel=0.01)
    assert run.attributes()["buckling_seed"] == pytest.approx(SMALL * EJ / LENGTH**3)
    assert any("was added across it" in note for note in run.notes())


@pytest.mark.parametrize("softer", [0, 1])
def test_it_goes_to_where_it_bends_most_easily(softer: int) -> None:
    stiffness = [Curve.constant(4.0 * EJ), Curve.constant(4.0 * EJ), ROD.stiffness[2]]
    stiffness[softer] = Curve.constant(EJ)
    seed = seed_of(shortened(0.1, rod=replace(ROD, stiffness=tuple(stiffness))))
    assert seed is not None
    force = np.array([float(part(np.zeros(1))[0]) for part in seed.force])
    assert force == pytest.approx(SMALL * EJ / LENGTH**3 * np.eye(3)[1 - softer])


@pytest.mark.parametrize("changes", [
    {"gravity": (9.81, 0.0, 0.0)}, {"end": End.slider()}, {"loads": (Floor(1.0),)},
    {"distributed": (DistributedLoad(constant_vector((0.0, 1e-9, 0.0))),)},
])  # fmt: skip
def test_none_is_given_where_something_else_says_where_to_or_may_hold_it(changes: dict[str, object]) -> None:
    scene = shortened(0.1, **changes)
    assert seed_of(scene) is None and seeded(scene) is scene


@pytest.mark.parametrize("rod", [ROD, replace(ROD, laws=(Stretch(Curve.constant(16.0 * EJ / DIAMETER**2)),))])
@pytest.mark.parametrize(("part", "given"), [(0.95, False), (1.05, True), (-100.0, False)])
def test_none_is_given_to_what_is_pressed_less_than_it_bears(rod: object, part: float, given: bool) -> None:
    assert (seed_of(shortened(part * CRITICAL, rod=rod)) is not None) == given


@pytest.mark.parametrize(("part", "added"), [(0.95, False), (1.05, True)])
def test_a_waist_counts_by_how_short_it_is(part: float, added: bool) -> None:
    """Of what its law gives it, the rod has the compliances one after another."""
    EA = 16.0 * EJ / DIAMETER**2
    waist = Curve.table(LENGTH * np.array([0.0, 0.45, 0.5, 0.55, 1.0]), EA * np.array([1.0, 1.0, 0.1, 1.0, 1.0]))
    s = np.linspace(0.0, LENGTH, 2001)
    mean = LENGTH / float(np.trapezoid(1.0 / waist(s), s))
    scene = shortened(part * pi**2 * EJ / LENGTH**2 / mean, rod=replace(ROD, laws=(Stretch(waist),)))
    assert (seed_of(scene) is not None) == added
