"""Kernels called as runs call them, with records by reference: so they are those that are compiled already.

With the records themselves each would be compiled once more, for a minute in all.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from solver.arrays import Array
from solver.kernels.handed import Reference
from solver.kernels.kernel import kernel
from solver.methods.linear import system
from solver.methods.space.box.fields import State
from solver.methods.time.generalized_alpha.newton import EndValues

THEMSELVES = (State, EndValues)
"""Records that kernels get by their arrays."""


_references: dict[int, tuple[tuple[Any, ...], Reference]] = {}
"""By the record's id, and with the record, so that no other one gets that id."""


def call(kernel: Callable[..., Any], *arguments: Any) -> Any:
    """What a kernel returns."""
    return kernel(*[_reference(one) if isinstance(one, tuple) and not isinstance(one, THEMSELVES) else one
                    for one in arguments])  # fmt: skip


def _reference(record: tuple[Any, ...]) -> Reference:
    if id(record) not in _references:
        _references[id(record)] = record, Reference.to(record)
    return _references[id(record)][1]


@kernel
def factor(linear, Y: Array, past: Array, c0: float, h: float, nodes, of) -> int:  # type: ignore[no-untyped-def]  # fmt: skip
    """What a linear solver's own variant does, which only kernels find by reference."""
    return system.factor(linear, Y, past, c0, h, nodes, of)


@kernel
def solve(linear, of, scale: float, b: Array, x: Array) -> None:  # type: ignore[no-untyped-def]
    """What a linear solver's own variant does, which only kernels find by reference."""
    system.solve(linear, of, scale, b, x)
