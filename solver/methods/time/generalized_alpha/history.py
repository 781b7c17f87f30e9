"""Generalized-alpha in time: what the past contributes to a step, and what the step leaves behind.

Jansen, Whiting & Hulbert 2000 in the form of Arnold & Bruels 2007: the balances hold at t_{n+1} with the true
rates; an auxiliary rate a carries the parameters,

    a_{n+am} = z'_{n+af},   z_{n+1} = z_n + dt ((1 - gamma) a_n + gamma a_{n+1}).

So every equation, the constraint and its multiplier f live at one time level, and all converge with order 2.
"""

from __future__ import annotations

from solver.arrays import Array
from solver.kernels.kernel import kernel
from solver.methods.schemes import Scheme, c0_of
from solver.methods.space.box.fields import OMEGA, State, V


@kernel
def history(state: State, scheme: Scheme, dt: float, past: Array) -> None:
    """Write what the past contributes to the step into `past` (n, 15).

    At t_{n+1}: r = past[:, 0:3] + V / c0, theta (from R_n) = past[:, 3:6] + omega / c0, and the rates of
    V, omega, kappa are c0 * value + past[:, 6:15].
    """
    am, af, gamma, c0 = scheme.alpha_m, scheme.alpha_f, scheme.gamma, c0_of(scheme, dt)
    keep_rate = dt * gamma / am * (1.0 - af)
    keep_aux = dt * ((1.0 - gamma) - gamma / am * (1.0 - am))
    mix_aux = ((1.0 - am) - am * (1.0 - gamma) / gamma) / af
    mix_rate = -(1.0 - af) / af
    for j in range(len(past)):
        for i in range(3):
            past[j, i] = state.r[j, i] + keep_rate * state.Y[j, V + i] + keep_aux * state.aux[j, i]
            past[j, 3 + i] = keep_rate * state.Y[j, OMEGA + i] + keep_aux * state.aux[j, 3 + i]
        for i in range(9):
            past[j, 6 + i] = -c0 * state.Y[j, i] + mix_aux * state.aux[j, 6 + i] + mix_rate * state.rate[j, i]


@kernel
def rescale_aux(state: State, ratio: float) -> None:
    """Move the auxiliary rates to the new step, dt_new = ratio * dt_old.

    a_n stands for the rate at t_n + (alpha_m - alpha_f) dt; without this a change of step costs an order.
    """
    for j in range(len(state.Y)):
        for i in range(3):
            state.aux[j, i] = state.Y[j, V + i] + ratio * (state.aux[j, i] - state.Y[j, V + i])
            state.aux[j, 3 + i] = state.Y[j, OMEGA + i] + ratio * (state.aux[j, 3 + i] - state.Y[j, OMEGA + i])
        for i in range(9):
            state.aux[j, 6 + i] = state.rate[j, i] + ratio * (state.aux[j, 6 + i] - state.rate[j, i])


@kernel
def finish(old: State, new: State, scheme: Scheme, dt: float, past: Array) -> None:
    """Write the rates and auxiliary rates of `new` (its Y is given) at the end of the step from `old`."""
    am, af, c0 = scheme.alpha_m, scheme.alpha_f, c0_of(scheme, dt)
    for j in range(len(past)):
        for i in range(9):
            new.rate[j, i] = c0 * new.Y[j, i] + past[j, 6 + i]
            true = af * new.rate[j, i] + (1.0 - af) * old.rate[j, i]
            new.aux[j, 6 + i] = (true - (1.0 - am) * old.aux[j, 6 + i]) / am
        for i in range(6):
            true = af * new.Y[j, i] + (1.0 - af) * old.Y[j, i]
            new.aux[j, i] = (true - (1.0 - am) * old.aux[j, i]) / am
