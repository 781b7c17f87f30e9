"""The joints: from the relative rotation of two neighbours to moments and their tangents.

The rotation vector Theta of R_i^t R_i+1 gives kappa = Theta / span and q = K (kappa - kappa0). A small rotation psi of
the right neighbour changes Theta by B psi, one of the left neighbour by -B^t psi, with

    B = I + [Theta]/2 + b [Theta]^2,   b = (1 - (x/2) cot(x/2)) / x^2,   x = |Theta|,

so the elastic energy turns the left neighbour by B q and the right one by -B^t q.
"""

from __future__ import annotations

import numpy as np

from solver.arrays import Array
from solver.kernels.kernel import inlined, kernel
from solver.kernels.lanes import LANES, gather, scatter
from solver.kernels.rotation import angle_by_sine, any_angle_by_sine, cross, is_small, product
from solver.kernels.scratch import scratch
from solver.kernels.vectors import scale
from solver.methods.space.segments.chain import Chain
from solver.physics.elasticity import tangent

SMALL = 0.25
"""Square of the angle (rad) of a joint below which the series of b is exact to rounding."""


@inlined
def _series(square: float) -> float:
    """b by its series."""
    return 1 / 12 + square * (1 / 720 + square * (1 / 30240 + square * (1 / 1209600 + square * (1 / 47900160))))


@inlined
def _coefficient(square: float) -> tuple[float, float]:
    """b and its derivative by x^2."""
    if square < SMALL:
        return _series(square), 1 / 720 + square * (1 / 15120 + square * (1 / 403200 + square * (1 / 11975040)))
    half = 0.5 * np.sqrt(square)
    cot = np.cos(half) / np.sin(half)
    b = (1.0 - half * cot) / square
    slope = (0.125 * (1.0 + cot * cot) - 0.125 * cot / half - b) / square
    return b, slope


@kernel
def bend_joints(chain: Chain, quaternion: Array, bend: Array, moment: Array, left: Array, right: Array) -> None:
    """Write Theta, q, B q and B^t q of all joints (N + 1, 3 each) for orientations `quaternion` (N + 2, 4).

    Eight abreast (see `lanes`), in rows from 0: the two quaternions, then sin(a/2), cos(a/2), sin(a/2)^2, a / sin(a/2),
    then Theta, its square and b; 5: K; 14: kappa0; 17: span; 18: q; 21, 24: B q and B^t q.
    """
    rows, span = scratch((27, LANES)), chain.span.reshape(-1, 1)
    for first in range(0, len(bend), LANES):
        gather(quaternion[:-1], 4, first, rows, 0)
        gather(quaternion[1:], 4, first, rows, 4)
        for m in range(LANES):
            cosine, x, y, z = product(rows[0, m], -rows[1, m], -rows[2, m], -rows[3, m],
                                      rows[4, m], rows[5, m], rows[6, m], rows[7, m])  # fmt: skip
            square = x * x + y * y + z * z
            rows[0, m], rows[1, m], rows[2, m], rows[3, m], rows[4, m] = x, y, z, cosine, square
            rows[5, m] = angle_by_sine(square, cosine)
        for m in range(LANES):
            if not is_small(rows[4, m], rows[3, m]):
                rows[5, m] = any_angle_by_sine(rows[4, m], rows[3, m])
        for m in range(LANES):
            x, y, z = rows[5, m] * rows[0, m], rows[5, m] * rows[1, m], rows[5, m] * rows[2, m]
            square = x * x + y * y + z * z
            rows[0, m], rows[1, m], rows[2, m], rows[3, m], rows[4, m] = x, y, z, square, _series(square)
        for m in range(LANES):
            if rows[3, m] >= SMALL:
                rows[4, m], _ = _coefficient(rows[3, m])
        gather(chain.elastic.K.reshape(len(bend), 9), 9, first, rows, 5)
        gather(chain.elastic.kappa0, 3, first, rows, 14)
        gather(span, 1, first, rows, 17)
        for m in range(LANES):
            x, y, z, b, per = rows[0, m], rows[1, m], rows[2, m], rows[4, m], rows[17, m]
            u, v, w = x / per - rows[14, m], y / per - rows[15, m], z / per - rows[16, m]
            q0, q1, q2 = (rows[5, m] * u + rows[6, m] * v + rows[7, m] * w,
                          rows[8, m] * u + rows[9, m] * v + rows[10, m] * w,
                          rows[11, m] * u + rows[12, m] * v + rows[13, m] * w)  # fmt: skip
            c0, c1, c2 = cross(x, y, z, q0, q1, q2)
            d0, d1, d2 = cross(x, y, z, c0, c1, c2)
            e0, e1, e2 = q0 + b * d0, q1 + b * d1, q2 + b * d2
            rows[18, m], rows[19, m], rows[20, m] = q0, q1, q2
            rows[21, m], rows[22, m], rows[23, m] = e0 + 0.5 * c0, e1 + 0.5 * c1, e2 + 0.5 * c2
            rows[24, m], rows[25, m], rows[26, m] = e0 - 0.5 * c0, e1 - 0.5 * c1, e2 - 0.5 * c2
        scatter(rows, 0, 3, first, bend)
        scatter(rows, 18, 3, first, moment)
        scatter(rows, 21, 3, first, left)
        scatter(rows, 24, 3, first, right)


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


@kernel
def joint_tangents(chain: Chain, bend: Array, moment: Array, ahead: Array, back: Array) -> None:
    """Write B and the tangents of B q and B^t q by Theta.

    `ahead` (N + 1, 2, 3, 3): d(B q) by a rotation of the left and of the right neighbour; `back` likewise d(B^t q).
    """
    B, G = scratch((3, 3)), scratch((3, 3))
    for i in range(len(bend)):
        x, y, z = bend[i, 0], bend[i, 1], bend[i, 2]
        b, slope = _coefficient(x * x + y * y + z * z)
        theta, q, per = bend[i], moment[i], 1.0 / chain.span[i]
        spring = scale(per, tangent(chain.elastic, i))
        q0, q1, q2 = q[0], q[1], q[2]
        c0, c1, c2 = y * q2 - z * q1, z * q0 - x * q2, x * q1 - y * q0
        d = (y * c2 - z * c1, z * c0 - x * c2, x * c1 - y * c0)
        along = x * q0 + y * q1 + z * q2
        cross = ((0.0, -z, y), (z, 0.0, -x), (-y, x, 0.0))
        turned = ((0.0, -q2, q1), (q2, 0.0, -q0), (-q1, q0, 0.0))
        square = x * x + y * y + z * z
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
                h0, h1, h2 = 0.0, 0.0, 0.0
                for n in range(3):
                    value = G[m, n] - 0.5 * sign * turned[m][n]
                    for k in range(3):
                        value += (B[m, k] if side == 0 else B[k, m]) * spring[k][n]
                    if n == 0:
                        h0 = value
                    elif n == 1:
                        h1 = value
                    else:
                        h2 = value
                for n in range(3):
                    target[i, 0, m, n] = -(h0 * B[n, 0] + h1 * B[n, 1] + h2 * B[n, 2])
                    target[i, 1, m, n] = h0 * B[0, n] + h1 * B[1, n] + h2 * B[2, n]


@kernel
def total_bending(bend: Array) -> float:
    """int |kappa_bending| ds (rad) of joints' rotation vectors (n, 3)."""
    total = 0.0
    for j in range(len(bend)):
        total += np.sqrt(bend[j, 0] * bend[j, 0] + bend[j, 1] * bend[j, 1])
    return total
