"""Functions of several forms: which one a kernel calls is settled while it is compiled, by the class of a record.

So a kernel that is written once can be compiled for the records of several loads, laws or methods. (A form may not be
an argument of a kernel, nor a variable of a closure: either would keep it out of numba's cache.)
"""

from __future__ import annotations

import inspect
from collections.abc import Callable
from typing import Any, cast

from numba.extending import overload


class Forms(dict[type, Callable[..., Any]]):
    """The kernels of one function, by the class of its first argument (a NamedTuple)."""

    def __init__(self, stub: Callable[..., Any]) -> None:
        self.stub = stub
        parameters = ", ".join(inspect.signature(stub).parameters)
        first = parameters.split(",")[0]
        source = (f"def typing({parameters}):\n"
                  f"    form = forms.form({first})\n"
                  f"    def call({parameters}):\n"
                  f"        return form({parameters})\n"
                  f"    return call\n")  # fmt: skip
        names: dict[str, Any] = {"forms": self}
        exec(source, names)  # noqa: S102  # an overload must have its function's parameters, by name
        overload(stub, strict=False)(names["typing"])

    def form(self, record: Any) -> Callable[..., Any]:
        """The kernel for a record's type; the stub itself, compiled, where its class has none of its own."""
        return self.get(record.instance_class, self.default)

    default: Callable[..., Any]


def of_many_forms(stub: Callable[..., Any]) -> Callable[..., Any]:
    """A function whose kernels are entered in its `forms`; the stub's own body is what holds without one."""
    from solver.kernels.kernel import kernel

    forms = Forms(stub)
    forms.default = kernel(stub)
    stub.forms = forms  # type: ignore[attr-defined]
    return stub


def forms_of(stub: Callable[..., Any]) -> Forms:
    """The kernels of a function of many forms."""
    return cast(Forms, stub.forms)  # type: ignore[attr-defined]


def for_each_field(stub: Callable[..., Any], call: Callable[..., Any]) -> None:
    """Let `stub`(records, ...) call `call`(record, ...) for each record that is present in a NamedTuple of records.

    A record has `present`; what is absent costs this one test.
    """
    parameters = list(inspect.signature(stub).parameters)
    records, others = parameters[0], ", ".join(parameters[1:])

    def typing(record_type: Any) -> Any:
        body = "".join(f"    if {records}.{name}.present:\n        call({records}.{name}, {others})\n"
                       for name in record_type.fields)  # fmt: skip
        names: dict[str, Any] = {"call": call}
        exec(f"def each({', '.join(parameters)}):\n{body}", names)  # noqa: S102
        return names["each"]

    names: dict[str, Any] = {"typing": typing}
    exec(f"def choose({', '.join(parameters)}):\n    return typing({records})\n", names)  # noqa: S102
    overload(stub, strict=False)(names["choose"])
