"""One Radau IIA step: simplified Newton on the three stages at once, and the estimate of its error.

With delta = T d the stages' increments fall apart into one real and one complex system (Hairer & Wanner II, IV.8); the
tangents are those at the middle stage of the first guess, for all stages and iterations. Where these converge slowly on
solids, as where parts of the rod come to stick to a floor or to slide, the tangents are written anew, and the
increments are relaxed (Irons & Tuck, Int. J. Numer. Methods Eng. 1 (1969) 275). See decision 0036.

Written once for segments in space and about one axis: their records say which kernels are meant (`kernels.dispatch`).
"""

from __future__ import annotations

from typing import NamedTuple

from solver.arrays import Array
from solver.kernels.handed import Reference
from solver.kernels.kernel import inlined, inner, kernel
from solver.methods.linear import stages as linear
from solver.methods.linear.stages import Scheme
from solver.methods.space import stages as space
from solver.methods.space.segments.chain import STAGES
from solver.methods.space.segments.motion import LARGEST_TURN
from solver.methods.space.stages import Record
from solver.methods.status import CONVERGED, SINGULAR, STALLED

LARGEST_ITERATIONS = 12
LARGEST_INCREMENT = 1e3
"""Increment at which an iteration is given up."""
TOLERANCE = 1e-10
"""Remaining increment, rotation (rad), force in EJ/L^2 relative to its largest, and the start's place in L, at which an
iteration has converged: far below a buckling seed. A step may leave a part of its largest departure from steady
rotation, and of that of the start from steady motion, if that is more; not of the rotation itself, for a rod may spin
fast with a small seed. (A rod that slides without turning has no other error than that of its place.)"""
OF_BODY, ROUNDING = 1e-5, 1e-14
"""What a step may leave of the force that a body at an end bears, relative to the rod's largest: its acceleration is
that of the rod's end, in which what is left of rotations and stretch, and rounding, this part of the rod's length, are
divided by the square of the step."""
ROUGH = 10.0
"""How many times more a step may leave that presses strands together or the rod against a solid, whose error is that of
what rattles."""
STALE = 0.3
"""Part of the increment before that one may be for the tangents to serve again where solids strike and rub."""
LEAST_PART, LARGEST_PART = 0.1, 2.0
"""Of an increment that is relaxed."""
SERVES = 0.7
"""Part of the increment before that one may be for the tangents of contact to serve again."""


class Work(NamedTuple):
    """Arrays that a step writes and nobody keeps: residuals and their transforms, tangents, both factored systems, what
    contact needs, `velocities` of the segments' centres, and the two systems' solutions before the last ones."""

    residuals: Record
    transformed: Record
    tangents: Record
    real: Record
    pair: Record
    coupling: Record
    velocities: Array
    earlier: Array
    earlier_pair: Array


class StepRecords(NamedTuple):
    """What the kernels of a step get by reference."""

    chain: Record
    loads: Record
    driven: Record
    scheme: Scheme
    stages: Record
    touch: Record
    work: Work


@inner
def mix(weights: Array, source: Array, target: Array) -> None:
    """target[i] = sum over j of weights[i, j] source[j], stages first."""
    count = source.size // STAGES
    values, mixed = source.reshape(STAGES, count), target.reshape(STAGES, count)
    for m in range(count):
        a, b, c = values[0, m], values[1, m], values[2, m]
        for i in range(STAGES):
            mixed[i, m] = weights[i, 0] * a + weights[i, 1] * b + weights[i, 2] * c


@inner
def transform_residuals(driven: Record, scheme: Scheme, stages: Record, tangents: Record, residuals: Record,
                        transformed: Record) -> None:  # fmt: skip
    """Write the residuals, in the tangents' frames, as the right-hand sides of the real and the complex system."""
    space.turn_residuals(driven, stages, tangents, residuals)
    mix(scheme.back, residuals.rotation, transformed.rotation)
    mix(scheme.back, residuals.translation, transformed.translation)
    mix(scheme.back, residuals.ends, transformed.ends)


@inner
def factor_both(chain: Record, loads: Record, driven: Record, scheme: Scheme, dt: float, stages: Record,
                tangents: Record, real: Record, pair: Record) -> bool:  # fmt: skip
    """Write the tangents at the middle stage, and factor the real and the complex system; False if one is singular."""
    space.tangents_at(chain, loads, driven, stages, 1, tangents)
    if not linear.factor(chain, driven, tangents, scheme.gamma / dt, real):
        return False
    return bool(linear.factor(chain, driven, tangents, scheme.pair / dt, pair))


@inlined
def is_enough(size: float, before: float) -> bool:
    """Whether an increment, or the sum of those that would follow it at its rate, is below 1."""
    rate = size / before if before > 0.0 else 1.0
    return size < 1.0 or (rate < 1.0 and size * rate / (1.0 - rate) < 1.0)


@inlined
def diverges(iteration: int, size: float, before: float) -> bool:
    """Whether an increment is more than twice the one before it, after the first two."""
    return iteration > 2 and before > 0.0 and size > 2.0 * before


@inner
def relaxation(work: Record, part: float, first: bool) -> float:
    """The part of the increments that is taken after `part` of those before, unless they are the `first`: by what the
    forces' increments changed from the one to the other, Aitken's; and keep them."""
    x, z, (width, _) = work.real.x, work.pair.x, linear.widths(work.real)
    earlier, earlier_pair, along, square = work.earlier, work.earlier_pair, 0.0, 0.0
    for a in range(len(x)):
        for k in range(width, x.shape[1]):
            u, w = earlier[a, k], earlier_pair[a, k]
            change, turn = x[a, k] - u, z[a, k] - w
            along += u * change + w.real * turn.real + w.imag * turn.imag
            square += change * change + turn.real * turn.real + turn.imag * turn.imag
            earlier[a, k], earlier_pair[a, k] = x[a, k], z[a, k]
    if first or not square > 0.0:
        return 1.0
    return float(min(max(-part * along / square, LEAST_PART), LARGEST_PART))


@kernel
def step(reference: Reference, dt: float, unit: float, part: float, rough: bool, state: Record) -> tuple[int, int]:
    """Solve for the stages of a step of dt; theta, shift and F hold the first guess. `unit` = EJ/L^2 (N).

    `reference`: to `StepRecords`. `part` of the step's largest departure from steady rotation may be left, where that
    is more than TOLERANCE. `rough`: whether loads may strike or rub. Returns how it ended and the iterations. Records
    of many arrays go only to where they are needed: each one passed on costs some ns in every iteration.
    """
    chain, loads, driven, scheme = reference.chain, reference.loads, reference.driven, reference.scheme
    stages, touch, work = reference.stages, reference.touch, reference.work
    stale, relaxed, part_taken = True, False, 1.0
    before, contact, fresh, length = 0.0, space.in_contact(touch), True, chain.h * len(chain.mass)
    residuals, transformed, tangents, real, pair = work.residuals, work.transformed, work.tangents, work.real, work.pair
    space.begin_step(state, scheme.nodes, dt, stages)
    for iteration in range(1, LARGEST_ITERATIONS + 1):
        if not space.move(chain, state, stages, scheme.nodes, scheme.inverse, dt) < LARGEST_TURN:
            return STALLED, iteration
        if contact:
            space.press_stages(chain, stages, driven, touch, work.coupling, fresh)
        space.evaluate(chain, loads, driven, stages, residuals)
        missed = space.missed_by_bodies(driven, stages, residuals, ROUNDING * length / (dt * dt))
        if stale:
            if not factor_both(chain, loads, driven, scheme, dt, stages, tangents, real, pair):
                return SINGULAR, iteration
        transform_residuals(driven, scheme, stages, tangents, residuals, transformed)
        fraction, gamma, lam = 1.0, scheme.gamma / dt, scheme.pair / dt
        if contact:
            fraction = linear.solve_with_contact(
                chain, driven, tangents, scheme.transform, gamma, lam, transformed, real, pair, touch, work.coupling,
                stale, fresh,
            )  # fmt: skip
        else:
            linear.solve_stages(chain, driven, tangents, gamma, lam, transformed, real, pair)
            slow = stale and iteration > 1
            if slow:
                fraction = part_taken = relaxation(work, part_taken, not relaxed)
            relaxed = slow
        turned, forced, shifted = linear.update(chain, scheme.transform, unit, fraction, stages, tangents, real, pair)
        if not max(turned, forced) < LARGEST_INCREMENT:
            return STALLED, iteration
        share = part * ROUGH if contact or rough else part
        enough = max(TOLERANCE, share * largest_departure(stages.theta[STAGES - 1]))
        # what presses does so by as much whatever the step: what counts is the forces' own relative error
        size = max(turned / enough, forced / (max(enough, share) if contact or rough else enough))
        size = max(size, shifted / max(TOLERANCE * length, share * shift_departure(stages.shift, state.base, dt)))
        size = max(size, missed / OF_BODY)
        if is_enough(size, before):
            space.move(chain, state, stages, scheme.nodes, scheme.inverse, dt)
            if contact:
                space.press_stages(chain, stages, driven, touch, work.coupling, False)
            space.join_stages(chain, stages)
            return CONVERGED, iteration
        if diverges(iteration, size, before) and not contact and (stale or not rough):
            return STALLED, iteration
        stale = rough and before > 0.0 and size > STALE * before
        fresh = fraction < 1.0 or not size < SERVES * before
        before = size if fraction == 1.0 or not contact else 0.0
    return STALLED, LARGEST_ITERATIONS


@inner
def shift_departure(shift: Array, base: Array, dt: float) -> float:
    """The largest component (m) of the start's departure from steady motion in a step; `shift` (3, ...) at the stages,
    `base` (3, ...) its place, velocity and acceleration before."""
    largest, each = 0.0, shift.size // STAGES
    moved, velocity = shift.reshape(STAGES, each), base.reshape(3, each)
    for k in range(each):
        largest = max(largest, abs(moved[STAGES - 1, k] - dt * velocity[1, k]))
    return largest


@inner
def largest_departure(theta: Array) -> float:
    """The largest component of a segment's departure from steady rotation (rad); `theta` (N + 2, ...) with the ends'
    frames, which do not count."""
    largest, each = 0.0, theta.size // len(theta)
    components = theta.reshape(theta.size)
    for m in range(each, theta.size - each):
        largest = max(largest, abs(components[m]))
    return largest


@kernel
def estimate_error(reference: Reference, dt: float, state: Record, centres: Array) -> tuple[float, float, float, float]:
    """The embedded estimate of the step's error, and the motion: rotation (rad) error, motion; position (m) likewise.

    `centres` (3, N, ...): position, velocity and acceleration of the centres at the start of the step. The estimate of
    order 3, g = dt/gamma y'(t) + sum of e_i (Y_i - y), is smoothed by the real system, M mu^2 + C mu + K, as it was
    factored.
    """
    chain, driven, scheme, stages = reference.chain, reference.driven, reference.scheme, reference.stages
    work = reference.work
    factors, mu = work.real, scheme.gamma / dt
    turned = _load_rotation(chain, state, stages, scheme.error, mu, dt, factors)
    moved = _delay(centres, stages.r, stages.V, scheme.error, mu, work.velocities)
    space.resist(chain, driven, work.tangents, mu, work.velocities, factors.load, factors.ends)
    linear.complete(chain, driven, work.tangents, mu, factors)
    linear.solve(factors)
    turn_error, move_error, (turns, moves) = 0.0, 0.0, linear.widths(factors)
    for a in range(1, len(factors.x) - 1):
        for k in range(turns):
            turn_error = max(turn_error, abs(factors.x[a, k]))
    for j in range(len(factors.moved)):
        for k in range(moves):
            move_error = max(move_error, abs(factors.moved[j, k]))
    return turn_error, turned, move_error, moved


@inner
def _load_rotation(chain: Record, state: Record, stages: Record, weights: Array, mu: float, dt: float,
                   factors: Record) -> float:  # fmt: skip
    """Write the rotation's right-hand side into x; return the largest rotation (rad) of a segment in the step."""
    x, count, (width, _), turned = factors.x, state.alpha.size, linear.widths(factors), 0.0
    theta, theta_t = stages.theta.reshape(STAGES, count), stages.theta_t.reshape(STAGES, count)
    omega, alpha = state.omega.reshape(count), state.alpha.reshape(count)
    inertia = chain.inertia.reshape(count - 2 * width)
    x[:] = 0.0
    for a in range(1, len(x) - 1):
        for k in range(width):
            m = a * width + k
            place, rate = 0.0, alpha[m] / mu
            for i in range(STAGES):
                place += weights[i] * theta[i, m]
                rate += weights[i] * theta_t[i, m]
            x[a, k] = chain.h * inertia[m - width] * mu * (mu * place + rate)
            turned = max(turned, abs(theta[2, m] + dt * omega[m]))
    return turned


@inner
def _delay(before: Array, r: Array, V: Array, weights: Array, mu: float, velocities: Array) -> float:
    """Write mu g of the centres' places and velocities, as velocities; return the largest displacement (m)."""
    count, moved = velocities.size, 0.0
    start, out = before.reshape(STAGES, count), velocities.reshape(count)
    places, speeds = r.reshape(STAGES, count), V.reshape(STAGES, count)
    for m in range(count):
        place, rate = start[1, m] / mu, start[2, m] / mu
        for i in range(STAGES):
            place += weights[i] * (places[i, m] - start[0, m])
            rate += weights[i] * (speeds[i, m] - start[1, m])
        out[m] = mu * place + rate
        gone = places[2, m] - start[0, m]
        moved = max(moved, abs(gone.real), abs(gone.imag))
    return moved
