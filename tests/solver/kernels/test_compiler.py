"""What numba is spared must not show: neither in the solver's kernels nor in functions of others."""

from __future__ import annotations

from typing import Any

import numba
import numpy as np
import pytest
from numpy.testing import assert_array_equal

from solver.kernels.compiler import CALLS
from solver.kernels.kernel import inner, kernel


def library_of(function: Any) -> Any:
    (compiled,) = function.overloads.values()
    return compiled.library


def test_only_what_python_calls_becomes_machine_code() -> None:
    @inner
    def twice(x: float) -> float:
        return 2.0 * x

    @kernel
    def four_times(x: float) -> float:
        return twice(twice(x))

    assert four_times(1.5) == 6.0
    assert library_of(four_times).has_machine_code
    assert not library_of(twice).has_machine_code


def test_a_call_of_the_same_kinds_is_typed_once() -> None:
    @kernel
    def first(x: float, y: float) -> float:
        return x - y * x

    @kernel
    def second(x: float, y: float) -> float:
        return y - x * y

    first(1.0, 2.0)
    known = len(CALLS.known)
    second(1.0, 2.0)
    assert len(CALLS.known) == known


@pytest.mark.parametrize("wrapped", [True, False])
def test_a_function_of_others_raises_what_it_raises(wrapped: bool) -> None:
    """Also one without machine code of its own, with what is known only as it runs."""

    @numba.njit(no_cpython_wrapper=not wrapped)
    def refuse(x: float) -> float:
        if x < 0.0:
            raise ValueError("negative", x)
        return x

    @numba.njit
    def call(x: float) -> float:
        return refuse(x)

    assert call(1.0) == 1.0
    with pytest.raises(ValueError, match=r"negative.*-2\.5"):
        call(-2.5)


def test_functions_that_are_called_by_address_have_one() -> None:
    @numba.vectorize(["float64(float64, float64)"])
    def larger(x: float, y: float) -> float:
        return x if x > y else y

    @numba.cfunc("float64(float64)")
    def half(x: float) -> float:
        return 0.5 * x

    assert_array_equal(larger(np.arange(3.0), 1.0), [1.0, 1.0, 2.0])
    assert half.ctypes(3.0) == 1.5


def test_a_function_that_calls_itself() -> None:
    @numba.njit
    def fibonacci(n: int) -> int:
        return n if n < 2 else fibonacci(n - 1) + fibonacci(n - 2)

    assert fibonacci(10) == 55
