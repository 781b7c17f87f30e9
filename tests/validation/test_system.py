"""The linear system that validation and benchmarks take out of a step."""

from __future__ import annotations

import numpy as np
from scipy.sparse.linalg import spsolve

from benchmarks.kernels import scene_of
from solver.methods.box import BoxMethod
from validation.system import NewtonSystem


def test_the_matrix_is_that_of_the_solve() -> None:
    system = NewtonSystem(BoxMethod(scene_of(20)), 0.1)
    system.assemble()
    assert system.factor()
    x = system.solve()
    matrix, b = system.as_sparse()
    expected = spsolve(matrix.tocsc(), b)
    assert np.abs(x - expected).max() <= 1e-9 * np.abs(expected).max()
