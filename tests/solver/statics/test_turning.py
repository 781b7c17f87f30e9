"""Ends that are driven to turn about several of their own axes lie where integrating their rates leads."""

from __future__ import annotations

from itertools import pairwise
from math import pi

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from solver import FIXED, Condition, Curve, End, Numerics
from solver.arrays import Array
from solver.statics.turning import Turning
from tests.solver.scenes import ARC, ARC_ROD, last
from tests.solver.statics.resting import static

HOME = np.array([1.0, 0.0, 0.0, 0.0])
TWO = {
    "one after the other": ([0.0, 0.4, 0.5, 1.0], [0.0, 1.5, 1.5, 1.5], [0.0, 0.0, 0.0, -2.0]),
    "together": ([0.0, 0.3, 0.7, 1.0], [0.0, 1.0, -0.5, 0.2], [0.0, 2.0, 2.0, 3.0]),
    "whole turns": ([0.0, 0.5, 0.6, 1.0], [0.0, 1.0, 0.5, 0.2], [0.0, 10.0, 12.0, 6.0 * pi]),
}


def position(times: list[float], values: list[float]) -> tuple[Condition, ...]:
    return (Condition("position", Curve.table(times, values, "smoothstep")),)


def matrix(quaternion: Array) -> Array:
    return np.asarray(Rotation.from_quat(np.roll(quaternion, -1)).as_matrix())


def integrated(about: list[tuple[Condition, ...]], t: float) -> Array:
    """By an integrator that knows nothing of exponentials: R' = R [omega]x."""

    def rate(t: float, R: Array) -> Array:
        omega = [c[0].curve.derivative(t) for c in about]
        return np.asarray(np.cross(R.reshape(3, 3), np.tile(omega, (3, 1)))).ravel()

    R, corners = np.eye(3).ravel(), sorted({0.0, t, *(x for c in about for x in c[0].curve.corners if x < t)})
    for start, end in pairwise(corners):
        R = solve_ivp(rate, (start, end - 1e-13), R, method="DOP853", rtol=1e-12, atol=1e-13).y[:, -1]
    return R.reshape(3, 3)


@pytest.mark.parametrize("t", [0.2, 0.45, 1.0])
@pytest.mark.parametrize(("times", "first", "second"), TWO.values(), ids=TWO)
def test_it_lies_where_its_rates_lead(times: list[float], first: list[float], second: list[float], t: float) -> None:
    about = [position(times, first), (FIXED[0],), position(times, second)]
    turning = Turning(HOME, [c[0] for c in about], 1.0)
    assert matrix(turning.at(t)) == pytest.approx(integrated(about, t), abs=1e-9)


def test_rotations_that_keep_their_axis_add_up() -> None:
    axis = np.array([0.6, 0.0, -0.8])
    about = [position([0.0, 1.0], [0.0, 2.5 * x])[0] for x in axis]
    turning = Turning(HOME, about, 1.0)
    assert matrix(turning.at(1.0)) == pytest.approx(Rotation.from_rotvec(2.5 * axis).as_matrix(), abs=1e-13)


def test_a_rod_follows_its_end_and_keeps_its_linking_number() -> None:
    times, first, second = TWO["together"]
    about = (position(times, first), FIXED, position(times, second))
    end = End((FIXED,) * 3, about, "lab")
    frame = last(static(rod=ARC_ROD, initial=ARC, start=End.clamp(), end=end, numerics=Numerics(intervals=40)))
    start, turned = frame.orientation[0], matrix(frame.orientation[-1])
    home = matrix(last(static(rod=ARC_ROD, initial=ARC, start=End.clamp(), end=End.clamp())).orientation[-1])
    assert turned == pytest.approx(home @ integrated(list(about), 1.0), abs=1e-9)
    assert start == pytest.approx(HOME, abs=1e-9)
    assert frame.Tw + frame.Wr == pytest.approx(frame.Lk, abs=1e-3)
