"""Records of arrays that a method hands to its kernels by reference.

A kernel that is called from Python takes in the arrays of its arguments one by one. For the hundred and more of a step
that takes 20 us, as long as an iteration on 20 intervals; by reference it takes one.

Who hands over keeps the arrays alive. Kernels count no references to them: that would take as long again.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, cast

from llvmlite import ir
from numba import types
from numba.experimental import structref
from numba.extending import intrinsic

from solver.kernels.kernel import kernel


@structref.register
class _ReferenceType(types.StructRef):
    def preprocess_fields(self, fields: Any) -> Any:
        return tuple((name, types.unliteral(field)) for name, field in fields)  # type: ignore[no-untyped-call]


class Reference(structref.StructRefProxy):
    """What a kernel gets: `records` are those that were handed over."""

    records: Any


structref.define_boxing(_ReferenceType, Reference)  # type: ignore[no-untyped-call]
structref.define_constructor(Reference, _ReferenceType, ["records"])  # type: ignore[no-untyped-call]


@dataclass(frozen=True)
class Handed:
    """Records, and the reference to their arrays; the numbers in them are as they were when they were handed over."""

    records: tuple[Any, ...]
    reference: Reference

    @classmethod
    def over(cls, *records: Any) -> Handed:
        """Hand records over."""
        return cls(records, _refer(records))

    def again(self, *records: Any) -> Handed:
        """The same; or what is handed over in its place, if one of the records has been replaced."""
        same = all(new is old for new, old in zip(records, self.records, strict=True))
        return self if same else self.over(*records)


def _lent(_context: Any, records: Any) -> Any:
    def write(target: Any, builder: Any, _signature: Any, arguments: Any) -> Any:
        return _without_owner(target, builder, records, arguments[0])

    return records(records), write


def _without_owner(target: Any, builder: Any, kind: Any, value: Any) -> Any:
    """The code for a value of this type, each array in it owned by nobody."""
    if isinstance(kind, types.Array):
        array = target.make_array(kind)(target, builder, value)
        array.meminfo = ir.Constant(array.meminfo.type, None)
        return array._getvalue()
    for i in range(len(kind) if isinstance(kind, types.BaseTuple) else 0):
        part = _without_owner(target, builder, kind[i], builder.extract_value(value, i))
        value = builder.insert_value(value, part, i)
    return value


_lend = cast(Callable[[Any], Any], intrinsic(_lent))
"""Records whose arrays nobody owns: there is nothing to count."""


@kernel
def _refer(records: tuple[Any, ...]) -> Any:
    return Reference(_lend(records))  # type: ignore[no-untyped-call]
