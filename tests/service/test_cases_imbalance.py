"""What sets a rod moving by itself: by how much it is out of balance where it begins."""

from __future__ import annotations

from dataclasses import replace

import pytest

from service.cases.imbalance import imbalance
from solver import Condition, Curve, DistributedLoad, End, Initial, Numerics, PointLoad, Scene, constant_vector
from tests.solver.scenes import ARC, ARC_ROD, BEND, EJ, LENGTH, MASS, ROD

SIDEWAYS, DOWN = (1.0, 0.0, 0.0), (0.0, 0.0, 1.0)
W = MASS * LENGTH**3 / EJ
"""The weight, in EJ/L^2, at 1 m/s^2."""


def rod(**changes: object) -> Scene:
    """A straight cantilever along e3, at rest, changed."""
    scene = Scene(rod=ROD, initial=Initial.straight(), start=End.clamp(), end=End.free(), t_end=1.0,
                  output_interval=1.0, numerics=Numerics("staggered"))  # fmt: skip
    return replace(scene, **changes)  # type: ignore[arg-type]


def test_an_arc_between_clamps_is_in_balance_and_springs_where_it_is_let_go():
    assert imbalance(rod(initial=ARC, end=End.clamp())) < 1e-3
    assert imbalance(rod(initial=ARC)) == pytest.approx(BEND, rel=1e-2)
    assert imbalance(rod(initial=ARC, rod=ARC_ROD)) < 1e-3


@pytest.mark.parametrize(("start", "end", "part"), [
    (End.clamp(), End.free(), 1 / 2), (End.free(), End.clamp(), 1 / 2), (End.clamp(), End.clamp(), 1 / 12),
    (End.pin(), End.pin(), 1 / 8),
])  # fmt: skip
def test_a_beam_under_its_weight_lacks_the_moment_that_bears_it(start: End, end: End, part: float):
    """w L^2 / 2 of a cantilever, w L^2 / 8 of a beam on pins; of one that is clamped what no force there bears."""
    assert imbalance(rod(start=start, end=end, gravity=SIDEWAYS)) == pytest.approx(part * W, rel=2e-2)


def test_a_rod_that_hangs_along_its_weight_is_in_balance():
    assert imbalance(rod(gravity=DOWN)) < 1e-9 * W


@pytest.mark.parametrize("s", [0.0, 0.5 * LENGTH, LENGTH])
@pytest.mark.parametrize("frame", ["lab", "material"])
def test_a_force_lacks_the_moment_of_its_lever(s: float, frame: str):
    load = PointLoad(s, constant_vector((2.0, 0.0, 0.0)), frame=frame)
    assert imbalance(rod(points=(load,))) == pytest.approx(2.0 * s * LENGTH / EJ, rel=2e-2, abs=1e-9)


def test_loads_count_as_they_are_at_first():
    later, none = Curve.table([0.0, 1.0], [0.0, 1.0]), Curve.constant(0.0)
    spread = DistributedLoad(constant_vector((3.0, 0.0, 0.0)), schedule=later)
    assert imbalance(rod(points=(PointLoad(LENGTH, (later, none, none)),), distributed=(spread,))) == 0.0
    pushed = replace(End.free(), translation=((Condition("load", Curve.constant(5.0)),), *End.free().translation[1:]))
    assert imbalance(rod(end=pushed)) == pytest.approx(5.0 * LENGTH**2 / EJ, rel=1e-2)
