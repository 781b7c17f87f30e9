"""The motion of the chain at a stage: from rotation vectors to velocities, and from the start along the segments.

In a step that begins with the rotation R_n and the angular velocity omega_n,

    R(t_n + tau) = R_n exp([theta]) exp([omega_n tau]):

theta, whose polynomial is collocated, is what departs from steady rotation, so it is small and begins with
theta = theta_t = 0. (With steady rotation inside theta, Newton's tangents hold only up to its angle.) With S =
exp([omega_n tau]), J = I - a [theta] + b [theta]^2, a = (1 - cos x)/x^2, b = (x - sin x)/x^3, x = |theta|:

    omega = omega_n + S^t J theta_t,   alpha = S^t (J theta_tt + J_t theta_t) - omega_n x (omega - omega_n).

Positions follow from the tangents: each segment begins where the last one ends, but for joints that open.
"""

from __future__ import annotations

from typing import NamedTuple, no_type_check

import numpy as np

from solver.arrays import Array
from solver.kernels.copying import copy
from solver.kernels.handed import Reference
from solver.kernels.kernel import inlined, inner, kernel
from solver.kernels.lanes import abreast
from solver.kernels.rotation import (
    angle_by_sine,
    cosine_and_sinc,
    cross,
    dot,
    entries,
    matrices_of,
    product,
    turned_back,
    unit,
)
from solver.kernels.vectors import matrix, plus, tangent_acceleration, tangent_rate, times, vector
from solver.methods.space.segments.chain import STAGES, Chain, Stages, State, rate_at
from solver.methods.space.segments.opening import open_joints
from solver.physics.elasticity import stretches

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


@abreast("omega: 3 -> quaternion: 4, R: 3x3")
@no_type_check
def _spin(omega, node, dt):
    """exp([omega_n tau]) of a segment, tau = node dt."""
    theta = omega * node * dt
    square = dot(*theta, *theta)
    cosine, sinc = cosine_and_sinc(square)
    steady = unit(cosine, *(sinc * theta))
    return steady, entries(*steady)


@kernel
def spin_steadily(state: State, nodes: Array, dt: float, stages: Stages) -> None:
    """Write R_n, and exp([omega_n tau]) as quaternions and matrices at the stages, tau = nodes[i] dt."""
    matrices_of(state.quaternion, stages.start)
    for i in range(STAGES):
        _spin(state.omega, nodes[i], dt, stages.steady[i], stages.S[i])


@abreast("theta: 3, theta_t: 3, theta_tt: 3, omega_n: 3, start: 4, steady: 4, S: 3x3"
         " -> quaternion: 4, R: 3x3, omega: 3, alpha: 3")  # fmt: skip
@no_type_check
def _turn(theta, theta_t, theta_tt, omega_n, start, steady, S):
    """Orientation, omega and alpha of a segment."""
    square = dot(*theta, *theta)
    cosine, sinc = cosine_and_sinc(square)
    turned = product(*start, cosine, *(sinc * theta))
    turned = unit(*turned)
    turned = product(*turned, *steady)
    a, b, da, db = _series(square)
    growth = 2.0 * dot(*theta, *theta_t)
    a_t, b_t = growth * da, growth * db
    # [theta] and [theta]^2 times the rates of theta, and [theta_t] [theta] theta_t
    p = cross(*theta, *theta_t)
    pp = cross(*theta, *p)
    tp = cross(*theta_t, *p)
    s = cross(*theta, *theta_tt)
    ss = cross(*theta, *s)
    f = theta_t - a * p + b * pp
    g = theta_tt - a * s + b * ss - a_t * p + b_t * pp + b * tp
    gained = turned_back(*S, *f)
    rate = turned_back(*S, *g)
    gyration = cross(*omega_n, *gained)
    return turned, entries(*turned), gained + omega_n, rate - gyration


@kernel
def follow_segments(R: Array, omega: Array, alpha: Array, base: Array, h: float, r: Array, V: Array, A: Array) -> None:
    """Write position, velocity and acceleration (N, 3) of the segments' centres, from those of the start, `base`."""
    half = 0.5 * h
    start, speed, growth = vector(base, 0), vector(base, 1), vector(base, 2)
    for j in range(len(r)):
        Q, w = matrix(R, j + 1), vector(omega, j + 1)
        x, x_t = times(half, (Q[0][2], Q[1][2], Q[2][2])), times(half, tangent_rate(Q, w))
        x_tt = times(half, tangent_acceleration(Q, w, vector(alpha, j + 1)))
        r[j, 0], r[j, 1], r[j, 2] = plus(start, x)
        V[j, 0], V[j, 1], V[j, 2] = plus(speed, x_t)
        A[j, 0], A[j, 1], A[j, 2] = plus(growth, x_tt)
        start, speed, growth = plus(start, times(2.0, x)), plus(speed, times(2.0, x_t)), plus(growth, times(2.0, x_tt))


@kernel
def move(chain: Chain, state: State, stages: Stages, nodes: Array, inverse: Array, dt: float) -> float:
    """Write all that follows from theta and shift at all stages; return the largest |theta|.

    `inverse` is A^-1: theta_t = A^-1 theta / dt, theta_tt = A^-1 theta_t / dt; likewise the rates of the ends' forces.
    """
    differentiate(inverse, dt, stages.theta, stages.theta_t)
    differentiate(inverse, dt, stages.theta_t, stages.theta_tt)
    base, F, largest, last = stages.base, stages.F, 0.0, len(chain.mass)
    for i in range(STAGES):
        for k in range(3):
            base[i, 0, k] = state.base[0, k] + stages.shift[i, k]
            base[i, 1, k] = rate_at(i, stages.shift[:, k], 0.0, inverse, dt)
    for i in range(STAGES):
        for k in range(3):
            base[i, 2, k] = rate_at(i, base[:, 1, k], state.base[1, k], inverse, dt)
            stages.F_t[i, 0, k] = rate_at(i, F[:, 0, k], state.F[0, k], inverse, dt)
            stages.F_t[i, 1, k] = rate_at(i, F[:, last, k], state.F[last, k], inverse, dt)
        _turn(stages.theta[i], stages.theta_t[i], stages.theta_tt[i], state.omega, state.quaternion, stages.steady[i],
              stages.S[i], stages.quaternion[i], stages.R[i], stages.omega[i], stages.alpha[i])  # fmt: skip
        for j in range(last + 2):
            x, y, z = vector(stages.theta[i], j)
            largest = max(largest, dot(x, y, z, x, y, z))
        follow_segments(stages.R[i], stages.omega[i], stages.alpha[i], base[i], chain.h,
                        stages.r[i], stages.V[i], stages.A[i])  # fmt: skip
    if stretches(chain.elastic):
        open_joints(chain, state, stages, inverse, dt)
    return float(np.sqrt(largest))


@inner
def become(state: State, stages: Stages) -> None:
    """Write the state at the last stage."""
    copy(stages.quaternion[STAGES - 1], state.quaternion)
    copy(stages.omega[STAGES - 1], state.omega)
    copy(stages.alpha[STAGES - 1], state.alpha)
    copy(stages.base[STAGES - 1], state.base)
    copy(stages.F[STAGES - 1], state.F)
    copy(stages.opening[STAGES - 1], state.opening)


class Interpolation(NamedTuple):
    """What the state `then`, within a step, is made from, of all orientations (N + 2, ...): see `Stages`."""

    then: State
    theta: Array
    theta_t: Array
    theta_tt: Array
    steady: Array
    S: Array

    @classmethod
    def into(cls, then: State) -> Interpolation:
        """Zeros for such a state."""
        return cls(then, *(np.zeros((len(then.omega), *shape)) for shape in ((3,), (3,), (3,), (4,), (3, 3))))


@kernel
def look_back(reference: Reference, within: Reference, before: State, part: float, dt: float, cubic: Array,
              parabola: Array, R: Array, centres: Array) -> None:  # fmt: skip
    """Write state, R (N + 2, 3, 3) and centres (3, N, 3) after a part of the step of dt that began with `before`.

    `within`: to an Interpolation. `cubic` and `parabola` (3,): see `tableau.within`. Accelerations are not known there,
    and 0.
    """
    chain, stages, then = reference.chain, reference.stages, within.then
    a, b, c = cubic[0], cubic[1], cubic[2]
    for i in range(len(then.omega)):
        for k in range(3):
            within.theta[i, k] = a * stages.theta[0, i, k] + b * stages.theta[1, i, k] + c * stages.theta[2, i, k]
            within.theta_t[i, k] = (a * stages.theta_t[0, i, k] + b * stages.theta_t[1, i, k]
                                     + c * stages.theta_t[2, i, k])  # fmt: skip
    _spin(before.omega, part, dt, within.steady, within.S)
    _turn(within.theta, within.theta_t, within.theta_tt, before.omega, before.quaternion, within.steady, within.S,
          then.quaternion, R, then.omega, then.alpha)  # fmt: skip
    then.alpha[:] = 0.0
    for k in range(3):
        speed = before.base[1, k]
        then.base[0, k] = (before.base[0, k] + a * stages.shift[0, k] + b * stages.shift[1, k]
                           + c * stages.shift[2, k])  # fmt: skip
        then.base[1, k] = (speed + a * (stages.base[0, 1, k] - speed) + b * (stages.base[1, 1, k] - speed)
                           + c * (stages.base[2, 1, k] - speed))  # fmt: skip
        for i in range(len(then.F)):
            then.F[i, k] = (parabola[0] * stages.F[0, i, k] + parabola[1] * stages.F[1, i, k]
                            + parabola[2] * stages.F[2, i, k])  # fmt: skip
    follow_segments(R, then.omega, then.alpha, then.base, chain.h, centres[0], centres[1], centres[2])


@inner
def differentiate(inverse: Array, dt: float, values: Array, rates: Array) -> None:
    """rates = A^-1 values / dt, stages first."""
    count = values.size // STAGES
    source, target = values.reshape(STAGES, count), rates.reshape(STAGES, count)
    for i in range(STAGES):
        a, b, c = inverse[i, 0] / dt, inverse[i, 1] / dt, inverse[i, 2] / dt
        first, second, third, out = source[0], source[1], source[2], target[i]
        for m in range(count):
            out[m] = a * first[m] + b * second[m] + c * third[m]


@abreast("start: 4, omega_before: 3, quaternion: 4, omega: 3, first: 3, second: 3, third: 3 -> ahead: 3")
@no_type_check
def _extrapolate(start, omega_before, quaternion, omega, first, second, third, u, v, w, on, back):
    """theta of a segment: the departure that goes on, between the steady rotations of the last step and of the next."""
    departed = u * first + v * second + w * third
    square = dot(*departed, *departed)
    cosine, sinc = cosine_and_sinc(square)
    spun = on * omega_before
    spun_square = dot(*spun, *spun)
    spun_cosine, spun_sinc = cosine_and_sinc(spun_square)
    unspun = -back * omega
    unspun_square = dot(*unspun, *unspun)
    unspun_cosine, unspun_sinc = cosine_and_sinc(unspun_square)
    turned = product(*start, cosine, *(sinc * departed))
    turned = product(*turned, spun_cosine, *(spun_sinc * spun))
    turned = product(*turned, unspun_cosine, *(unspun_sinc * unspun))
    turned = unit(*turned)
    half_cosine, x, y, z = product(quaternion[0], -quaternion[1], -quaternion[2], -quaternion[3], *turned)
    sine_square = x * x + y * y + z * z
    scale = angle_by_sine(sine_square, half_cosine)
    return x * scale, y * scale, z * scale


@kernel
def extrapolate(before: State, theta: Array, dt: float, state: State, nodes: Array, weights: Array, ratio: float,
                ahead: Array) -> None:  # fmt: skip
    """Write theta of a step of ratio dt, if the last step's motion, `theta` from the state `before`, goes on."""
    for i in range(STAGES):
        back, on = dt * ratio * nodes[i], dt * (1.0 + ratio * nodes[i])
        _extrapolate(before.quaternion, before.omega, state.quaternion, state.omega, theta[0], theta[1], theta[2],
                     weights[i, 0], weights[i, 1], weights[i, 2], on, back, ahead[i])  # fmt: skip
