"""Records of arrays that a method hands to its kernels by reference.

A kernel that is called from Python takes in the arrays of its arguments one by one. For the hundred and more of a step
that takes 20 us, as long as an iteration on 20 intervals; by reference it takes one. And what kernels pass on to
kernels is an address then, not each array in turn: else both calling and compiling would take long.

Who hands over keeps the arrays alive. Kernels read a record's fields by name, as ever; nobody may write a field.
"""

from __future__ import annotations

from dataclasses import dataclass
from struct import Struct
from typing import Any

import numba
import numpy as np
from llvmlite import ir
from numba import types
from numba.core.typing.templates import AttributeTemplate
from numba.extending import NativeValue, infer_getattr, lower_getattr_generic, models, register_model, unbox
from numpy.typing import NDArray


class Referred(types.Type):
    """The type of a reference to a record."""

    def __init__(self, record: Any) -> None:
        self.record = record
        self.instance_class, self.fields = record.instance_class, record.fields
        self.types = tuple(Referred(kind) if isinstance(kind, types.BaseNamedTuple) else kind for kind in record.types)
        super().__init__(f"reference to {record}")

    @property
    def key(self) -> Any:
        """What tells one type of records from another."""
        return self.record


register_model(Referred)(models.OpaqueModel)


@dataclass(frozen=True, eq=False)
class Reference:
    """What a kernel gets of a record, a NamedTuple, and reads by the same names. The numbers in it are as they were
    when it was handed over."""

    _record: tuple[Any, ...]
    _memory: NDArray[np.uint8]
    _numba_type_: Referred
    address: int

    @classmethod
    def to(cls, record: tuple[Any, ...]) -> Reference:
        """Hand a record over."""
        likeness, parts = list[Any](), list[Any]()
        _take_apart(record, likeness, parts)
        kinds = tuple(likeness)
        if kinds not in _LAYOUTS:
            kind: Any = numba.typeof(record)  # type: ignore[no-untyped-call]
            _LAYOUTS[kinds] = Referred(kind), Struct("=" + _format(kind))
        referred, layout = _LAYOUTS[kinds]
        memory = np.frombuffer(layout.pack(*parts), np.uint8)
        return cls(record, memory, referred, memory.ctypes.data)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._record, name)

    def again(self, record: tuple[Any, ...]) -> Reference:
        """The same; or what is handed over in its place, if a field of the record has been replaced."""
        return self if all(new is old for new, old in zip(record, self._record, strict=True)) else self.to(record)


def _offsets(kind: Any) -> list[int]:
    """Where each part of a tuple begins (bytes), and where the tuple ends: as in C."""
    begins, end, widest = list[int](), 0, 1
    for part in kind:
        size, alignment = _extent(part)
        begins.append(-(-end // alignment) * alignment)
        end, widest = begins[-1] + size, max(widest, alignment)
    return [*begins, -(-end // widest) * widest]


def _extent(kind: Any) -> tuple[int, int]:
    """Size and alignment (bytes) of a value of one of numba's types."""
    if isinstance(kind, types.BaseTuple):
        parts: Any = kind
        return _offsets(kind)[-1], max((_extent(part)[1] for part in parts), default=1)
    if isinstance(kind, types.Array):
        return 8 * (5 + 2 * kind.ndim), 8
    size = 8 if isinstance(kind, types.NoneType) else np.dtype(str(kind)).itemsize
    return size, min(size, 8)


_LAYOUTS: dict[Any, tuple[Referred, Struct]] = {}
"""The type of the reference to records, and how they lie in memory, by their likeness: numba needs some ms to tell."""


def _format(kind: Any) -> str:
    """How a value of one of numba's types lies in memory, as `struct` has it."""
    if isinstance(kind, types.BaseTuple):
        parts: Any = kind
        begins, texts, end = _offsets(kind), list[str](), 0
        for begin, part in zip(begins, parts, strict=False):
            texts += [f"{begin - end}x", _format(part)]
            end = begin + _extent(part)[0]
        return "".join([*texts, f"{begins[-1] - end}x"])
    size = _extent(kind)[0]
    if isinstance(kind, types.Array):
        return f"{size // 8}q"
    return f"{size}x" if isinstance(kind, types.NoneType) else f"{size}s"


def _take_apart(value: Any, likeness: list[Any], parts: list[Any]) -> None:
    """Add what is the same for records that have the same type; and what `struct` writes of them, of an array an
    address that nobody owns."""
    if isinstance(value, np.ndarray):
        likeness += (value.dtype, value.ndim, value.flags.num)
        address, _ = value.__array_interface__["data"]  # `ctypes.data` takes three times as long
        parts += (0, 0, value.size, value.itemsize, address, *value.shape, *value.strides)
    elif isinstance(value, tuple):
        likeness += (type(value), len(value))
        for record in value:
            _take_apart(record, likeness, parts)
    else:
        likeness.append(type(value))
        if value is not None:
            parts.append(np.asarray(value).tobytes())


@infer_getattr
class _Fields(AttributeTemplate):
    """The types of what a kernel finds by name."""

    key = Referred

    def generic_resolve(self, kind: Referred, name: str) -> Any:  # type: ignore[override]
        return kind.types[kind.fields.index(name)] if name in kind.fields else None


@lower_getattr_generic(Referred)  # type: ignore[no-untyped-call]
def _read(target: Any, builder: Any, kind: Referred, address: Any, name: str) -> Any:
    """The code that reads a field. It stays as it is: the compiler may read it once for all times."""
    k = kind.fields.index(name)
    part = kind.types[k]
    place = builder.gep(address, [ir.Constant(ir.IntType(64), _offsets(kind.record)[k])])
    if isinstance(part, Referred):
        return place
    typed, before = builder.bitcast(place, target.get_data_type(part).as_pointer()), len(builder.block.instructions)
    value = target.data_model_manager[part].load_from_data_pointer(builder, typed)
    for instruction in builder.block.instructions[before:]:
        if isinstance(instruction, ir.LoadInstr):
            instruction.set_metadata("invariant.load", builder.module.add_metadata([]))
    return value


@unbox(Referred)  # type: ignore[no-untyped-call]
def _take_in(_kind: Referred, reference: Any, c: Any) -> NativeValue:
    """The address, from Python."""
    number = c.pyapi.object_getattr_string(reference, "address")
    address = c.pyapi.long_as_voidptr(number)
    c.pyapi.decref(number)
    return NativeValue(address)  # type: ignore[no-untyped-call]
