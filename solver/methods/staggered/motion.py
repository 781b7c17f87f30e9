"""The motion of the chain at a stage: from rotation vectors to velocities, and from the start along the segments.

In a step that begins with the rotation R_n and the angular velocity omega_n,

    R(t_n + tau) = R_n exp([theta]) exp([omega_n tau]):

theta, whose polynomial is collocated, is what departs from steady rotation, so it is small and begins with
theta = theta_t = 0. (With steady rotation inside theta, Newton's tangents hold only up to its angle.) With S =
exp([omega_n tau]), J = I - a [theta] + b [theta]^2, a = (1 - cos x)/x^2, b = (x - sin x)/x^3, x = |theta|:

    omega = omega_n + S^t J theta_t,   alpha = S^t (J theta_tt + J_t theta_t) - omega_n x (omega - omega_n).

Positions follow from the tangents: each segment begins where the last one ends.
"""

from __future__ import annotations

import numpy as np

from solver.kernel import inlined, kernel
from solver.methods.staggered.chain import STAGES, Stages, State
from solver.rod import Array
from solver.rotation import matrix_of, multiply, relative_rotation, turn

LARGEST_TURN = 2.0
"""Rotation (rad) in one step beyond which the series of a and b are not exact to rounding."""


@inlined
def _series(square: float) -> tuple[float, float, float, float]:
    """a, b and their derivatives by x^2, exact to rounding: seven terms up to 0.3 rad, eleven up to LARGEST_TURN."""
    return _sum_series(square, 7) if square < 0.1 else _sum_series(square, 11)


@inlined
def _sum_series(square: float, terms: int) -> tuple[float, float, float, float]:
    """`terms` terms of sum over k of (-x^2)^k / (2 k + 2)! and / (2 k + 3)!, and of their derivatives, by Horner."""
    a, b, da, db = 0.0, 0.0, 0.0, 0.0
    for k in range(terms - 1, -1, -1):
        even, odd = 1.0 / ((2 * k + 3.0) * (2 * k + 4.0)), 1.0 / ((2 * k + 4.0) * (2 * k + 5.0))
        da, db = -even * (a + square * da), -odd * (b + square * db)
        a, b = 1.0 - even * (a * square), 1.0 - odd * (b * square)
    return 0.5 * a, (1 / 6) * b, 0.5 * da, (1 / 6) * db


@kernel
def spin_steadily(state: State, nodes: Array, dt: float, stages: Stages) -> None:
    """Write R_n, and exp([omega_n tau]) as quaternions and matrices at the stages, tau = nodes[i] dt."""
    unturned, angle = np.array([1.0, 0.0, 0.0, 0.0]), np.empty(3)
    for j in range(len(state.omega)):
        matrix_of(state.quaternion[j], stages.start[j])
    for i in range(STAGES):
        for j in range(len(state.omega)):
            for k in range(3):
                angle[k] = state.omega[j, k] * nodes[i] * dt
            turn(unturned, angle, stages.steady[i, j])
            matrix_of(stages.steady[i, j], stages.S[i, j])


@kernel
def turn_segments(state: State, stages: Stages, i: int) -> float:
    """Write quaternion, R, omega and alpha of stage i; return the largest |theta|^2."""
    largest = 0.0
    turned = np.empty(4)
    for j in range(stages.theta.shape[1]):
        theta, v, w = stages.theta[i, j], stages.theta_t[i, j], stages.theta_tt[i, j]
        turn(state.quaternion[j], theta, turned)
        multiply(turned, stages.steady[i, j], stages.quaternion[i, j])
        matrix_of(stages.quaternion[i, j], stages.R[i, j])
        x, y, z = theta[0], theta[1], theta[2]
        square = x * x + y * y + z * z
        largest = max(largest, square)
        a, b, da, db = _series(square)
        growth = 2.0 * (x * v[0] + y * v[1] + z * v[2])
        p0, p1, p2 = y * v[2] - z * v[1], z * v[0] - x * v[2], x * v[1] - y * v[0]
        s0, s1, s2 = y * w[2] - z * w[1], z * w[0] - x * w[2], x * w[1] - y * w[0]
        # theta x (theta x theta_t) and theta_t x (theta x theta_t) are m and n, theta x (theta x theta_tt) is u
        m0, m1, m2 = y * p2 - z * p1, z * p0 - x * p2, x * p1 - y * p0
        n0, n1, n2 = v[1] * p2 - v[2] * p1, v[2] * p0 - v[0] * p2, v[0] * p1 - v[1] * p0
        u0, u1, u2 = y * s2 - z * s1, z * s0 - x * s2, x * s1 - y * s0
        da *= growth
        db *= growth
        w0, w1, w2 = v[0] - a * p0 + b * m0, v[1] - a * p1 + b * m1, v[2] - a * p2 + b * m2
        g0 = w[0] - a * s0 + b * u0 - da * p0 + db * m0 + b * n0
        g1 = w[1] - a * s1 + b * u1 - da * p1 + db * m1 + b * n1
        g2 = w[2] - a * s2 + b * u2 - da * p2 + db * m2 + b * n2
        S, steady, omega, alpha = stages.S[i, j], state.omega[j], stages.omega[i, j], stages.alpha[i, j]
        for k in range(3):
            omega[k] = S[0, k] * w0 + S[1, k] * w1 + S[2, k] * w2
            alpha[k] = S[0, k] * g0 + S[1, k] * g1 + S[2, k] * g2
        alpha[0] -= steady[1] * omega[2] - steady[2] * omega[1]
        alpha[1] -= steady[2] * omega[0] - steady[0] * omega[2]
        alpha[2] -= steady[0] * omega[1] - steady[1] * omega[0]
        for k in range(3):
            omega[k] += steady[k]
    return largest


@kernel
def follow_segments(R: Array, omega: Array, alpha: Array, base: Array, h: float, r: Array, V: Array, A: Array) -> None:
    """Write position, velocity and acceleration (N, 3) of the segments' centres, from those of the start, `base`."""
    half = 0.5 * h
    r0, r1, r2 = base[0, 0], base[0, 1], base[0, 2]
    v0, v1, v2 = base[1, 0], base[1, 1], base[1, 2]
    a0, a1, a2 = base[2, 0], base[2, 1], base[2, 2]
    for j in range(len(r)):
        Q, w, g = R[j + 1], omega[j + 1], alpha[j + 1]
        # the rates of the tangent: R (omega x a3), R (alpha x a3 + omega x (omega x a3))
        c0, c1 = w[1], -w[0]
        d0, d1, d2 = g[1] + w[0] * w[2], -g[0] + w[1] * w[2], -(w[0] * w[0] + w[1] * w[1])
        x, y, z = half * Q[0, 2], half * Q[1, 2], half * Q[2, 2]
        x_t, y_t, z_t = (half * (Q[0, 0] * c0 + Q[0, 1] * c1), half * (Q[1, 0] * c0 + Q[1, 1] * c1),
                         half * (Q[2, 0] * c0 + Q[2, 1] * c1))  # fmt: skip
        x_tt, y_tt, z_tt = (half * (Q[0, 0] * d0 + Q[0, 1] * d1 + Q[0, 2] * d2),
                            half * (Q[1, 0] * d0 + Q[1, 1] * d1 + Q[1, 2] * d2),
                            half * (Q[2, 0] * d0 + Q[2, 1] * d1 + Q[2, 2] * d2))  # fmt: skip
        r[j, 0], r[j, 1], r[j, 2] = r0 + x, r1 + y, r2 + z
        V[j, 0], V[j, 1], V[j, 2] = v0 + x_t, v1 + y_t, v2 + z_t
        A[j, 0], A[j, 1], A[j, 2] = a0 + x_tt, a1 + y_tt, a2 + z_tt
        r0, r1, r2 = r0 + 2.0 * x, r1 + 2.0 * y, r2 + 2.0 * z
        v0, v1, v2 = v0 + 2.0 * x_t, v1 + 2.0 * y_t, v2 + 2.0 * z_t
        a0, a1, a2 = a0 + 2.0 * x_tt, a1 + 2.0 * y_tt, a2 + 2.0 * z_tt


@kernel
def move(state: State, stages: Stages, inverse: Array, dt: float, h: float) -> float:
    """Write all that follows from theta and shift at all stages; return the largest |theta|^2.

    `inverse` is A^-1: theta_t = A^-1 theta / dt, theta_tt = A^-1 theta_t / dt.
    """
    differentiate(inverse, dt, stages.theta, stages.theta_t)
    differentiate(inverse, dt, stages.theta_t, stages.theta_tt)
    for i in range(STAGES):
        for k in range(3):
            stages.base[i, 0, k] = state.base[0, k] + stages.shift[i, k]
            stages.base[i, 1, k] = (inverse[i, 0] * stages.shift[0, k] + inverse[i, 1] * stages.shift[1, k]
                                    + inverse[i, 2] * stages.shift[2, k]) / dt  # fmt: skip
    largest = 0.0
    for i in range(STAGES):
        total = inverse[i, 0] + inverse[i, 1] + inverse[i, 2]
        for k in range(3):
            stages.base[i, 2, k] = (inverse[i, 0] * stages.base[0, 1, k] + inverse[i, 1] * stages.base[1, 1, k]
                                    + inverse[i, 2] * stages.base[2, 1, k] - total * state.base[1, k]) / dt  # fmt: skip
        largest = max(largest, turn_segments(state, stages, i))
        follow_segments(stages.R[i], stages.omega[i], stages.alpha[i], stages.base[i], h,
                        stages.r[i], stages.V[i], stages.A[i])  # fmt: skip
    return float(np.sqrt(largest))


@kernel
def differentiate(inverse: Array, dt: float, values: Array, rates: Array) -> None:
    """rates = A^-1 values / dt, stages first."""
    count = values.size // STAGES
    source, target = values.reshape(STAGES, count), rates.reshape(STAGES, count)
    for i in range(STAGES):
        a, b, c = inverse[i, 0] / dt, inverse[i, 1] / dt, inverse[i, 2] / dt
        first, second, third, out = source[0], source[1], source[2], target[i]
        for m in range(count):
            out[m] = a * first[m] + b * second[m] + c * third[m]


@kernel
def extrapolate(before: State, theta: Array, dt: float, state: State, nodes: Array, weights: Array, ratio: float,
                stages: Stages) -> None:  # fmt: skip
    """Guess theta of a step of ratio dt: the motion of the last step, `theta` from the state `before`, goes on."""
    ahead, turned, target, departed = np.empty(3), np.empty(4), np.empty(4), np.empty(3)
    for i in range(STAGES):
        for j in range(len(state.omega)):
            for k in range(3):
                ahead[k] = weights[i, 0] * theta[0, j, k] + weights[i, 1] * theta[1, j, k]
                ahead[k] += weights[i, 2] * theta[2, j, k]
            turn(before.quaternion[j], ahead, turned)
            for k in range(3):
                ahead[k] = before.omega[j, k] * dt * (1.0 + ratio * nodes[i])
            turn(turned, ahead, target)
            for k in range(3):
                ahead[k] = -state.omega[j, k] * dt * ratio * nodes[i]
            turn(target, ahead, turned)
            relative_rotation(state.quaternion[j], turned, departed)
            for k in range(3):
                stages.theta[i, j, k] = departed[k]
