"""Functions of several forms: which one a kernel calls is settled while it is compiled, by the class of a record.

So a kernel that is written once can be compiled for the records of several loads, laws or methods. (A form may not be
an argument of a kernel, nor a variable of a closure: either would keep it out of numba's cache.)
"""

from __future__ import annotations

import inspect
from collections.abc import Callable
from typing import Any

from numba.extending import overload


class Forms(dict[type, Callable[..., Any]]):
    """The kernels of one function, by the class of its first argument (a NamedTuple).

    A class that is not here has the function's own body.
    """

    def __init__(self, function: Callable[..., Any]) -> None:
        self.function = function
        parameters = ", ".join(inspect.signature(function).parameters)
        first = parameters.split(",")[0]
        source = (f"def choose({parameters}):\n"
                  f"    form = forms.get({first}.instance_class)\n"
                  f"    def call({parameters}):\n"
                  f"        return form({parameters})\n"
                  f"    return call if form else forms.function\n")  # fmt: skip
        names: dict[str, Any] = {"forms": self}
        exec(source, names)  # noqa: S102  # an overload must have its function's parameters, by name
        overload(function, strict=False, inline="always")(names["choose"])


def of_many_forms(function: Callable[..., Any]) -> Callable[..., Any]:
    """A function for which kernels are entered in `forms_of(function)`."""
    function.forms = Forms(function)  # type: ignore[attr-defined]
    return function


def forms_of(function: Callable[..., Any]) -> Forms:
    """The kernels of a function of many forms."""
    return function.forms  # type: ignore[attr-defined, no-any-return]


def for_each(function: Callable[..., Any], call: Callable[..., Any], having: Callable[[type], bool]) -> None:
    """Let `function`(records, ...) call `call`(record, ...) for each record that is present in a NamedTuple of records.

    A record has `present`; what is absent costs this one test, and a class that is not `having` nothing.
    """
    parameters = list(inspect.signature(function).parameters)
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
    overload(function, strict=False)(names["choose"])
