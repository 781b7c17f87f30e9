"""Kernels of which there are several: which one is called is chosen by the class of the record that comes first.

    @dispatched
    def area(shape: Shape) -> float: ...        the general function: what a kernel calls

    @variant(area, Square)
    @kernel
    def square_area(shape: Square) -> float: ...

The choice is made while the caller is compiled, by the type of its argument: it costs nothing, only what is chosen is
compiled, and the caller is cached on disk as ever. (Kernels that are handed to kernels are not: numba gives each a name
that no other process knows.)
"""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import Any

from numba.extending import overload

from solver.kernels.kernel import OPTIONS, Function

_VARIANTS: dict[Any, dict[type, Any]] = {}
"""By the general function: the kernel of each class of records."""


def dispatched(general: Function) -> Function:
    """Make `general` a function that calls the variant for its first argument, a NamedTuple; without one, itself."""

    @wraps(general)
    def call(record: Any, *arguments: Any) -> Any:
        return _VARIANTS[call].get(type(record), general)(record, *arguments)

    def chosen(record: Any, *_: Any) -> Callable[..., Any]:
        kernel = _VARIANTS[call].get(record.instance_class)
        return general if kernel is None else kernel.py_func

    _VARIANTS[call] = {}
    # with a wrapper for Python: the variant itself is loaded from the same file of the cache
    options = OPTIONS | {"no_cpython_wrapper": False}
    overload(call, jit_options=options, strict=False)(chosen)  # type: ignore[arg-type]
    return call  # type: ignore[return-value]


def variant(general: Callable[..., Any], record: type) -> Callable[[Function], Function]:
    """Decorate the kernel that `general` stands for where its first argument is a `record`."""

    def enter(kernel: Function) -> Function:
        _VARIANTS[general][record] = kernel
        return kernel

    return enter
