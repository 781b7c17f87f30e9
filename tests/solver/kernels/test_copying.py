"""What kernels copy is what numpy would."""

from __future__ import annotations

import numpy as np
import pytest

from solver.kernels.copying import copy
from solver.kernels.kernel import kernel


@kernel
def copied(source, target):
    copy(source, target)


LINES = np.arange(24.0).reshape(4, 6)
SOURCES = {
    "a line": LINES[0],
    "a column": LINES[:, 1],
    "all": LINES,
    "some columns": LINES[:, 2:4],
    "three dimensions": LINES.reshape(2, 3, 4),
}


@pytest.mark.parametrize("source", SOURCES.values(), ids=SOURCES.keys())
@pytest.mark.parametrize("kind", [float, complex])
def test_a_copy_is_the_same_numbers(source, kind):
    whole, part = np.zeros(source.shape, kind), np.zeros((*source.shape[:-1], 2 * source.shape[-1]), kind)
    copied(source, whole)
    copied(source, part[..., ::2])
    assert np.array_equal(whole, source)
    assert np.array_equal(part[..., ::2], source)
    assert not part[..., 1::2].any()
