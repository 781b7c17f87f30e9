"""What the errors of a run say of it."""

from __future__ import annotations

import numpy as np

from solver.run.accuracy import ENERGIES, errors_of, judge
from solver.run.recording import JUDGED, NUMBERS, STRETCHING, Columns


def test_what_is_beyond_the_tolerance_is_counted_by_quantity() -> None:
    accuracy = judge(1e-3, np.array([[1e-4, 2e-3, 0.0, 0.0], [1e-5, 3e-3, 0.0, 2e-3]]))
    assert not accuracy.met
    assert accuracy.beyond == {"r": 0, "kappa": 2, "energies": 0, "Tw_Wr": 1}
    assert "beyond the tolerance of 0.001 are, of 2 frames kappa in 2, Tw, Wr in 1." in accuracy.sentence()


def test_where_the_curvature_alone_is_beyond_the_tolerance_the_user_reads_that_the_rest_is_not() -> None:
    within, alone, far = [1e-4, 2e-4, 0.0, 0.0], [1e-4, 2.0, 0.0, 0.0], [2e-3, 0.0, 0.0, 0.0]
    assert "All but the curvature keep it" in judge(1e-3, np.array([within, alone])).sentence()
    assert "All but" not in judge(1e-3, np.array([alone, far])).sentence()
    assert "All but" not in judge(1e-3, np.array([within])).sentence()


def test_errors_that_nothing_tells_are_not_within_the_tolerance() -> None:
    accuracy = judge(1e-3, np.full((3, 4), np.nan))
    assert not accuracy.met
    assert accuracy.unknown
    assert accuracy.sentence() == "Nothing tells the errors: only one run came that far."


def test_where_nothing_tells_the_errors_nothing_tells_those_of_twist_and_writhe() -> None:
    error = Columns(np.full((1, 3, len(JUDGED)), np.nan), np.full((1, 1, len(NUMBERS)), np.nan))
    assert np.isnan(errors_of(error, np.ones(4))).all()


def test_what_stretching_stores_is_one_of_the_energies() -> None:
    error = Columns(np.zeros((1, 3, len(JUDGED))), np.zeros((1, 1, len(NUMBERS))))
    error.numbers[0, 0, STRETCHING] = 3.0
    assert errors_of(error, np.array([1.0, 1.0, 6.0, 1.0]))[0, ENERGIES] == 0.5
