"""The solve by generalized conjugate residuals, put around products with a known matrix."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose

from solver.arrays import Array
from solver.methods.linear.krylov import Krylov, begin, combine, follow, project, set_out, unsolved

SIZE = 30


def system(seed: int) -> tuple[Array, Array]:
    """A - 1, of low rank and stiff as contact is, and a right-hand side."""
    random = np.random.default_rng(seed)
    few = random.normal(size=(SIZE, 8))
    return few @ np.diag(np.geomspace(1, 1e4, 8)) @ few.T, random.normal(size=SIZE)


def solved(krylov: Krylov, stiff: Array, b: Array, known: int, tolerance: float) -> int:
    """Solve (1 + stiff) y = b, beginning with the first `known` directions; the number used."""
    krylov.y[:], used = b, 0
    begin(krylov, SIZE)
    while unsolved(krylov, used, SIZE, tolerance):
        if used >= known:
            set_out(krylov, used, SIZE)
        krylov.z[:] = stiff @ krylov.directions[used]
        follow(krylov, used, SIZE)
        used += 1
    combine(krylov, used, SIZE)
    return used


@pytest.mark.parametrize("seed", range(5))
def test_the_residual_is_as_small_as_was_asked(seed: int) -> None:
    stiff, b = system(seed)
    krylov = Krylov.empty(SIZE)
    used = solved(krylov, stiff, b, 0, 1e-9)
    assert used <= 12  # eight eigenvalues and the one of the rest
    assert np.linalg.norm(b - krylov.y - stiff @ krylov.y) < 1e-8 * np.linalg.norm(b)


@pytest.mark.parametrize("seed", range(5))
def test_known_directions_serve_another_right_hand_side_and_a_matrix_nearby(seed: int) -> None:
    stiff, b = system(seed)
    krylov = Krylov.empty(SIZE)
    known = solved(krylov, stiff, b, 0, 1e-9)
    other = stiff @ np.random.default_rng(99).normal(size=SIZE)
    afresh = solved(Krylov.empty(SIZE), 1.01 * stiff, other, 0, 1e-6)
    used = solved(krylov, 1.01 * stiff, other, known, 1e-6)
    assert max(0, used - known) < 0.5 * afresh
    assert np.linalg.norm(other - krylov.y - 1.01 * stiff @ krylov.y) < 1e-5 * np.linalg.norm(other)


@pytest.mark.parametrize("seed", range(5))
def test_where_the_matrix_stays_known_images_serve_another_right_hand_side_without_a_product(seed: int) -> None:
    stiff, b = system(seed)
    krylov = Krylov.empty(SIZE)
    known = solved(krylov, stiff, b, 0, 1e-9)
    other = stiff @ np.random.default_rng(99).normal(size=SIZE)
    krylov.y[:] = other
    begin(krylov, SIZE)
    project(krylov, known, SIZE)
    assert not unsolved(krylov, known, SIZE, 1e-5)
    combine(krylov, known, SIZE)
    assert np.linalg.norm(other - krylov.y - stiff @ krylov.y) < 1e-5 * np.linalg.norm(other)


def test_a_direction_that_says_nothing_new_is_passed_over() -> None:
    stiff, b = system(1)
    krylov = Krylov.empty(SIZE)
    krylov.directions[0] = krylov.directions[1] = b
    solved(krylov, stiff, b, 2, 1e-9)
    assert_allclose(krylov.y + stiff @ krylov.y, b, atol=1e-8 * np.linalg.norm(b))


def test_nothing_comes_of_nothing() -> None:
    krylov = Krylov.empty(SIZE)
    assert solved(krylov, system(0)[0], np.zeros(SIZE), 0, 1e-9) == 0
    assert not krylov.y.any()
