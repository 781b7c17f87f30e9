"""What Newton's iteration starts from: the motion of the last step goes on."""

from __future__ import annotations

from solver.arrays import Array
from solver.kernels.kernel import kernel
from solver.methods.space.box.fields import F, State


@kernel
def guess(state: State, F_rate: Array, dt: float, Y: Array) -> None:
    """Write Y (n, 12) after dt at the present rates; `F_rate` (n, 3) is that of the last step."""
    for j in range(len(Y)):
        for i in range(9):
            Y[j, i] = state.Y[j, i] + dt * state.rate[j, i]
        for i in range(3):
            Y[j, F + i] = state.Y[j, F + i] + dt * F_rate[j, i]


@kernel
def force_rate(before: Array, Y: Array, dt: float, F_rate: Array) -> None:
    """Write the mean rate of F (n, 3) in a step of dt, from Y (n, 12) before and after."""
    for j in range(len(Y)):
        for i in range(3):
            F_rate[j, i] = (Y[j, F + i] - before[j, F + i]) / dt


@kernel
def stretch_feedback(stretch: Array, before: Array, ahead: float, gain: float, feedback: Array) -> None:
    """Write the rate (N, 3) at which a step takes back the stretch: gain (1/s) times what it will be at its end.

    `stretch` (N, 3) is of the state, `before` of the state before; `ahead`: the step over the last one.
    """
    for j in range(len(stretch)):
        for i in range(3):
            feedback[j, i] = gain * (stretch[j, i] + ahead * (stretch[j, i] - before[j, i]))
