"""What a step of three stages asks of segments, in space or about one axis.

The records are those of `segments.chain` or `one_axis.chain`, and say which kernels are meant; `touch` and `coupling`
are what contact needs, or None.
"""

from __future__ import annotations

from typing import Any

from solver.arrays import Array
from solver.kernels.dispatch import dispatched

Record = Any
"""A record of either kind of segments."""


@dispatched
def in_contact(touch: Record) -> bool:
    """Whether there may be contact in the step."""
    raise NotImplementedError


@dispatched
def become(state: Record, stages: Record) -> None:
    """Write the state at the last stage."""
    raise NotImplementedError


@dispatched
def extrapolate(before: Record, theta: Array, dt: float, state: Record, nodes: Array, weights: Array, ratio: float,
                ahead: Array) -> None:  # fmt: skip
    """Write theta of a step of ratio dt from `state`, if the motion of the last step, by `theta` from the state
    `before` in dt, goes on: `weights` (3, 3) of its stages give the departure from its steady rotation."""
    raise NotImplementedError


@dispatched
def begin_step(state: Record, nodes: Array, dt: float, stages: Record) -> None:
    """Write what stays as it is while the stages are iterated on."""
    raise NotImplementedError


@dispatched
def move(chain: Record, state: Record, stages: Record, nodes: Array, inverse: Array, dt: float) -> float:
    """Write all that follows from theta and shift at all stages, return the largest |theta|; `inverse` is A^-1."""
    raise NotImplementedError


@dispatched
def press_stages(chain: Record, stages: Record, driven: Record, touch: Record, coupling: Record, fresh: bool) -> None:
    """Write the forces of contact at all stages; where `fresh`, with their tangents."""
    raise NotImplementedError


@dispatched
def join_stages(chain: Record, stages: Record) -> None:
    """Write the moments of the joints at all stages."""
    raise NotImplementedError


@dispatched
def evaluate(chain: Record, loads: Record, driven: Record, stages: Record, residuals: Record) -> None:
    """Write these moments, and the residuals of all stages."""
    raise NotImplementedError


@dispatched
def missed_by_bodies(driven: Record, stages: Record, residuals: Record, noise: float) -> float:
    """The largest force that a body at an end misses at a stage, in the rod's largest; 0 where there is none. Less what
    the `noise` (m/s^2) of the accelerations makes of it."""
    raise NotImplementedError


@dispatched
def tangents_at(chain: Record, loads: Record, driven: Record, stages: Record, i: int, tangents: Record) -> None:
    """Write the tangents of the balances and ends at stage i."""
    raise NotImplementedError


@dispatched
def turn_residuals(driven: Record, stages: Record, tangents: Record, residuals: Record) -> None:
    """Turn what is in material components from the stages' own frames into those of the tangents: else a rod that
    spins by an angle x in a step converges by about x."""
    raise NotImplementedError


@dispatched
def resist(chain: Record, driven: Record, tangents: Record, rate: float, velocity: Record, forces: Array,
           ends: Array) -> None:  # fmt: skip
    """Write the forces of inertia (N, .) on the segments for accelerations `rate` `velocity` of their centres, and what
    bodies at the ends that move with these miss (2, .)."""
    raise NotImplementedError
