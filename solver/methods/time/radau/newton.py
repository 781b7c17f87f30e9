"""One Radau IIA step: simplified Newton on the three stages at once, and the estimate of its error.

With delta = T d the stages' increments fall apart into one real and one complex system (Hairer & Wanner II, IV.8); the
tangents are those at the middle stage of the first guess, for all stages and iterations.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from solver.arrays import Array
from solver.kernels.handed import Reference
from solver.kernels.kernel import inlined, kernel
from solver.kernels.scratch import scratch
from solver.methods.linear.segments_contact import Coupling, press_stages, solve_with_contact
from solver.methods.linear.tridiagonal import Factors, displace, factor, load_rows, node_moves, solve, solve_stages
from solver.methods.space.segments.balances import Driven, Tangents, balance_segments, condition_ends, segment_tangents
from solver.methods.space.segments.chain import STAGES, Chain, Residuals, Stages, State
from solver.methods.space.segments.joints import bend_joints
from solver.methods.space.segments.motion import LARGEST_TURN, move, spin_steadily
from solver.methods.status import CONVERGED, SINGULAR, STALLED
from solver.physics.contact.forces import touching
from solver.physics.ends import LOAD, RATE
from solver.physics.loads.registry import Loads

LARGEST_ITERATIONS = 12
LARGEST_INCREMENT = 1e3
"""Increment at which an iteration is given up."""
TOLERANCE = 1e-10
"""Remaining increment, rotation (rad) and force in EJ/L^2 relative to its largest, at which an iteration has converged:
far below a buckling seed. A step may leave a part of its largest departure from steady rotation, if that is more; not
of the rotation itself, for a rod may spin fast with a small seed."""

IN_CONTACT = 10.0
"""How many times more a step in contact may leave, whose error is that of strands that rattle."""


class Scheme(NamedTuple):
    """Radau's coefficients as the kernels take them: see `tableau`."""

    nodes: Array
    inverse: Array
    transform: Array
    back: Array
    gamma: float
    pair: complex
    error: Array


class Work(NamedTuple):
    """Arrays that a step writes and nobody keeps: residuals and their transforms, tangents, both factored systems."""

    residuals: Residuals
    transformed: Residuals
    tangents: Tangents
    real: Factors
    pair: Factors
    coupling: Coupling

    @classmethod
    def empty(cls, intervals: int, touching: bool) -> Work:
        """Zeros for N = `intervals`."""
        return cls(Residuals.empty(intervals), Residuals.empty(intervals), Tangents.empty(intervals),
                   Factors.empty(intervals, np.float64), Factors.empty(intervals, np.complex128),
                   Coupling.empty(intervals if touching else 0))  # fmt: skip


@kernel
def mix(weights: Array, source: Array, target: Array) -> None:
    """target[i] = sum over j of weights[i, j] source[j], stages first."""
    count = source.size // STAGES
    given, mixed = source.reshape(STAGES, count), target.reshape(STAGES, count)
    for m in range(count):
        a, b, c = given[0, m], given[1, m], given[2, m]
        for i in range(STAGES):
            mixed[i, m] = weights[i, 0] * a + weights[i, 1] * b + weights[i, 2] * c


@kernel
def join_stages(chain: Chain, stages: Stages) -> None:
    """Write the moments of all stages, whose motion is known."""
    for i in range(STAGES):
        bend_joints(chain, stages.quaternion[i], stages.bend[i], stages.moment[i], stages.left[i], stages.right[i])


@kernel
def evaluate(chain: Chain, loads: Loads, driven: Driven, stages: Stages, residuals: Residuals) -> None:
    """Write the residuals of all stages, whose motion and forces of contact are known."""
    join_stages(chain, stages)
    for i in range(STAGES):
        balance_segments(chain, loads, driven, stages, residuals, i)
        condition_ends(chain, driven, stages, residuals, i)


@kernel
def _turn_residuals(driven: Driven, stages: Stages, R: Array, residuals: Residuals) -> None:
    """Turn the rows in material components from the stages' own frames into the tangents' frames `R`.

    Where an end's conditions are of two kinds, only among components of one kind: exact for a frame that spins about
    the axis of the odd one. Without it a rod that spins by an angle x in a step converges by a factor of only about x.
    """
    n = len(R)
    old, turned = scratch(3), scratch((3, 3))
    for i in range(STAGES):
        for a in range(n):
            Q, row = stages.R[i, a], residuals.rotation[i, a]
            x = Q[0, 0] * row[0] + Q[0, 1] * row[1] + Q[0, 2] * row[2]
            y = Q[1, 0] * row[0] + Q[1, 1] * row[1] + Q[1, 2] * row[2]
            z = Q[2, 0] * row[0] + Q[2, 1] * row[1] + Q[2, 2] * row[2]
            if 0 < a < n - 1:
                for k in range(3):
                    row[k] = R[a, 0, k] * x + R[a, 1, k] * y + R[a, 2, k] * z
                continue
            side = 0 if a == 0 else 1
            for k in range(3):
                for m in range(3):
                    turned[k, m] = R[a, 0, k] * Q[0, m] + R[a, 1, k] * Q[1, m] + R[a, 2, k] * Q[2, m]
            for first, rows in ((3, row), (0, residuals.ends[i, side])):
                old[:] = rows
                for k in range(3):
                    kind = driven.kinds[side, first + k]
                    if kind in (RATE, LOAD):
                        rows[k] = 0.0
                        for m in range(3):
                            if driven.kinds[side, first + m] == kind:
                                rows[k] += turned[k, m] * old[m]


@kernel
def update(chain: Chain, scheme: Scheme, unit: float, fraction: float, stages: Stages, tangents: Tangents,
           real: Factors, pair: Factors) -> tuple[float, float]:  # fmt: skip
    """Add a fraction of the increments to the stages; return their size: rotation (rad), force by the largest one."""
    T, frame = scheme.transform, tangents.R
    turned, forced, largest = 0.0, 0.0, unit
    for i in range(STAGES):
        t0, t1, t2 = fraction * T[i, 0], fraction * T[i, 1], fraction * T[i, 2]
        for a in range(stages.theta.shape[1]):
            x, z = real.x[a], pair.x[a]
            c0 = t0 * x[0] + t1 * z[0].real + t2 * z[0].imag
            c1 = t0 * x[1] + t1 * z[1].real + t2 * z[1].imag
            c2 = t0 * x[2] + t1 * z[2].real + t2 * z[2].imag
            Q, R = frame[a], stages.start[a]
            u = Q[0, 0] * c0 + Q[0, 1] * c1 + Q[0, 2] * c2
            v = Q[1, 0] * c0 + Q[1, 1] * c1 + Q[1, 2] * c2
            w = Q[2, 0] * c0 + Q[2, 1] * c1 + Q[2, 2] * c2
            p0 = R[0, 0] * u + R[1, 0] * v + R[2, 0] * w
            p1 = R[0, 1] * u + R[1, 1] * v + R[2, 1] * w
            p2 = R[0, 2] * u + R[1, 2] * v + R[2, 2] * w
            theta = stages.theta[i, a]
            u, v, w = theta[0], theta[1], theta[2]
            # a rotation by p in the frame of R_n changes theta by p - theta x p / 2 + ...
            c0, c1, c2 = v * p2 - w * p1, w * p0 - u * p2, u * p1 - v * p0
            theta[0] += p0 - 0.5 * c0 + (1 / 12) * (v * c2 - w * c1)
            theta[1] += p1 - 0.5 * c1 + (1 / 12) * (w * c0 - u * c2)
            theta[2] += p2 - 0.5 * c2 + (1 / 12) * (u * c1 - v * c0)
            turned = max(turned, abs(p0), abs(p1), abs(p2))
            if not np.isfinite(p0):
                return np.inf, np.inf
        for a in range(stages.F.shape[1]):
            for k in range(3):
                change = t0 * real.x[a, 3 + k] + t1 * pair.x[a, 3 + k].real + t2 * pair.x[a, 3 + k].imag
                stages.F[i, a, k] += change
                forced = max(forced, abs(change))
                largest = max(largest, abs(stages.F[i, a, k]))
        for k in range(3):
            z0 = node_moves(chain, tangents, pair, 0, k)
            stages.shift[i, k] += t0 * node_moves(chain, tangents, real, 0, k).real + t1 * z0.real + t2 * z0.imag
    return turned / fraction, forced / (fraction * largest)


@kernel
def transform_residuals(driven: Driven, scheme: Scheme, stages: Stages, R: Array, residuals: Residuals,
                        transformed: Residuals) -> None:  # fmt: skip
    """Write the residuals, in the tangents' frames `R`, as the right-hand sides of the real and the complex system."""
    _turn_residuals(driven, stages, R, residuals)
    mix(scheme.back, residuals.rotation, transformed.rotation)
    mix(scheme.back, residuals.translation, transformed.translation)
    mix(scheme.back, residuals.ends, transformed.ends)


@kernel
def factor_both(chain: Chain, loads: Loads, driven: Driven, scheme: Scheme, dt: float, stages: Stages,
                tangents: Tangents, real: Factors, pair: Factors) -> bool:  # fmt: skip
    """Write the tangents at the middle stage, and factor the real and the complex system; False if one is singular."""
    segment_tangents(chain, loads, driven, stages, 1, tangents)
    if not factor(chain, driven, tangents, scheme.gamma / dt, real):
        return False
    return bool(factor(chain, driven, tangents, scheme.pair / dt, pair))


@inlined
def is_enough(size: float, before: float) -> bool:
    """Whether an increment, or the sum of those that would follow it at its rate, is below 1."""
    rate = size / before if before > 0.0 else 1.0
    return size < 1.0 or (rate < 1.0 and size * rate / (1.0 - rate) < 1.0)


@inlined
def diverges(iteration: int, size: float, before: float) -> bool:
    """Whether an increment is more than twice the one before it, after the first two."""
    return iteration > 2 and before > 0.0 and size > 2.0 * before


@kernel
def step(given: Reference, dt: float, unit: float, part: float, state: State) -> tuple[int, int]:
    """Solve for the stages of a step of dt; theta, shift and F hold the first guess. `unit` = EJ/L^2 (N).

    `given`: a Chain, Loads, Driven, Scheme, Stages, Touch and Work. `part` of the step's largest departure from steady
    rotation may be left, where that is more than TOLERANCE. Returns how it ended and the iterations. Records of many
    arrays go only to where they are needed: each one passed on costs some ns in every iteration.
    """
    chain, loads, driven, scheme, stages, touch, work = given.records
    before, contact = 0.0, touching(touch)
    residuals, transformed, tangents, real, pair = work.residuals, work.transformed, work.tangents, work.real, work.pair
    spin_steadily(state, scheme.nodes, dt, stages)
    for iteration in range(1, LARGEST_ITERATIONS + 1):
        if not move(state, stages, scheme.inverse, dt, chain.h) < LARGEST_TURN:
            return STALLED, iteration
        if contact:
            press_stages(chain, stages, driven, touch, work.coupling)
        evaluate(chain, loads, driven, stages, residuals)
        if iteration == 1:
            work.coupling.known[0] = 0
            if not factor_both(chain, loads, driven, scheme, dt, stages, tangents, real, pair):
                return SINGULAR, iteration
        transform_residuals(driven, scheme, stages, tangents.R, residuals, transformed)
        fraction, gamma, lambda_ = 1.0, scheme.gamma / dt, scheme.pair / dt
        if contact:
            fraction = solve_with_contact(chain, driven, tangents, scheme.transform, scheme.back, scheme.inverse, gamma,
                                          lambda_, dt, transformed, real, pair, touch, work.coupling)  # fmt: skip
        else:
            solve_stages(chain, driven, tangents, gamma, lambda_, transformed, real, pair)
        turned, forced = update(chain, scheme, unit, fraction, stages, tangents, real, pair)
        if not max(turned, forced) < LARGEST_INCREMENT:
            return STALLED, iteration
        share = part * IN_CONTACT if contact else part
        enough = max(TOLERANCE, share * largest_departure(stages))
        # contact's forces are as large as they are whatever the step: what counts is their own relative error
        size = max(turned / enough, forced / (max(enough, share) if contact else enough))
        if is_enough(size, before):
            move(state, stages, scheme.inverse, dt, chain.h)
            if contact:
                press_stages(chain, stages, driven, touch, work.coupling)
            join_stages(chain, stages)
            return CONVERGED, iteration
        if diverges(iteration, size, before) and not contact:
            return STALLED, iteration
        before = size if fraction == 1.0 else 0.0
    return STALLED, LARGEST_ITERATIONS


@kernel
def largest_departure(stages: Stages) -> float:
    """The largest component of a segment's departure from steady rotation in the step (rad)."""
    largest = 0.0
    for a in range(1, stages.theta.shape[1] - 1):
        for k in range(3):
            largest = max(largest, abs(stages.theta[STAGES - 1, a, k]))
    return largest


@kernel
def estimate_error(given: Reference, dt: float, state: State, centres: Array) -> tuple[float, float, float, float]:
    """The embedded estimate of the step's error, and the motion: rotation (rad) error, motion; position (m) likewise.

    `given`: see `step`; `centres` (3, N, 3): position, velocity and acceleration of the centres at the start of the
    step. The estimate of order 3, g = dt/gamma y'(t) + sum of e_i (Y_i - y), is smoothed by the real system, M mu^2 +
    C mu + K, as it was factored; the first stage of the transformed residuals is overwritten.
    """
    chain, _, driven, scheme, stages, _, work = given.records
    residuals, tangents, factors = work.transformed, work.tangents, work.real
    mu, e = scheme.gamma / dt, scheme.error
    rotation, translation = residuals.rotation[0], residuals.translation[0]
    residuals.ends[0] = 0.0
    rotation[:] = 0.0
    turned, moved = 0.0, 0.0
    for a in range(1, len(rotation) - 1):
        for k in range(3):
            place, rate = 0.0, state.alpha[a, k] / mu
            for i in range(STAGES):
                place += e[i] * stages.theta[i, a, k]
                rate += e[i] * stages.theta_t[i, a, k]
            rotation[a, k] = -chain.h * chain.inertia[a - 1, k] * mu * (mu * place + rate)
            turned = max(turned, abs(stages.theta[2, a, k] + dt * state.omega[a, k]))
    place3, rate3 = scratch(3), scratch(3)
    for j in range(len(translation)):
        for k in range(3):
            place3[k], rate3[k] = centres[1, j, k] / mu, centres[2, j, k] / mu
            for i in range(STAGES):
                place3[k] += e[i] * (stages.r[i, j, k] - centres[0, j, k])
                rate3[k] += e[i] * (stages.V[i, j, k] - centres[1, j, k])
            moved = max(moved, abs(stages.r[2, j, k] - centres[0, j, k]))
        for k in range(3):
            translation[j, k] = 0.0
            for m in range(3):
                translation[j, k] -= tangents.M[j, k, m] * mu * (mu * place3[m] + rate3[m])
    load_rows(chain, driven, tangents, mu, rotation, translation, residuals.ends[0], factors)
    solve(factors)
    displace(factors)
    turn_error, move_error = 0.0, 0.0
    for a in range(1, len(rotation) - 1):
        for k in range(3):
            turn_error = max(turn_error, abs(factors.x[a, k]))
    for j in range(len(translation)):
        for k in range(3):
            move_error = max(move_error, abs(factors.moved[j, k]))
    return turn_error, turned, move_error, moved


@kernel
def finish(given: Reference, new: State) -> None:
    """Write the state at the end of the step, the last stage, into `new`. `given`: see `step`."""
    _, _, _, _, stages, _, _ = given.records
    last = STAGES - 1
    new.quaternion[:] = stages.quaternion[last]
    new.omega[:] = stages.omega[last]
    new.alpha[:] = stages.alpha[last]
    new.base[:] = stages.base[last]
    new.F[:] = stages.F[last]
