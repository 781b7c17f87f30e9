"""Curves: values, derivatives, integrals and corners of profiles and schedules."""

from __future__ import annotations

from math import inf, nan, pi
from typing import get_args

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import quad

from solver.scene.curve import Curve, Interpolation, constant_vector

KNOTS = [0.5, 1.0, 1.75, 3.0, 3.25]
VALUES = [1.0, -2.0, -2.5, 4.0, 0.5]
INTERPOLATIONS: tuple[Interpolation, ...] = get_args(Interpolation)
EVERYWHERE = np.linspace(-1.0, 5.0, 61)


@pytest.fixture(params=INTERPOLATIONS)
def table(request: pytest.FixtureRequest) -> Curve:
    return Curve.table(KNOTS, VALUES, request.param)


def test_a_constant_is_its_value_everywhere() -> None:
    curve = Curve.constant(-3.5)
    assert [curve.value(x) for x in (-1e9, 0.0, 2.0)] == [-3.5] * 3
    assert curve.derivative(1.0) == 0.0
    assert curve.integral(2.0) == -7.0
    assert curve.is_constant
    assert curve.corners == ()


def test_a_table_goes_through_its_points(table: Curve) -> None:
    assert_allclose(table(KNOTS), VALUES, rtol=1e-14)
    assert not table.is_constant


def test_a_table_is_held_constant_beyond_its_ends(table: Curve) -> None:
    assert table.value(-7.0) == VALUES[0]
    assert table.value(9.0) == pytest.approx(VALUES[-1], rel=1e-14)
    assert table.derivative(-7.0) == 0.0
    assert table.derivative(9.0) == 0.0


def test_the_corners_are_the_knots(table: Curve) -> None:
    assert table.corners == tuple(KNOTS)


def test_linear_interpolation_is_linear() -> None:
    curve = Curve.table(KNOTS, VALUES, "linear")
    assert_allclose(curve(EVERYWHERE), np.interp(EVERYWHERE, KNOTS, VALUES), rtol=1e-14, atol=1e-14)


def test_smoothstep_is_x2_3_minus_2x_from_each_value_to_the_next() -> None:
    curve = Curve.table([1.0, 3.0, 4.0], [5.0, 7.0, 4.0], "smoothstep")
    x = np.linspace(0.0, 1.0, 21)
    step = x**2 * (3 - 2 * x)
    assert_allclose(curve(1.0 + 2.0 * x), 5.0 + 2.0 * step, rtol=1e-14)
    assert_allclose(curve(3.0 + x), 7.0 - 3.0 * step, rtol=1e-14)
    assert [curve.derivative(k) for k in (1.0, 3.0, 4.0)] == [0.0, 0.0, 0.0]


def test_pchip_does_not_overshoot() -> None:
    curve = Curve.table(KNOTS, [0.0, 0.0, 1.0, 1.0, 3.0], "pchip")
    fine = np.linspace(KNOTS[0], KNOTS[-1], 500)
    assert np.diff(curve(fine)).min() >= -1e-15


def test_a_cubic_table_reproduces_a_cubic() -> None:
    def cubic(x: float) -> float:
        return 2 * x**3 - x**2 + 4

    curve = Curve.table(KNOTS, [cubic(x) for x in KNOTS], "cubic")
    inside = np.linspace(KNOTS[0], KNOTS[-1], 40)
    assert_allclose(curve(inside), [cubic(x) for x in inside], rtol=1e-13)


def test_a_table_of_two_points_is_a_curve_with_every_interpolation() -> None:
    for interpolation in INTERPOLATIONS:
        assert Curve.table([0.0, 2.0], [1.0, 3.0], interpolation).value(1.0) == pytest.approx(2.0)


def test_the_derivative_is_that_of_the_value(table: Curve) -> None:
    x = np.setdiff1d(np.round(EVERYWHERE, 3), KNOTS)
    step = 1e-5
    # cubic pieces: the central difference is off by y''' step^2 / 6, y''' below 1e4 here, and rounding / step
    slope = (table(x + step) - table(x - step)) / (2 * step)
    assert_allclose([table.derivative(float(u)) for u in x], slope, atol=1e-6)


def test_at_a_corner_the_derivative_is_the_right_hand_one() -> None:
    curve = Curve.table([0.0, 1.0, 2.0], [0.0, 1.0, 4.0])
    assert curve.derivative(1.0) == 3.0
    assert curve.derivative(0.0) == 1.0
    assert curve.derivative(2.0) == 0.0


def test_the_integral_is_exact_inside_and_beyond_the_table(table: Curve) -> None:
    for x in (-0.5, 0.5, 0.9, 1.0, 2.6, 3.25, 4.5):
        inside = [k for k in KNOTS if min(KNOTS[0], x) < k < max(KNOTS[0], x)]
        exact, _ = quad(table.value, KNOTS[0], x, points=inside or None, epsabs=1e-13, epsrel=1e-13)
        assert table.integral(x) == pytest.approx(exact, abs=1e-12)


def test_calling_a_curve_keeps_the_shape(table: Curve) -> None:
    grid = EVERYWHERE[:60].reshape(3, 20)
    assert table(grid).shape == (3, 20)
    assert table(grid)[1, 3] == table.value(float(grid[1, 3]))
    assert table(2.0).shape == ()


def test_calling_a_curve_gives_its_values_to_the_bit(table: Curve) -> None:
    for curve in (table, Curve.constant(2.5)):
        everywhere = np.concatenate([EVERYWHERE, KNOTS])
        assert curve(everywhere).tolist() == [curve.value(float(x)) for x in everywhere]


@pytest.mark.parametrize(
    ("curve", "zero"),
    [
        (Curve.constant(0.0), True),
        (Curve.constant(1e-300), False),
        (Curve.table([0.0, 1.0], [0.0, 0.0]), True),
        (Curve.table([0.0, 1.0], [0.0, 1.0]), False),
        (Curve.table([0.0, 1.0, 2.0], [0.0, 1.0, 0.0], "smoothstep"), False),
    ],
)
def test_a_curve_knows_whether_it_is_zero_everywhere(curve: Curve, zero: bool) -> None:
    assert curve.is_zero is zero


@pytest.mark.parametrize(
    ("x", "y", "told"),
    [
        ([0.0], [1.0], "length >= 2"),
        ([0.0, 1.0], [1.0, 2.0, 3.0], r"\(2,\) and \(3,\)"),
        ([[0.0, 1.0]], [[1.0, 2.0]], "length >= 2"),
        ([0.0, 1.0, 1.0], [0.0, 1.0, 2.0], "increase strictly"),
        ([1.0, 0.0], [0.0, 1.0], "increase strictly"),
        ([0.0, nan], [0.0, 1.0], "finite"),
        ([0.0, 1.0], [0.0, inf], "finite"),
    ],
)
def test_a_bad_table_is_refused(x: list[float], y: list[float], told: str) -> None:
    with pytest.raises(ValueError, match=told):
        Curve.table(x, y)


def test_an_unknown_interpolation_is_refused_by_name() -> None:
    with pytest.raises(ValueError, match="'spline'"):
        Curve.table([0.0, 1.0], [0.0, 1.0], "spline")  # type: ignore[arg-type]


@pytest.mark.parametrize("value", [nan, inf, -inf])
def test_a_constant_that_is_not_finite_is_refused(value: float) -> None:
    with pytest.raises(ValueError, match="value must be finite"):
        Curve.constant(value)


def test_a_constant_vector_has_a_curve_for_each_component() -> None:
    assert [c.value(0.0) for c in constant_vector((1.0, 2.0, pi))] == [1.0, 2.0, pi]
