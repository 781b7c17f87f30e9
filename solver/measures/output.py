"""The record of an output: what is said once about a value of each frame, for datasets, cases and documents."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import nan
from typing import Any, Literal

from solver.arrays import Array

COMPONENTS = {"": 1, "material": 3, "lab": 3, "quaternion": 4}
"""How many components a value has: a number, a vector in one of the two frames, a unit quaternion (w, x, y, z)."""

FOLLOWS: Any = nan
"""Stands for a value that follows from the others of its frame, until it is computed."""


@dataclass(frozen=True)
class Output:
    """One value of a frame: `units` as in UDUNITS, and what it is.

    `axes`: the components it has, see `COMPONENTS`; `along_rod`: whether there is a value at each node;
    `of(frame, s, scene)`: for an output that follows from the other values, its value, with the arclengths s (n,) of
    the nodes in m; `statics`: whether only a static analysis has it; `verified`: whether a verified run extrapolates it
    and estimates its error, or else has it from the finer run. `name` and `type` are those of the frame's field.
    """

    units: str
    long_name: str
    axes: Literal["", "material", "lab", "quaternion"] = ""
    along_rod: bool = False
    of: Callable[..., Array | float | int] | None = None
    statics: bool = False
    verified: bool = True
    name: str = ""
    type: Literal["f8", "i4"] = "f8"

    @property
    def components(self) -> int:
        """Numbers per value: of the rod, or of a node."""
        return COMPONENTS[self.axes]
