"""Arrays that a kernel works in and nobody keeps, on the stack.

Numba's own would be allocated at each call. That costs little, but a step shall allocate nothing; and LLVM knows that
nothing else lies where these lie, and keeps in registers what fits.
"""

from __future__ import annotations

from collections.abc import Callable
from math import prod
from typing import Any, cast

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic
from numpy.typing import NDArray

from solver.arrays import Array

Shape = int | tuple[int, ...]
Generated = tuple[Any, Callable[..., Any]]
"""A signature, and what writes the code of a call."""

ALIGNMENT = 64
"""Bytes: a row of eight numbers."""


def _scratch(_context: Any, shape: Any) -> Generated:
    array, make = _zeros(types.float64, shape)
    return array(shape), make


def _scratch_like(_context: Any, shape: Any, other: Any) -> Generated:
    array, make = _zeros(other.dtype, shape)
    return array(shape, other), make


def _zeros(dtype: Any, shape: Any) -> Generated:
    """The type of an array, and what makes it where a kernel asks for it."""
    several: Any = shape if isinstance(shape, types.BaseTuple) else (shape,)
    lengths = [length.literal_value for length in several]
    array, count = types.Array(dtype, len(lengths), "C"), prod(lengths)

    def make(target: Any, builder: Any, _signature: Any, _arguments: Any) -> Any:
        number = target.get_data_type(dtype)
        size = target.get_abi_sizeof(number)
        with builder.goto_entry_block():  # else each turn of a loop would take more of the stack
            place = builder.alloca(number, size=ir.Constant(ir.IntType(64), count))
        place.align = ALIGNMENT
        cgutils.memset(builder, place, ir.Constant(ir.IntType(64), count * size), 0)  # type: ignore[no-untyped-call]
        strides = [size * prod(lengths[k + 1 :]) for k in range(len(lengths))]
        shape, strides, itemsize = ([target.get_constant(types.intp, n) for n in ns]
                                    for ns in (lengths, strides, [size]))  # fmt: skip
        structure = target.make_array(array)(target, builder)
        target.populate_array(structure, data=place, shape=shape, strides=strides, itemsize=itemsize[0], meminfo=None)
        return structure._getvalue()

    return array, make


scratch = cast(Callable[[Shape], Array], intrinsic(prefer_literal=True)(_scratch))
"""Zeros of a shape that is given in numbers. They are gone when the kernel returns, which must not return them."""

scratch_like = cast(Callable[[Shape, NDArray[Any]], Any], intrinsic(prefer_literal=True)(_scratch_like))
"""The same, of numbers as those of the array `other`."""
