"""Functions that a kernel asks for by name, and the kernels that stand for them: chosen by the record it was handed.

So a scheme is written once for records of several kinds, calls each kind's own kernels directly, and what one kind has
no use for vanishes from it. (Kernels that are arguments, or stand in a closure, compile anew in every process: numba's
cache on disk does not know them again.)
"""

from __future__ import annotations

from collections.abc import Callable
from types import ModuleType
from typing import Any

from numba.extending import overload

from solver.kernels.kernel import OPTIONS

_KERNELS: dict[str, dict[type, Any]] = {}


def asked(name: str) -> Callable[..., Any]:
    """A function that kernels may call; the class of its first argument, a record, says which kernel that is."""
    kernels = _KERNELS[name] = {}

    def function(*arguments: Any) -> Any:
        raise NotImplementedError(name)

    @overload(function, jit_options=OPTIONS, strict=False)
    def choose(*arguments: Any) -> Callable[..., Any] | None:
        return kernels.get(getattr(arguments[0], "instance_class", type(None)))

    function.__qualname__ = name
    return function


def answer(records: tuple[type, ...], *modules: ModuleType) -> None:
    """From now on the modules' kernels of these names are meant, wherever a record of these classes comes first."""
    for name, kernels in _KERNELS.items():
        for kernel in (getattr(module, name) for module in modules if hasattr(module, name)):
            # compiled as a part of the kernel that asks for it
            kernels |= dict.fromkeys(records, kernel.py_func)
