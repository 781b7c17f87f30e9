"""Copies from one array to another, for kernels: what `target[:] = source` says.

That also looks whether shapes agree, with a message for where they do not, and whether the two overlap, for which it
makes room. Kernels know both; and what each of them would carry with it takes longer to compile than most of them.
"""

from __future__ import annotations

from typing import Any

from solver.kernels.kernel import by_type


@by_type
def copy(source: Any, target: Any) -> Any:
    """Write `source` into `target`, of one shape, in another place."""
    if source.ndim == 1:
        return _copy_line
    if source.layout == target.layout == "C":
        return lambda source, target: copy(source.reshape(source.size), target.reshape(target.size))
    return _copy_lines


def _copy_line(source: Any, target: Any) -> None:
    for i in range(len(source)):
        target[i] = source[i]


def _copy_lines(source: Any, target: Any) -> None:
    for i in range(len(source)):
        copy(source[i], target[i])
