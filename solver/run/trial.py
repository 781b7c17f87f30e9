"""A resolution that a run to a tolerance tries, see `plan`.

It is a mesh of some 16 times 2^mesh intervals (see `first_mesh`) and steps whose error relative to their motion, as the
embedded formula has it, is at most FIRST_STEPS tolerance^(1/2) / 4^steps: where the motion is smooth, the true one
falls faster.
"""

from __future__ import annotations

from math import sqrt
from typing import NamedTuple

FIRST_INTERVALS = 16
"""Of the coarsest mesh, or somewhat more: see `first_mesh`."""
FIRST_STEPS = 0.5
STRIDES = 5
"""Frames that a step may pass at the most, see `Numerics`, and does at tolerances from 1e-3 on. Where the motion is
smooth, which such steps are for, their error is of order 5."""
LOOSEST, AT_REST, DAMPED = -2, -9, -11
"""The longest steps that are tried; what stands for those of a static analysis, which make no error and are no other
when they are tried again; and what stands for the longest steps of a rod with an artificial viscosity, as do all
numbers below, see `grade_of`. (Those between stood for longer steps in checkpoints that may still be there.)"""


class Trial(NamedTuple):
    """Numbers of a mesh and of steps."""

    mesh: int
    steps: int


def intervals_of(mesh: int, first: int = FIRST_INTERVALS) -> int:
    """Of a mesh; `first`: of the coarsest."""
    return int(first * 2**mesh)


def step_tolerance(steps: int, tolerance: float) -> float:
    """The largest error of a step relative to its motion."""
    return FIRST_STEPS * sqrt(tolerance) / 4.0 ** max(steps, LOOSEST)


def grade_of(steps: int) -> int | None:
    """The grade of the rod's artificial viscosity, see `artificial_viscosity`; None where it has none."""
    return DAMPED - steps if steps <= DAMPED else None


def strides_of(tolerance: float, steps: int = 0) -> int:
    """How many frames a step may pass; none where steps are longer than their error allows, as to get to the end."""
    if steps < 0:
        return 1
    return int(max(round(STRIDES * min(tolerance / 1e-3, 1.0) ** 0.2), 1))


def longest_step(steps: int, interval: float) -> float:
    """The longest step (s), in strides, where frames are an `interval` apart: waves that two runs damp alike show in
    neither."""
    return interval / 2.0 ** max(steps, 0)
