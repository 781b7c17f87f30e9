"""One Radau IIA step about one axis: `staggered.newton` with fewer unknowns, and the same decisions."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from solver.arrays import Array
from solver.kernels.handed import Reference
from solver.kernels.kernel import kernel
from solver.kernels.scratch import scratch
from solver.methods.linear.one_axis import Factors, factor, load_rows, solve, solve_pair, solve_real
from solver.methods.space.one_axis.axis import Plane
from solver.methods.space.one_axis.balances import Driven, Tangents, along, balance, tangents_at
from solver.methods.space.one_axis.chain import Chain, Residuals, Stages, State
from solver.methods.space.one_axis.motion import bend_joints, move
from solver.methods.space.segments.chain import STAGES
from solver.methods.space.segments.motion import LARGEST_TURN
from solver.methods.status import CONVERGED, SINGULAR, STALLED
from solver.methods.time.radau.newton import (
    LARGEST_INCREMENT,
    LARGEST_ITERATIONS,
    TOLERANCE,
    Scheme,
    diverges,
    is_enough,
    mix,
)
from solver.physics.ends import LOAD, RATE


class Work(NamedTuple):
    """Arrays that a step writes and nobody keeps: residuals and their transforms, tangents, both factored systems."""

    residuals: Residuals
    transformed: Residuals
    tangents: Tangents
    real: Factors
    pair: Factors

    @classmethod
    def empty(cls, intervals: int) -> Work:
        """Zeros for N = `intervals`."""
        return cls(Residuals.empty(intervals), Residuals.empty(intervals), Tangents.empty(intervals),
                   Factors.empty(intervals, np.float64), Factors.empty(intervals, np.complex128))  # fmt: skip


@kernel
def _turn_ends(driven: Driven, stages: Stages, tangents: Tangents, ends: Array) -> None:
    """Turn the rows in material components from the stages' own frames into the tangents', among those of one kind."""
    for i in range(STAGES):
        for side in range(2):
            frame = 0 if side == 0 else len(tangents.T) - 1
            turn, kinds, d = stages.T[i, frame] / tangents.T[frame], driven.kinds[side], driven.direction[side]
            one, two = ends[i, side, 0], ends[i, side, 1]
            for k in range(2):
                if kinds[k] in (RATE, LOAD):
                    ends[i, side, k] = 0.0
                    for m, old in ((0, one), (1, two)):
                        if kinds[m] == kinds[k]:
                            ends[i, side, k] += along(d[k], turn * d[m]) * old


@kernel
def _update(scheme: Scheme, chain: Chain, unit: float, stages: Stages, work: Work) -> tuple[float, float]:
    """Add the increments to the stages; return their size: rotation (rad), force by the largest one."""
    T, x, z, half = scheme.transform, work.real.x, work.pair.x, 0.5 * chain.h * chain.swing
    turned, forced, largest = 0.0, 0.0, unit
    for i in range(STAGES):
        t0, t1, t2 = T[i, 0], T[i, 1], T[i, 2]
        for a in range(len(x)):
            psi = t0 * x[a, 0] + t1 * z[a, 0].real + t2 * z[a, 0].imag
            if not np.isfinite(psi):
                return np.inf, np.inf
            stages.theta[i, a] += psi
            turned = max(turned, abs(psi))
        for a in range(len(x) - 1):
            change = complex(t0 * x[a, 1] + t1 * z[a, 1].real + t2 * z[a, 1].imag,
                             t0 * x[a, 2] + t1 * z[a, 2].real + t2 * z[a, 2].imag)  # fmt: skip
            stages.F[i, a] += change
            forced = max(forced, abs(change.real), abs(change.imag))
            largest = max(largest, abs(stages.F[i, a].real), abs(stages.F[i, a].imag))
        # the start lies half a segment before the first centre
        psi = t0 * x[1, 0] + t1 * z[1, 0].real + t2 * z[1, 0].imag
        p, q = work.real.moved[0], work.pair.moved[0]
        moved = complex(t0 * p[0] + t1 * q[0].real + t2 * q[0].imag, t0 * p[1] + t1 * q[1].real + t2 * q[1].imag)
        stages.shift[i] += moved - half * psi * 1j * work.tangents.T[1]
    return turned, forced / largest


@kernel
def _largest(x: Array) -> float:
    """The largest of the segments' values, among those (N + 2,) of all orientations."""
    largest = 0.0
    for a in range(1, len(x) - 1):
        largest = max(largest, abs(x[a]))
    return largest


@kernel
def step(given: Reference, dt: float, unit: float, part: float, state: State) -> tuple[int, int]:
    """Solve for the stages of a step of dt, as `staggered.newton.step` does; how it ended and the iterations.

    `given`: a Chain, Loads, Driven, Scheme, Stages and Work.
    """
    chain, loads, driven, scheme, stages, work = given.records
    before, rows = 0.0, work.transformed
    gamma, pair = scheme.gamma / dt, scheme.pair / dt
    for iteration in range(1, LARGEST_ITERATIONS + 1):
        if not move(chain, state, stages, scheme.nodes, scheme.inverse, dt) < LARGEST_TURN:
            return STALLED, iteration
        for i in range(STAGES):
            balance(chain, loads, driven, stages, work.residuals, i)
        if iteration == 1:
            tangents_at(chain, loads, driven, stages, 1, work.tangents)
            if not (factor(chain, driven, work.tangents, gamma, work.real)
                    and factor(chain, driven, work.tangents, pair, work.pair)):  # fmt: skip
                return SINGULAR, iteration
        _turn_ends(driven, stages, work.tangents, work.residuals.ends)
        mix(scheme.back, work.residuals.rotation, rows.rotation)
        mix(scheme.back, work.residuals.translation, rows.translation)
        mix(scheme.back, work.residuals.ends, rows.ends)
        solve_real(chain, driven, work.tangents, gamma, rows, work.real)
        solve_pair(chain, driven, work.tangents, pair, rows, work.pair)
        size = max(_update(scheme, chain, unit, stages, work))
        if not size < LARGEST_INCREMENT:
            return STALLED, iteration
        size /= max(TOLERANCE, part * _largest(stages.theta[STAGES - 1]))
        if is_enough(size, before):
            move(chain, state, stages, scheme.nodes, scheme.inverse, dt)
            for i in range(STAGES):
                bend_joints(chain, stages.phi[i], stages.q[i])
            return CONVERGED, iteration
        if diverges(iteration, size, before):
            return STALLED, iteration
        before = size
    return STALLED, LARGEST_ITERATIONS


@kernel
def estimate_error(given: Reference, dt: float, state: State, centres: Plane) -> tuple[float, float, float, float]:
    """The embedded estimate of the step's error, and the motion: rotation (rad) error, motion; position (m) likewise.

    `given`: see `step`; `centres` (3, N): position, velocity and acceleration of the centres at the start of the step.
    As in `staggered.newton`.
    """
    chain, _, driven, scheme, stages, work = given.records
    mu, e, factors, tangents = scheme.gamma / dt, scheme.error, work.real, work.tangents
    turned, moved = 0.0, 0.0
    factors.x[:] = 0.0
    for a in range(1, len(state.phi) - 1):
        place, rate = 0.0, state.alpha[a] / mu
        for i in range(STAGES):
            place += e[i] * stages.theta[i, a]
            rate += e[i] * stages.theta_t[i, a]
        factors.x[a, 0] = chain.h * chain.inertia[a - 1] * mu * (mu * place + rate)
        turned = max(turned, abs(stages.theta[2, a] + dt * state.omega[a]))
        j = a - 1
        z, z_t = centres[1, j] / mu, centres[2, j] / mu
        for i in range(STAGES):
            z += e[i] * (stages.r[i, j] - centres[0, j])
            z_t += e[i] * (stages.V[i, j] - centres[1, j])
        gone = stages.r[2, j] - centres[0, j]
        moved = max(moved, abs(gone.real), abs(gone.imag))
        M, z = tangents.M[j], -mu * (mu * z + z_t)
        factors.load[j, 0] = M[0, 0] * z.real + M[0, 1] * z.imag
        factors.load[j, 1] = M[1, 0] * z.real + M[1, 1] * z.imag
    load_rows(chain, driven, tangents, mu, scratch((2, 2)), factors)
    solve(factors)
    move_error = 0.0
    for j in range(len(factors.moved)):
        move_error = max(move_error, abs(factors.moved[j, 0]), abs(factors.moved[j, 1]))
    return _largest(factors.x[:, 0]), turned, move_error, moved
