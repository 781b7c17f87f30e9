"""Curvature where a taut rod is clamped at an angle, and bends in a layer thinner than an interval."""

from __future__ import annotations

from dataclasses import replace
from math import cos, pi, sin, sqrt

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from solver import Curve, End, Numerics, PointLoad, Scene
from solver.methods.space.segments.end_layers import EndLayers
from solver.physics.elasticity import Softening
from tests.solver.scenes import EJ, LENGTH, ROD, last
from tests.solver.statics.resting import ZERO, static

THIN = 0.01 * LENGTH
"""lambda; an interval of N = 16 is six times as long."""


def pulled(angle: float, intervals: int = 16, around: float = 0.0, held: str = "start", **changes: object) -> Scene:
    """A rod clamped at one end under a tension that makes its layer THIN, first along itself, then at an angle, in the
    plane that lies `around` e3 by so much."""
    T = EJ / THIN**2 if held == "start" else -EJ / THIN**2
    aside = [Curve.table([0.0, 0.5, 1.0], [0.0, 0.0, T * sin(angle) * part]) for part in (cos(around), sin(around))]
    along = Curve.table([0.0, 0.5, 1.0], [0.0, T, T * cos(angle)])
    start, end, s = (End.clamp(), End.free(), LENGTH) if held == "start" else (End.free(), End.clamp(), 0.0)
    return static(start=start, end=end, points=(PointLoad(s, (*aside, along)),),
                  numerics=Numerics("staggered", intervals=intervals), **changes)  # fmt: skip


def at_clamp(angle: float) -> float:
    """2 / lambda sin(angle / 2), of the half infinite elastica."""
    return 2.0 / THIN * sin(0.5 * angle)


@pytest.mark.parametrize("intervals", [8, 16, 32, 64, 128])
@pytest.mark.parametrize(("angle", "within"), [(0.1, 5e-4), (0.6, 0.01), (1.5, 0.06)])
def test_a_clamped_end_has_the_elastica_s_curvature_on_any_mesh(intervals: int, angle: float, within: float) -> None:
    frame = last(pulled(angle, intervals, around=0.5))
    assert np.hypot(*frame.kappa[0, :2]) == pytest.approx(at_clamp(angle), rel=within)
    # the moment is the one that balances the load at the tip as this mesh has it
    T = EJ / THIN**2 * np.array([sin(angle) * cos(0.5), sin(angle) * sin(0.5), cos(angle)])
    assert frame.q[0] == pytest.approx(np.cross(frame.r[-1], T), abs=1e-6 * EJ / THIN)


def test_without_it_the_first_joint_tells_the_mesh(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(EndLayers, "complete", lambda layers, fields, held: fields)
    assert last(pulled(0.1)).kappa[0, 1] < 0.35 * at_clamp(0.1)


@pytest.mark.parametrize("held", ["start", "end"])
@pytest.mark.parametrize("around", [0.0, 0.7])
def test_at_both_ends_and_in_motion_it_is_as_at_rest(around: float, held: str) -> None:
    """About one axis, where it lies in a plane of the frame, and in space."""
    still, at = last(pulled(0.4, around=around)), {"start": 0, "end": -1}[held]
    moving = pulled(0.4, around=around, held=held, analysis="dynamic", damping=2.0 * WAVE)
    moving = replace(moving, numerics=replace(moving.numerics, dt_max=0.05), t_end=3.0, output_interval=3.0)
    assert np.hypot(*last(moving).kappa[at, :2]) == pytest.approx(np.hypot(*still.kappa[0, :2]), rel=1e-3)


WAVE = pi / LENGTH * sqrt(EJ / THIN**2 / float(ROD.mass(0.0)))
"""Circular frequency of the first wave under the tension, rad/s."""


@pytest.mark.parametrize(("start", "pull"), [(End.pin(), 1.0), (End.clamp(), -1.0)])
def test_where_nothing_is_held_or_pulled_nothing_is_added(
    start: End, pull: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A pin bears no moment; a rod that is pressed has no layer."""
    load = PointLoad(0.5 * LENGTH, (Curve.constant(0.1 * EJ), ZERO, Curve.constant(pull * EJ)))
    scene = static(start=start, end=End.pin(), points=(load,))
    with_it = last(scene)
    monkeypatch.setattr(EndLayers, "complete", lambda layers, fields, held: fields)
    assert_array_equal(with_it.kappa, last(scene).kappa)


def test_a_law_whose_moment_is_not_proportional_to_curvature_has_none() -> None:
    softening = Softening(Curve.constant(EJ), Curve.constant(1.0))
    s = np.linspace(0.0, LENGTH, 17)
    assert len(EndLayers.of(replace(ROD, laws=(softening,)), s).EJ) == 0
    assert len(EndLayers.of(ROD, s).EJ) == 2
