"""The almost block diagonal system of the box method, and what a linear solver is.

A linear solver is a module with a record of its arrays and a variant of `factor` and of `solve` for it; a line of
registry.py gives it a name. Which one a step calls is chosen by the record's class, while the step is compiled.
"""

from __future__ import annotations

from typing import NamedTuple, Protocol, Self

import numpy as np

from solver.arrays import Array
from solver.kernels.dispatch import dispatched
from solver.methods.space.box.fields import Nodes
from solver.methods.space.box.schemes import BOX, SpaceScheme


class System(NamedTuple):
    """Newton's system but for the intervals' tangents, which a solver forms when their turn comes, and its solution.

    `space` the scheme along s; `start`, `end` (6, 12) rows of the ends; residuals `b` (N, 12), `b_start`, `b_end` (6,);
    `columns`, `rows` (12,) scales of the unknowns and equations; `x` (n, 12) solution.
    """

    space: SpaceScheme
    start: Array
    end: Array
    b: Array
    b_start: Array
    b_end: Array
    columns: Array
    rows: Array
    x: Array

    @classmethod
    def empty(cls, intervals: int, space: SpaceScheme = BOX) -> System:
        """Zeros for a rod of `intervals` intervals."""
        N = intervals
        return cls(space, np.zeros((6, 12)), np.zeros((6, 12)), np.zeros((N, 12)), np.zeros(6), np.zeros(6),
                   np.ones(12), np.ones(12), np.zeros((N + 1, 12)))  # fmt: skip


class LinearSolver(Protocol):
    """The record of a linear solver, a NamedTuple: its factors and scratch."""

    @classmethod
    def empty(cls, intervals: int) -> Self:
        """Zeros for a rod of `intervals` intervals."""


@dispatched
def factor(linear: LinearSolver, Y: Array, past: Array, c0: float, h: float, nodes: Nodes,
           system: System) -> int:  # fmt: skip
    """Do all that the tangents at the iterate `Y` (n, 12) are needed for; return how it ended, see `status`.

    `past` (n, 15), c0: see `history`; h: length of an interval (m).
    """
    raise NotImplementedError("a linear solver needs a variant of factor")


@dispatched
def solve(linear: LinearSolver, system: System, scale: float, b: Array, x: Array) -> None:
    """Solve with the factors into `x` (n, 12): right-hand side `b` (N, 12), and `scale` times all other residuals."""
    raise NotImplementedError("a linear solver needs a variant of solve")


@dispatched
def solves_again(linear: LinearSolver) -> bool:
    """Whether `solve` takes any right-hand side, as contact needs it, or but the system's own residuals."""
    return True


@dispatched
def take_own_unknowns(linear: LinearSolver, fraction: float, h: float, system: System) -> None:
    """Subtract `fraction` of the increments of the unknowns that a solver has beside Y; most have none."""
