"""The joints: from the relative rotation of two neighbours to moments and their tangents.

The rotation vector Theta of R_i^t R_i+1 gives kappa = Theta / span and q = K (kappa - kappa0). A small rotation psi of
the right neighbour changes Theta by B psi, one of the left neighbour by -B^t psi, with

    B = I + [Theta]/2 + b [Theta]^2,   b = (1 - (x/2) cot(x/2)) / x^2,   x = |Theta|,

so the elastic energy turns the left neighbour by B q and the right one by -B^t q.
"""

from __future__ import annotations

from typing import Any, no_type_check

import numpy as np

from solver.arrays import Array
from solver.kernels import vectors
from solver.kernels.kernel import inlined, inner, kernel
from solver.kernels.lanes import abreast, series
from solver.kernels.rotation import angle_by_sine, cross, dot, product
from solver.kernels.scratch import scratch
from solver.kernels.vectors import add_vector, minus, plus, scale, times, vector, vector_product
from solver.methods.space.segments.chain import Chain
from solver.physics.elasticity import is_linear, moment_beyond, moment_of, tangent

SMALL = 0.25
"""Square of the angle (rad) of a joint below which the series of b is exact to rounding."""


@inlined
def share(j: int, last: int) -> float:
    """Part of what is at node j that one of the segments beside it takes."""
    return 1.0 if j == 0 or j == last else 0.5


@inlined
def _series(square: float) -> float:
    """b by its series."""
    return 1 / 12 + square * (1 / 720 + square * (1 / 30240 + square * (1 / 1209600 + square * (1 / 47900160))))


@inlined
def coefficient(square: float) -> tuple[float, float]:
    """b and its derivative by x^2."""
    if square < SMALL:
        return _series(square), 1 / 720 + square * (1 / 15120 + square * (1 / 403200 + square * (1 / 11975040)))
    half = 0.5 * np.sqrt(square)
    cot = np.cos(half) / np.sin(half)
    b = (1.0 - half * cot) / square
    slope = (0.125 * (1.0 + cot * cot) - 0.125 * cot / half - b) / square
    return b, slope


@inlined
def _beyond_series(square: float) -> bool:
    """Whether the series of b is not exact."""
    return square >= SMALL


@kernel
def _any_series(square: float) -> float:
    """b of any joint but a straight one."""
    b, _ = coefficient(square)
    return b


series(_series, _beyond_series, _any_series)


@abreast("left: 4, right: 4, K: 3x3, kappa0: 3, span: 1 -> bend: 3, moment: 3, on_left: 3, on_right: 3")
@no_type_check
def _bend(left, right, K, kappa0, span):
    """Theta, q, B q and B^t q of a joint between two segments' orientations."""
    cosine, x, y, z = product(left[0], -left[1], -left[2], -left[3], *right)
    sine_square = x * x + y * y + z * z
    scale = angle_by_sine(sine_square, cosine)
    theta = scale * x, scale * y, scale * z
    square = dot(*theta, *theta)
    b = _series(square)
    strain = theta / span - kappa0
    q = moment_of(*K, *strain)
    c = cross(*theta, *q)
    d = cross(*theta, *c)
    e = q + b * d
    return theta, q, e + 0.5 * c, e - 0.5 * c


@kernel
def bend_joints(chain: Chain, quaternion: Array, bend: Array, moment: Array, left: Array, right: Array) -> None:
    """Write Theta, q, B q and B^t q of all joints (N + 1, 3 each) for orientations `quaternion` (N + 2, 4)."""
    elastic = chain.elastic
    _bend(quaternion[:-1], quaternion[1:], elastic.K, elastic.kappa0, chain.span, bend, moment, left, right)
    if not is_linear(elastic):
        for a in range(len(bend)):
            strain = minus(times(1.0 / chain.span[a], vector(bend, a)), vector(elastic.kappa0, a))
            add_moment(moment_beyond(elastic, a, strain), a, bend, moment, left, right)


@inner
def add_moment(q: Any, a: int, bend: Array, moment: Array, left: Array, right: Array) -> None:
    """Add q to the moment of joint a, and B q and B^t q to what it does to its neighbours."""
    on_left, on_right = on_neighbours(vector(bend, a), q)
    add_vector(1.0, q, moment[a])
    add_vector(1.0, on_left, left[a])
    add_vector(1.0, on_right, right[a])


@inner
def on_neighbours(theta: Any, q: Any) -> Any:
    """B q and B^t q."""
    b, _ = coefficient(vectors.dot(theta, theta))
    c = vector_product(theta, q)
    even = plus(q, times(b, vector_product(theta, c)))
    return plus(even, times(0.5, c)), plus(even, times(-0.5, c))


@kernel
def largest_turn(before: Array, after: Array) -> float:
    """The largest rotation (rad) of joints with the rotation vectors (n, 3) before and after a step.

    A rotation vector is shorter than pi. One that was to become longer points the other way instead: it has leapt.
    """
    largest = 0.0
    for i in range(len(after)):
        square, leap = 0.0, 0.0
        for k in range(3):
            square += after[i, k] ** 2
            leap += (after[i, k] - before[i, k]) ** 2
        angle = np.sqrt(square)
        largest = max(largest, 2.0 * np.pi - angle if leap > np.pi**2 else angle)
    return largest


@inner
def directions_on(theta: Any) -> Any:
    """B and B^t."""
    x, x_t = on_neighbours(theta, (1.0, 0.0, 0.0))
    y, y_t = on_neighbours(theta, (0.0, 1.0, 0.0))
    z, z_t = on_neighbours(theta, (0.0, 0.0, 1.0))
    return (x_t, y_t, z_t), (x, y, z)  # the columns of B are the rows of B^t


@inner
def joint_tangents(chain: Chain, bend: Array, moment: Array, ahead: Array, back: Array) -> None:
    """Write B and the tangents of B q and B^t q by Theta.

    `ahead` (N + 1, 2, 3, 3): d(B q) by a rotation of the left and of the right neighbour; `back` likewise d(B^t q).
    """
    B, G, h = scratch((3, 3)), scratch((3, 3)), scratch(3)
    for i in range(len(bend)):
        x, y, z = bend[i, 0], bend[i, 1], bend[i, 2]
        square = x * x + y * y + z * z
        b, slope = coefficient(square)
        theta, q, per = bend[i], moment[i], 1.0 / chain.span[i]
        spring = scale(per, tangent(chain.elastic, i, times(per, vector(bend, i))))
        q0, q1, q2 = q[0], q[1], q[2]
        c0, c1, c2 = y * q2 - z * q1, z * q0 - x * q2, x * q1 - y * q0
        d = (y * c2 - z * c1, z * c0 - x * c2, x * c1 - y * c0)
        along = x * q0 + y * q1 + z * q2
        cross = ((0.0, -z, y), (z, 0.0, -x), (-y, x, 0.0))
        turned = ((0.0, -q2, q1), (q2, 0.0, -q0), (-q1, q0, 0.0))
        for m in range(3):
            for n in range(3):
                B[m, n] = 0.5 * cross[m][n] + b * theta[m] * theta[n] + ((1.0 - b * square) if m == n else 0.0)
                # d(Theta (Theta.q) - Theta^2 q) = dTheta (Theta.q) + Theta (q.dTheta) - 2 q (Theta.dTheta)
                G[m, n] = b * (theta[m] * q[n] - 2.0 * q[m] * theta[n]) + 2.0 * slope * d[m] * theta[n]
                if m == n:
                    G[m, n] += b * along
        for side in range(2):
            target = ahead if side == 0 else back
            sign = 1.0 if side == 0 else -1.0
            for m in range(3):
                for n in range(3):
                    h[n] = G[m, n] - 0.5 * sign * turned[m][n]
                    for k in range(3):
                        h[n] += (B[m, k] if side == 0 else B[k, m]) * spring[k][n]
                for n in range(3):
                    target[i, 0, m, n] = -(h[0] * B[n, 0] + h[1] * B[n, 1] + h[2] * B[n, 2])
                    target[i, 1, m, n] = h[0] * B[0, n] + h[1] * B[1, n] + h[2] * B[2, n]


@kernel
def total_bending(bend: Array) -> float:
    """int |kappa_bending| ds (rad) of joints' rotation vectors (n, 3)."""
    total = 0.0
    for j in range(len(bend)):
        total += np.sqrt(bend[j, 0] * bend[j, 0] + bend[j, 1] * bend[j, 1])
    return total
