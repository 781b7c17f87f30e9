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

from solver.arrays import Array
from solver.kernels.kernel import inlined, kernel
from solver.kernels.lanes import LANES, gather, scatter
from solver.kernels.rotation import (
    angle_by_sine,
    any_angle_by_sine,
    cosines_and_sincs,
    cross,
    entries,
    is_small,
    product,
    unit,
)
from solver.kernels.scratch import scratch
from solver.methods.space.segments.chain import STAGES, Stages, State

LARGEST_TURN = 2.0
"""Rotation (rad) in one step beyond which the series are not exact to rounding."""


@inlined
def _series(square: float) -> tuple[float, float, float, float]:
    """a, b and their derivatives by x^2: sums over k of (-x^2)^k / (2 k + 2)! and / (2 k + 3)!, by Horner."""
    a, b, da, db = 0.0, 0.0, 0.0, 0.0
    for k in range(10, -1, -1):
        even, odd = 1.0 / ((2 * k + 3.0) * (2 * k + 4.0)), 1.0 / ((2 * k + 4.0) * (2 * k + 5.0))
        da, db = -even * (a + square * da), -odd * (b + square * db)
        a, b = 1.0 - even * (a * square), 1.0 - odd * (b * square)
    return 0.5 * a, (1 / 6) * b, 0.5 * da, (1 / 6) * db


@kernel
def spin_steadily(state: State, nodes: Array, dt: float, stages: Stages) -> None:
    """Write R_n, and exp([omega_n tau]) as quaternions and matrices at the stages, tau = nodes[i] dt.

    Eight abreast (see `lanes`), in rows from 0: quaternion; 4: omega_n; 7: omega_n tau, cos, sinc, square; 10: matrix.
    """
    n, rows = len(state.omega), scratch((19, LANES))
    for first in range(0, n, LANES):
        gather(state.quaternion, 4, first, rows, 0)
        gather(state.omega, 3, first, rows, 4)
        for m in range(LANES):
            (rows[10, m], rows[11, m], rows[12, m], rows[13, m], rows[14, m], rows[15, m], rows[16, m], rows[17, m],
             rows[18, m]) = entries(rows[0, m], rows[1, m], rows[2, m], rows[3, m])  # fmt: skip
        scatter(rows, 10, 9, first, stages.start.reshape(n, 9))
        for i in range(STAGES):
            for m in range(LANES):
                rows[7, m], rows[8, m], rows[9, m] = (rows[4, m] * nodes[i] * dt, rows[5, m] * nodes[i] * dt,
                                                      rows[6, m] * nodes[i] * dt)  # fmt: skip
            cosines_and_sincs(rows, 7)
            for m in range(LANES):
                sinc = rows[11, m]
                a, b, c, d = unit(rows[10, m], sinc * rows[7, m], sinc * rows[8, m], sinc * rows[9, m])
                rows[0, m], rows[1, m], rows[2, m], rows[3, m] = a, b, c, d
                (rows[10, m], rows[11, m], rows[12, m], rows[13, m], rows[14, m], rows[15, m], rows[16, m],
                 rows[17, m], rows[18, m]) = entries(a, b, c, d)  # fmt: skip
            scatter(rows, 0, 4, first, stages.steady[i])
            scatter(rows, 10, 9, first, stages.S[i].reshape(n, 9))


@kernel
def turn_segments(state: State, stages: Stages, i: int) -> float:
    """Write quaternion, R, omega and alpha of stage i; return the largest |theta|^2.

    Eight abreast (see `lanes`), in rows from 0: theta, cos, sinc, |theta|^2; 6: theta_t; 9: theta_tt; 12: omega_n;
    15: the quaternion of R_n; 19, 23: the steady rotation's, and S; and what comes of them from 32 on.
    """
    n, largest, rows = stages.theta.shape[1], 0.0, scratch((51, LANES))
    for first in range(0, n, LANES):
        gather(stages.theta[i], 3, first, rows, 0)
        gather(stages.theta_t[i], 3, first, rows, 6)
        gather(stages.theta_tt[i], 3, first, rows, 9)
        gather(state.omega, 3, first, rows, 12)
        gather(state.quaternion, 4, first, rows, 15)
        gather(stages.steady[i], 4, first, rows, 19)
        gather(stages.S[i].reshape(n, 9), 9, first, rows, 23)
        cosines_and_sincs(rows, 0)
        for m in range(LANES):
            x, y, z, cosine, sinc, square = rows[0, m], rows[1, m], rows[2, m], rows[3, m], rows[4, m], rows[5, m]
            p, q, r, s = product(rows[15, m], rows[16, m], rows[17, m], rows[18, m],
                                 cosine, sinc * x, sinc * y, sinc * z)  # fmt: skip
            p, q, r, s = unit(p, q, r, s)
            p, q, r, s = product(p, q, r, s, rows[19, m], rows[20, m], rows[21, m], rows[22, m])
            rows[32, m], rows[33, m], rows[34, m], rows[35, m] = p, q, r, s
            (rows[36, m], rows[37, m], rows[38, m], rows[39, m], rows[40, m], rows[41, m], rows[42, m], rows[43, m],
             rows[44, m]) = entries(p, q, r, s)  # fmt: skip
            a, b, da, db = _series(square)
            v0, v1, v2 = rows[6, m], rows[7, m], rows[8, m]
            w0, w1, w2 = rows[9, m], rows[10, m], rows[11, m]
            growth = 2.0 * (x * v0 + y * v1 + z * v2)
            da, db = growth * da, growth * db
            p0, p1, p2 = cross(x, y, z, v0, v1, v2)
            s0, s1, s2 = cross(x, y, z, w0, w1, w2)
            m0, m1, m2 = cross(x, y, z, p0, p1, p2)
            n0, n1, n2 = cross(v0, v1, v2, p0, p1, p2)
            u0, u1, u2 = cross(x, y, z, s0, s1, s2)
            f0, f1, f2 = v0 - a * p0 + b * m0, v1 - a * p1 + b * m1, v2 - a * p2 + b * m2
            g0 = w0 - a * s0 + b * u0 - da * p0 + db * m0 + b * n0
            g1 = w1 - a * s1 + b * u1 - da * p1 + db * m1 + b * n1
            g2 = w2 - a * s2 + b * u2 - da * p2 + db * m2 + b * n2
            o0, o1, o2 = rows[12, m], rows[13, m], rows[14, m]
            d0 = rows[23, m] * f0 + rows[26, m] * f1 + rows[29, m] * f2
            d1 = rows[24, m] * f0 + rows[27, m] * f1 + rows[30, m] * f2
            d2 = rows[25, m] * f0 + rows[28, m] * f1 + rows[31, m] * f2
            c0, c1, c2 = cross(o0, o1, o2, d0, d1, d2)
            rows[45, m], rows[46, m], rows[47, m] = d0 + o0, d1 + o1, d2 + o2
            rows[48, m] = rows[23, m] * g0 + rows[26, m] * g1 + rows[29, m] * g2 - c0
            rows[49, m] = rows[24, m] * g0 + rows[27, m] * g1 + rows[30, m] * g2 - c1
            rows[50, m] = rows[25, m] * g0 + rows[28, m] * g1 + rows[31, m] * g2 - c2
        for m in range(LANES):
            largest = max(largest, rows[5, m])
        scatter(rows, 32, 4, first, stages.quaternion[i])
        scatter(rows, 36, 9, first, stages.R[i].reshape(n, 9))
        scatter(rows, 45, 3, first, stages.omega[i])
        scatter(rows, 48, 3, first, stages.alpha[i])
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
                ahead: Array) -> None:  # fmt: skip
    """Guess theta of a step of ratio dt into `ahead`: the last step's motion, `theta` from the state `before`, goes on.

    Eight abreast (see `lanes`), in rows from 0: quaternion and omega before; 7: those of `state`; 15: theta ahead, then
    departed; 24, 30: the steady rotations ahead, and back; 36: cos(a/2) of the departure, sin(a/2)^2, a / sin(a/2).
    """
    n, rows = len(state.omega), scratch((39, LANES))
    for first in range(0, n, LANES):
        gather(before.quaternion, 4, first, rows, 0)
        gather(before.omega, 3, first, rows, 4)
        gather(state.quaternion, 4, first, rows, 7)
        gather(state.omega, 3, first, rows, 11)
        for i in range(STAGES):
            gather(theta[0], 3, first, rows, 15)
            gather(theta[1], 3, first, rows, 18)
            gather(theta[2], 3, first, rows, 21)
            back, on = dt * ratio * nodes[i], dt * (1.0 + ratio * nodes[i])
            for m in range(LANES):
                for k in range(3):
                    x = weights[i, 0] * rows[15 + k, m] + weights[i, 1] * rows[18 + k, m]
                    rows[15 + k, m] = x + weights[i, 2] * rows[21 + k, m]
                    rows[24 + k, m] = on * rows[4 + k, m]
                    rows[30 + k, m] = -back * rows[11 + k, m]
            cosines_and_sincs(rows, 15)
            cosines_and_sincs(rows, 24)
            cosines_and_sincs(rows, 30)
            for m in range(LANES):
                a, b, c, d = rows[0, m], rows[1, m], rows[2, m], rows[3, m]
                for at in (15, 24, 30):
                    sinc = rows[at + 4, m]
                    x, y, z = sinc * rows[at, m], sinc * rows[at + 1, m], sinc * rows[at + 2, m]
                    a, b, c, d = product(a, b, c, d, rows[at + 3, m], x, y, z)
                    a, b, c, d = unit(a, b, c, d)
                rows[36, m], x, y, z = product(rows[7, m], -rows[8, m], -rows[9, m], -rows[10, m], a, b, c, d)
                rows[15, m], rows[16, m], rows[17, m], rows[37, m] = x, y, z, x * x + y * y + z * z
                rows[38, m] = angle_by_sine(rows[37, m], rows[36, m])
            for m in range(LANES):
                if not is_small(rows[37, m], rows[36, m]):
                    rows[38, m] = any_angle_by_sine(rows[37, m], rows[36, m])
            for m in range(LANES):
                for k in range(3):
                    rows[15 + k, m] *= rows[38, m]
            scatter(rows, 15, 3, first, ahead[i])
