"""Kernels of which there are several: which one is called is chosen by the class of the record that comes first.

    @dispatched
    def area(shape: Shape) -> float: ...        the general function: what a kernel calls

    @variant(area, Square)
    @kernel
    def square_area(shape: Square) -> float: ...

The choice is made while the caller is compiled, by the type of its argument: it costs nothing, only what is chosen is
compiled, and the caller is cached on disk as ever. (Kernels that are handed to kernels, or stand in a closure, are not:
numba gives each a name that no other process knows.)

LLVM inlines the choice; numba must not (`inline="always"`): where an `inlined` kernel makes two of them, numba confuses
the records of the two, and the caller computes something else without a word.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable
from functools import wraps
from types import ModuleType
from typing import Any

from numba import types
from numba.core.typing.templates import AbstractTemplate, infer_global

from solver.kernels.kernel import Function, inner, overloads

_VARIANTS: dict[Any, dict[type, Any]] = {}
"""By the general function: the kernel of each class of records."""


def dispatched(general: Function) -> Function:
    """Make `general` a function that calls the variant for its first argument, a NamedTuple or None; else itself.

    One that raises NotImplementedError must have a variant: else the kernel that calls it is not compiled.
    """

    @wraps(general)
    def call(record: Any, *arguments: Any) -> Any:
        return _VARIANTS[call].get(type(record), general)(record, *arguments)

    variants = _VARIANTS.setdefault(call, {})
    default = None if "NotImplementedError" in general.__code__.co_names else inner(general)

    class Choice(AbstractTemplate):
        """How numba types a call: as one of the variant's own."""

        key = call

        def generic(self, arguments: Any, named: Any) -> Any:
            kernel = self._chosen(arguments)
            return kernel and types.Dispatcher(kernel).get_call_type(self.context, arguments, named)

        def get_impl_key(self, signature: Any) -> Any:
            return self._chosen(signature.args).get_overload(signature.args)

        def _chosen(self, arguments: Any) -> Any:
            return variants.get(getattr(arguments[0], "instance_class", type(None)), default)

    infer_global(call, types.Function(Choice))  # type: ignore[no-untyped-call]
    return call  # type: ignore[return-value]


def variant(general: Callable[..., Any], record: type) -> Callable[[Function], Function]:
    """Decorate the kernel that `general` stands for where its first argument is a `record`."""

    def enter(kernel: Function) -> Function:
        _VARIANTS[general][record] = kernel
        return kernel

    return enter


def enter(functions: ModuleType, records: tuple[type, ...], *modules: Any) -> None:
    """Let the kernels in `modules` be the variants of the general functions of the same names, for all `records`."""
    named = {name: general for name, general in vars(functions).items() if callable(general) and general in _VARIANTS}
    for module in modules:
        for name in named.keys() & vars(module).keys():
            for record in records:
                variant(named[name], record)(vars(module)[name])


def has_variant(general: Callable[..., Any], record: type) -> bool:
    """Whether there is a kernel of its own for a class of records."""
    return record in _VARIANTS[general]


def for_each(general: Callable[..., Any], call: Callable[..., Any], having: Callable[[type], bool]) -> None:
    """Let `general`(records, ...) call `call`(record, ...) for each record that is present in a NamedTuple of records.

    A record has `present`; what is absent costs this one test, and a class that is not `having` nothing.
    """
    parameters = list(inspect.signature(general).parameters)
    records, others = parameters[0], ", ".join(parameters[1:])

    def each(record_type: Any) -> Any:
        fields = zip(record_type.fields, record_type.types, strict=True)
        body = [f"    if {records}.{name}.present:\n        call({records}.{name}, {others})\n"
                for name, field in fields if having(field.instance_class)]  # fmt: skip
        names: dict[str, Any] = {"call": call}
        exec(f"def each({', '.join(parameters)}):\n{''.join(body) or '    pass'}", names)  # noqa: S102
        return names["each"]

    names: dict[str, Any] = {"each": each}
    exec(f"def choose({', '.join(parameters)}):\n    return each({records})\n", names)  # noqa: S102
    overloads(general, names["choose"])
