"""What is asked of a trial before it is taken, in one pass."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from solver.arrays import Array
from solver.kernels.kernel import inner, kernel
from solver.kernels.rotation import tangent_of
from solver.methods.space.box.fields import KAPPA, OMEGA, State, V


class Measured(NamedTuple):
    """The largest strain of an interval, rotation (rad) within one, change of a component of dV/dt (m/s^2) and
    displacement along an axis (m) in the step; K = int |kappa_bending| ds (rad); and the rate (rad/s) at which the
    tangents turn. A number that is not finite makes them all NaN."""

    strain: float
    turn: float
    acceleration: float
    motion: float
    bending: float
    turning: float


@kernel
def measure_trial(old: State, new: State, h: float, stretch: Array) -> Measured:
    """Measure the step from `old` to `new`; write what it has lost of inextensibility into `stretch` (N, 3)."""
    strain = measure_stretch(new, h, stretch)
    turn, acceleration, motion, poison = 0.0, 0.0, 0.0, 0.0
    for j in range(len(new.Y)):
        square = 0.0
        for i in range(3):
            square += new.Y[j, KAPPA + i] ** 2
            change, moved = new.rate[j, V + i] - old.rate[j, V + i], new.r[j, i] - old.r[j, i]
            acceleration, motion = max(acceleration, abs(change)), max(motion, abs(moved))
            poison += 0.0 * (change + moved)
        turn = max(turn, square)
        poison += 0.0 * square
    bending = total_bending(new.Y, h)
    return Measured(strain + poison, h * np.sqrt(turn) + poison, acceleration + poison, motion + poison,
                    bending + poison, mean_turning(new.Y) + poison)  # fmt: skip


@kernel
def total_bending(Y: Array, h: float) -> float:
    """K = int |kappa_bending| ds (rad)."""
    total = 0.0
    for j in range(len(Y) - 1):
        one = 0.5 * (Y[j, KAPPA] + Y[j + 1, KAPPA])
        two = 0.5 * (Y[j, KAPPA + 1] + Y[j + 1, KAPPA + 1])
        total += np.sqrt(one * one + two * two)
    return h * total


@kernel
def mean_turning(Y: Array) -> float:
    """The rate (rad/s) at which the tangents turn, |omega x a3|: its root mean square along the rod."""
    total = 0.0
    for j in range(len(Y) - 1):
        for node in (j, j + 1):
            total += 0.5 * (Y[node, OMEGA] ** 2 + Y[node, OMEGA + 1] ** 2)
    return float(np.sqrt(total / (len(Y) - 1)))


@inner
def measure_stretch(state: State, h: float, stretch: Array) -> float:
    """Write Delta r - h T_m (N, 3), lab: what inextensibility has lost to the scheme in space and to time.

    Gives the largest strain of an interval: what was written, over h, or by how much the chord is longer than h or
    shorter than by 1 - (kappa h)^2 / 8.
    """
    strain, bend = 0.0, h * h * (state.Y[0, KAPPA] ** 2 + state.Y[0, KAPPA + 1] ** 2)
    right = tangent_of(state.quaternion[0])
    for j in range(len(stretch)):
        left, right = right, tangent_of(state.quaternion[j + 1])
        for i in range(3):
            stretch[j, i] = state.r[j + 1, i] - state.r[j, i] - 0.5 * h * (left[i] + right[i])
            strain = max(strain, abs(stretch[j, i]) / h)
        square = 0.0
        for i in range(3):
            square += (state.r[j + 1, i] - state.r[j, i]) ** 2
        chord = np.sqrt(square) / h
        before, bend = bend, h * h * (state.Y[j + 1, KAPPA] ** 2 + state.Y[j + 1, KAPPA + 1] ** 2)
        strain = max(strain, chord - 1.0, 1.0 - max(before, bend) / 8.0 - chord)
    return strain
