"""What the benchmark of tolerances makes of its runs."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from benchmarks.tolerances import apart, largest, reached
from docs import measured
from solver.run.accuracy import QUANTITIES
from solver.run.recording import JUDGED, NUMBERS, WRITHE, Columns


def row(tolerance: float, cpu: float, error: float) -> dict[str, Any]:
    return {"tolerance": tolerance, "cpu_s": cpu, "true": dict.fromkeys(QUANTITIES, 0.1 * error) | {"kappa": error}}


ROWS = [row(1e-2, 1.0, 9e-4), row(1e-3, 2.0, 1e-4), row(1e-4, 3.0, 1e-5)]


def test_the_cheapest_run_counts_whose_errors_are_all_small_enough() -> None:
    assert reached(ROWS, 1e-3) == ROWS[0]
    assert reached(ROWS, 1e-4) == ROWS[1]
    assert reached(ROWS, 1e-6) is None


@pytest.mark.parametrize(
    ("error", "aim", "told"),
    [
        (1e-3, 1.0, ("1 s by a tolerance of 1e-02; 2 s by 1e-03, for 1.0e-04", "yes")),
        (1e-3, 0.9, ("1 s by a tolerance of 1e-02; 2 s by 1e-03, for 1.0e-04", "**missed**")),
        (1e-6, 9.0, ("not reached: kappa 1.0e-05 for 3 s", "**missed**")),
    ],
)
def test_what_is_told_of_an_aim(error: float, aim: float, told: tuple[str, str]) -> None:
    assert measured._reached(ROWS, error, aim) == told


def test_runs_are_compared_at_the_nodes_that_both_have() -> None:
    s, t = np.linspace(0.0, 1.0, 5), np.linspace(0.0, 1.0, 9)
    one = Columns(np.zeros((2, 5, len(JUDGED))) + s[:, None], np.zeros((2, 1, len(NUMBERS))))
    other = Columns(np.zeros((2, 9, len(JUDGED))) + t[:, None], np.zeros((2, 1, len(NUMBERS))))
    other.along[1, 4, 0] += 3e-3  # r_1 in the middle
    other.along[1, 3, 1] += 1.0  # a node that the other lacks
    other.numbers[0, 0, WRITHE] = -2e-3
    errors = largest(apart(one, other), np.array([2.0, 1.0, 1.0, 1.0]))
    assert errors == pytest.approx({"r": 1.5e-3, "kappa": 0.0, "energies": 0.0, "Tw_Wr": 2e-3})
