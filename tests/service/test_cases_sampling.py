"""Samples of ranges, and what they tell of a function whose sensitivity is known."""

from __future__ import annotations

import numpy as np
import pytest

from service.cases.sampling import Range, grid, sample, size_of, sobol_indices


def test_a_grid_changes_its_last_parameter_fastest():
    assert grid([[1, 2], ["a", "b"]]) == [(1, "a"), (1, "b"), (2, "a"), (2, "b")]


@pytest.mark.parametrize("method", ["latin_hypercube", "sobol", "saltelli"])
def test_a_sample_has_the_size_that_is_told_before(method):
    ranges = [Range(-1.0, 3.0), Range(1e-4, 1.0, True)]
    values = sample(method, ranges, 16, 7)
    assert len(values) == size_of(method, 16, 2) and values == sample(method, ranges, 16, 7)
    first, second = np.array(values).T
    assert first.min() >= -1.0 and first.max() <= 3.0 and abs(np.median(first) - 1.0) < 0.6
    assert second.min() >= 1e-4 and second.max() <= 1.0 and abs(np.log10(np.median(second)) + 2.0) < 0.6


def test_sobols_indices_are_those_of_ishigamis_function():
    """Ishigami & Homma (1990): sin x1 + a sin^2 x2 + b x3^4 sin x1 on [-pi, pi]^3; its variances are known exactly."""
    a, b, pi = 7.0, 0.1, np.pi
    x1, x2, x3 = np.array(sample("saltelli", [Range(-pi, pi)] * 3, 1024, 0)).T
    found = sobol_indices(np.sin(x1) + a * np.sin(x2) ** 2 + b * x3**4 * np.sin(x1), 3)
    of_1 = 0.5 * (1.0 + b * pi**4 / 5.0) ** 2
    of_2, of_13 = a**2 / 8.0, 8.0 * b**2 * pi**8 / 225.0
    whole = of_1 + of_2 + of_13
    for index, (first, total) in zip(found, [(of_1, of_1 + of_13), (of_2, of_2), (0.0, of_13)], strict=True):
        assert abs(index.first - first / whole) <= 2.0 * index.first_confidence
        assert abs(index.total - total / whole) <= 2.0 * index.total_confidence
        assert index.first_confidence < 0.15
