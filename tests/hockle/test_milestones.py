"""Milestones: events found between frames."""

from __future__ import annotations

from math import isnan

import numpy as np
import pytest

from hockle.milestones import first_crossing, maximum, table, value_at

T = np.linspace(0.0, 3.0, 31)
# A cubic spline of spacing h = 0.1 through sin errs by 5/384 h^4 = 1.3e-6, and some times that at its ends.
SPLINE = 1e-5


def test_a_crossing_is_found_between_frames():
    assert first_crossing(T, np.sin(T), 0.5) == pytest.approx(np.pi / 6, abs=2 * SPLINE)


def test_a_crossing_before_the_given_time_does_not_count():
    assert first_crossing(T, np.sin(T), 0.5, after=1.0) == pytest.approx(5 * np.pi / 6, abs=2 * SPLINE)


def test_a_curve_that_only_grazes_is_found_by_its_spline():
    # Between the frames at 1.4, 1.5, 1.6 the curve is below zero for 0.02 s only, at no frame.
    t0 = 1.55
    values = (T - t0) ** 2 - 0.01**2
    assert values.min() > 0
    assert first_crossing(T, values, 0.0) == pytest.approx(
        t0 - 0.01, abs=1e-9
    )  # a spline is exact on a parabola


def test_frames_without_a_value_are_passed_over():
    values = np.where(T < 1.0, np.nan, np.cos(T))
    assert first_crossing(T, values, 0.0) == pytest.approx(np.pi / 2, abs=SPLINE)


def test_what_is_not_reached_is_told_so():
    assert isnan(first_crossing(T, np.sin(T), 2.0))
    assert isnan(maximum(T, T))
    assert isnan(value_at(T, T, 3.1))
    assert "not reached" in table([("Wr = 1 (s)", np.nan, 29.0)])


def test_a_maximum_is_found_between_frames():
    assert maximum(T, np.sin(T)) == pytest.approx(np.pi / 2, abs=1e-3)  # of a slope: h^3
