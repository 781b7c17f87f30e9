"""Records of arrays that a method hands to its kernels by reference.

A kernel that is called from Python takes in the arrays of its arguments one by one. For the hundred and more of a step
that takes 20 us, as long as an iteration on 20 intervals; by reference it takes one.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from numba import types
from numba.experimental import structref

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


@kernel
def _refer(records: tuple[Any, ...]) -> Any:
    return Reference(records)  # type: ignore[no-untyped-call]
