"""A ring whose ends are held is closed by a straight line: its writhe is that of a closed curve."""

from __future__ import annotations

from functools import partial
from math import pi

import numpy as np
import pytest

from solver import (
    Condition,
    Contact,
    Curve,
    DistributedLoad,
    End,
    Frame,
    Initial,
    Numerics,
    Scene,
    constant_vector,
    simulate,
)
from solver.arrays import Array
from solver.measures.passages import Passages, Shape, passages
from solver.measures.ring import is_ring
from solver.measures.topology import NO_RAYS, writhe_of_rod, writhe_shares
from tests.solver.scenes import EJ, LENGTH, ROD, turned_clamp
from validation.writhe import writhe_closed

GAP = 0.02


def circle(part: float, s: Array | None = None) -> Array:
    """So much of a circle."""
    a = 2.0 * pi * part * (np.linspace(0.0, 1.0, 201) if s is None else s / LENGTH)
    return LENGTH / (2.0 * pi * part) * np.column_stack([1.0 - np.cos(a), 0.0 * a, np.sin(a)])


def lifted(points: int, part: float = 1.0 - GAP) -> Array:
    """The same out of its plane."""
    a = np.linspace(0.0, 2.0 * pi * part, points)
    return np.column_stack([1.0 - np.cos(a), 0.9 * np.sin(2.0 * a) + 0.5 * np.sin(3.0 * a), np.sin(a)])


def ring(turns: float, contact: Contact | None = None, part: float = 1.0 - GAP, start: End | None = None) -> Scene:
    end = turned_clamp(Condition("position", Curve.table([0.0, 1.0], [0.0, 2.0 * pi * turns], "smoothstep")))
    return Scene(ROD, Initial(partial(circle, part)), start or End.clamp(), end, 2.6, 0.26, contact=contact,
                 damping=1.0, distributed=(DistributedLoad(constant_vector((0.0, 0.1 * EJ, 0.0))),),
                 numerics=Numerics("staggered", intervals=64, dt_max=0.02))  # fmt: skip


def off(frames: list[Frame]) -> float:
    return max(abs(frame.Tw + frame.Wr - frame.Lk) for frame in frames)


@pytest.mark.parametrize("points", [16, 65, 200])
def test_its_writhe_is_that_of_the_closed_polygon(points: int) -> None:
    r = lifted(points)
    expected, orientation = writhe_closed(r), np.tile([1.0, 0.0, 0.0, 0.0], (points, 1))
    assert abs(expected) > 0.01
    assert writhe_of_rod(r, orientation, ring=True) == pytest.approx(expected, abs=1e-13)
    assert sum(writhe_shares(r, NO_RAYS)) == pytest.approx(expected, abs=1e-13)


def test_a_ring_with_a_gap_that_is_twisted_has_no_jumps_and_no_writhe_until_it_buckles() -> None:
    """The rays at its ends crossed each other in the gap: Wr was 1 or -1, as rounding had it."""
    run = simulate(ring(2.5, Contact()))
    frames = list(run)
    assert run.remarks.end_hops == run.remarks.unclear_jumps == 0
    assert off(frames) < 1e-3
    assert abs(frames[5].Wr) < 0.01 < 1.0 < frames[-1].Wr
    assert frames[-1].Lk == pytest.approx(2.5, abs=1e-9)


def test_what_passes_through_the_gap_hops_over_an_end() -> None:
    r = circle(1.0 - GAP)
    middle = 0.5 * (r[0] + r[-1])

    def shape(x: float) -> Shape:
        """The ring, with a strand that leads from opposite the gap across its plane, beside the gap's middle."""
        across = np.column_stack([np.full(21, x), np.linspace(-0.3, 0.3, 21), np.zeros(21)])
        return Shape(np.vstack([r[:100], middle + across, r[101:]]), NO_RAYS)

    seen = passages(shape(-0.01), shape(0.01))
    assert seen.crossings == 0 and abs(seen.hops) == 1
    assert passages(shape(0.01), shape(0.02)) == Passages(0, 0)


RINGS = {
    "a gap": (ring(1.0), True), "a wide gap": (ring(1.0, part=0.94), True),
    "a gap of rounding": (ring(1.0, part=1.0 - 1e-15), False),
    "a gap that no mesh shows": (ring(1.0, part=1.0 - 1e-8), False),
    "half a ring": (ring(1.0, part=0.5), False), "ends that overlap": (ring(1.0, part=1.03), False),
    "an end that leans": (ring(1.0, start=End.pin()), False),
    "an end that slides": (ring(1.0, start=End.slider()), False),
}  # fmt: skip


@pytest.mark.parametrize(("scene", "so"), RINGS.values(), ids=RINGS)
def test_what_is_a_ring(scene: Scene, so: bool) -> None:
    assert is_ring(scene) is so
