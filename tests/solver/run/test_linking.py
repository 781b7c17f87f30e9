"""Tw + Wr = Lk whatever the ends do: also where their tangents move."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from solver import FREE, Condition, Curve, End, Fluid, Frame, Initial, Numerics, Scene, simulate
from solver.arrays import Array
from tests.solver.scenes import LENGTH, ROD, turned_clamp

HOOKED = replace(ROD, kappa0=(Curve.constant(0.0), Curve.table([0.0, 0.7, 0.71, LENGTH], [0.0, 0.0, 6.0, 6.0]),
                              Curve.constant(0.0)))  # fmt: skip


def hook(s: Array) -> Array:
    """Straight along e3, with its end bent by 100 degrees."""
    angle = np.maximum(6.0 * (s - 0.705), 0.0)
    bent = np.column_stack([1.0 - np.cos(angle), 0.0 * s, np.sin(angle)]) / 6.0
    return bent + np.outer(np.minimum(s, 0.705), [0.0, 0.0, 1.0])


def turned(turns: float) -> Scene:
    """A hook whose straight end is turned in water, so that it turns as a whole: its tip's tangent goes in circles."""
    start = turned_clamp(Condition("position", Curve.table([0.0, 4.0], [0.0, 2.0 * np.pi * turns], "smoothstep")))
    return Scene(HOOKED, Initial(hook), start, End.free(), 4.0, 0.5, fluid=Fluid(1000.0, 1.0, 1.0, 0.0))


def off(frames: list[Frame]) -> float:
    """The largest |Tw + Wr - Lk|."""
    return max(abs(frame.Tw + frame.Wr - frame.Lk) for frame in frames)


@pytest.mark.parametrize(("method", "aim"), [("staggered", 1e-8), ("box", 3e-3)])
def test_a_hook_that_turns_as_a_whole_is_not_wound_up(method: str, aim: float) -> None:
    """Lk was taken to fall by as many turns, and a run with contact to pass through itself twice a frame."""
    numerics = Numerics(method=method, intervals=40, dt_max=0.02)  # type: ignore[arg-type]
    frames = list(simulate(replace(turned(5.0), numerics=numerics)))
    assert off(frames) < aim
    assert abs(frames[-1].Lk) < 0.3


def test_frames_within_steps_and_steps_that_begin_anew_have_it_too() -> None:
    numerics = Numerics(method="staggered", intervals=20, dt_max=0.02, strides=5)
    thrown = Initial.straight(velocity=(1.0, 0.0, 2.0), angular_velocity=(3.0, 40.0, 9.0))
    scene = Scene(replace(HOOKED, kappa0=ROD.kappa0), thrown, End.free(), End.free(), 1.0, 0.02,
                  gravity=(0.0, 0.0, -9.81), numerics=numerics)  # fmt: skip
    assert off(list(simulate(scene))) < 1e-6


def test_clamps_have_exactly_what_they_are_turned_by() -> None:
    numerics = Numerics(method="staggered", intervals=10, dt_max=0.05)
    end = turned_clamp(Condition("position", Curve.table([0.0, 1.0], [0.0, 1.0])))
    frames = list(simulate(Scene(ROD, Initial(hook), End.clamp(), end, 1.0, 0.25, numerics=numerics)))
    expected = [frame.t / (2.0 * np.pi) for frame in frames]
    assert [frame.Lk - frames[0].Lk for frame in frames] == pytest.approx(expected, abs=1e-15)


def test_a_free_end_may_be_free_of_moment_and_of_nothing_else() -> None:
    assert End.clamp().holds_tangent() and End.slider().holds_tangent()
    assert not End.pin().holds_tangent() and not End.free().holds_tangent()
    swung = replace(End.clamp(), rotation=((Condition("position", Curve.table([0.0, 1.0], [0.0, 1.0])),), FREE, FREE))
    assert not swung.holds_tangent()
