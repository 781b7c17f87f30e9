"""From one Radau IIA step to the next: what the last one leaves, and the first guess of the next one by it.

Written once for segments in space and about one axis: their records say which kernels are meant (`kernels.dispatch`).
"""

from __future__ import annotations

from typing import NamedTuple

from solver.arrays import Array
from solver.kernels.copying import copy
from solver.kernels.handed import Reference
from solver.kernels.kernel import inlined, kernel
from solver.kernels.scratch import scratch
from solver.methods.space.segments.chain import STAGES
from solver.methods.space.stages import Record, become, begin_step, extrapolate, move
from solver.methods.time.radau.newton import mix


class Last(NamedTuple):
    """The unknowns of the last step at its stages: see `segments.chain.Stages`."""

    theta: Array
    shift: Array
    F: Array


@kernel
def finish(reference: Reference, state: Record, centres: Array, last: Last) -> None:
    """Write the `state` at the end of a step, the places, velocities and accelerations of its segments' `centres`
    (3, N, ...), and the unknowns of what is now the `last` step."""
    stages = reference.stages
    become(state, stages)
    copy(stages.r[STAGES - 1], centres[0])
    copy(stages.V[STAGES - 1], centres[1])
    copy(stages.A[STAGES - 1], centres[2])
    copy(stages.theta, last.theta)
    copy(stages.shift, last.shift)
    copy(stages.F, last.F)


@inlined
def _parabola(coefficients: Array, j: int, x: float) -> float:
    """What stage j adds to a polynomial in x."""
    return float(coefficients[0, j] + x * (coefficients[1, j] + x * coefficients[2, j]))


@kernel
def go_on(reference: Reference, last: Last, before: Record, state: Record, dt_last: float, dt: float) -> None:
    """Guess theta, shift and F at the stages of a step of dt from `state`, by the `last` one of dt_last from `before`.

    Motion goes on along the cubic through the last step's begin and stages, forces along the parabola through these.
    """
    scheme, stages = reference.scheme, reference.stages
    ratio, cubic, parabola = dt / dt_last, scratch((3, 3)), scratch((3, 3))
    for i in range(STAGES):
        x = 1.0 + ratio * scheme.nodes[i]
        for j in range(STAGES):
            cubic[i, j], parabola[i, j] = x * _parabola(scheme.cubic, j, x), _parabola(scheme.parabola, j, x)
    extrapolate(before, last.theta, dt_last, state, scheme.nodes, cubic, ratio, stages.theta)
    mix(cubic, last.shift, stages.shift)
    each = last.shift.size // STAGES
    gone, shift = last.shift.reshape(STAGES, each), stages.shift.reshape(STAGES, each)
    for i in range(STAGES):
        for k in range(each):
            shift[i, k] -= gone[STAGES - 1, k]
    mix(parabola, last.F, stages.F)


@kernel
def move_guess(reference: Reference, dt: float, state: Record) -> None:
    """Write how the first guess of a step of dt moves at all stages."""
    chain, scheme, stages = reference.chain, reference.scheme, reference.stages
    begin_step(state, scheme.nodes, dt, stages)
    move(chain, state, stages, scheme.nodes, scheme.inverse, dt)
