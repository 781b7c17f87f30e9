"""The balances over an interval: residuals and 12 x 24 tangents of equations (2) to (5).

With mean values over the interval (subscript m) and differences (Delta), the box scheme reads (schemes.py has its
family), with R_m the mean of the two nodes' rotations:

    (2)  Delta omega + h kappa_m x omega_m - h (kappa_t)_m                                       = 0   material
    (3)  Delta V - h R_m (omega_m x a3) + g (Delta r - h T_m)                                    = 0   lab
    (4)  Delta F - h (rho_c A dV/dt - B)_m                                                       = 0   lab
    (5)  Delta q + h kappa_m x q_m + h a3 x R_m^t F_m - h (I omega_t + omega x I omega - Q)_m    = 0   material

(3) and (4) are the paper's equations turned into the lab frame. (2) and (5), and (3) and (4), are adjoint to each
other: F_m . R_m (omega_m x a3) + omega_m . (a3 x R_m^t F_m) = 0, and likewise for q and omega. So the scheme in space
conserves energy, at all wave lengths.
The term with g takes back the stretch that has crept in (extrapolated from the last two steps to the end of this one):
R_m (omega_m x a3) is not quite the rate of T_m. kappa is left alone. Why: see docs/decisions/0002.
"""

from __future__ import annotations

from solver.arrays import Array
from solver.kernels.kernel import inlined, inner
from solver.kernels.scratch import scratch
from solver.methods.space.box.fields import KAPPA, OMEGA, F, Nodes, V
from solver.methods.space.box.schemes import SpaceScheme

MEANS = 5
"""Means over an interval: kappa, omega, F (lab), q, and a3 x R_m^t F_m."""


@inner
def interval_residuals(Y: Array, past: Array, c0: float, h: float, space: SpaceScheme, nodes: Nodes, feedback: Array,
                       rows: Array, b: Array) -> None:  # fmt: skip
    """Write the residuals of (2) to (5), times the row scales, into `b` (N, 12); without the term of A.

    `feedback` (N, 3) is g (Delta r - h T_m).
    """
    a, left, right, mean = space.a, space.w_left, space.w_right, scratch((MEANS, 3))
    for j in range(len(b)):
        L, R = Y[j], Y[j + 1]
        _take_means(j, Y, left, right, nodes, mean)
        kappa, omega, q, thrust = mean[0], mean[1], mean[3], mean[4]
        for i in range(3):
            m, n = (i + 1) % 3, (i + 2) % 3
            rate = left * (c0 * L[KAPPA + i] + past[j, 12 + i]) + right * (c0 * R[KAPPA + i] + past[j + 1, 12 + i])
            compatibility = a * (R[OMEGA + i] - L[OMEGA + i])
            compatibility += h * (kappa[m] * omega[n] - kappa[n] * omega[m] - rate)
            swing = left * (nodes.R[j, i, 0] * omega[1] - nodes.R[j, i, 1] * omega[0])
            swing += right * (nodes.R[j + 1, i, 0] * omega[1] - nodes.R[j + 1, i, 1] * omega[0])
            inextensibility = a * (R[V + i] - L[V + i]) - h * swing + feedback[j, i]
            translation = a * (R[F + i] - L[F + i]) - h * (left * nodes.P[j, i] + right * nodes.P[j + 1, i])
            rotation = a * (nodes.q[j + 1, i] - nodes.q[j, i]) + h * (kappa[m] * q[n] - kappa[n] * q[m] + thrust[i])
            rotation -= h * (left * nodes.W[j, i] + right * nodes.W[j + 1, i])
            b[j, i] = rows[i] * compatibility
            b[j, 3 + i] = rows[3 + i] * inextensibility
            b[j, 6 + i] = rows[6 + i] * translation
            b[j, 9 + i] = rows[9 + i] * rotation


@inlined
def _take_means(j: int, Y: Array, left: float, right: float, nodes: Nodes, mean: Array) -> None:
    """Write the weighted means of kappa, omega, F and q, and a3 x R_m^t F_m, into `mean` (MEANS, 3)."""
    for i in range(3):
        mean[0, i] = left * Y[j, KAPPA + i] + right * Y[j + 1, KAPPA + i]
        mean[1, i] = left * Y[j, OMEGA + i] + right * Y[j + 1, OMEGA + i]
        mean[2, i] = left * Y[j, F + i] + right * Y[j + 1, F + i]
        mean[3, i] = left * nodes.q[j, i] + right * nodes.q[j + 1, i]
    mean[4, 0] = mean[4, 1] = mean[4, 2] = 0.0
    for i in range(3):
        mean[4, 0] -= (left * nodes.R[j, i, 1] + right * nodes.R[j + 1, i, 1]) * mean[2, i]
        mean[4, 1] += (left * nodes.R[j, i, 0] + right * nodes.R[j + 1, i, 0]) * mean[2, i]


@inlined
def interval_panel(j: int, Y: Array, c0: float, h: float, space: SpaceScheme, nodes: Nodes,
                   rows: Array, columns: Array, mean: Array, panel: Array, top: int) -> None:  # fmt: skip
    """Write the tangents of interval j's residuals by the scaled unknowns into rows `top` to `top` + 11 of `panel`.

    Columns 0 to 11 belong to node j, those from the panel's middle on to node j + 1. Zeros are not written: the panel
    has them, or an interval's tangents. `mean` (MEANS, 3) is scratch.
    """
    _take_means(j, Y, space.w_left, space.w_right, nodes, mean)
    for side in range(2):
        node = j + side
        sign = space.a if side == 1 else -space.a
        weight = h * (space.w_right if side == 1 else space.w_left)
        at = side * (panel.shape[1] // 2)
        _compatibility(panel, mean, sign, weight, top, at, c0, rows, columns)
        _translation(panel, mean, sign, weight, top, at, space, j, nodes.R, nodes.J[node], nodes.R[node],
                     nodes.P_V[node], nodes.P_w[node], rows, columns)  # fmt: skip
        _rotation(panel, mean, sign, weight, top, at, space, j, nodes.R, nodes.J[node], nodes.R[node],
                  nodes.W_w[node], nodes.K[node], rows, columns)  # fmt: skip


@inlined
def _compatibility(panel: Array, mean: Array, sign: float, weight: float, top: int, at: int, c0: float,
                   rows: Array, columns: Array) -> None:  # fmt: skip
    """Tangents of (2) by one node; `weight` is h times the node's weight in the means."""
    by_omega, by_kappa = rows[0] * columns[OMEGA], rows[0] * columns[KAPPA] * weight
    for i in range(3):
        m, n = (i + 1) % 3, (i + 2) % 3
        panel[top + i, at + OMEGA + i] = by_omega * sign
        panel[top + i, at + OMEGA + n] = by_omega * weight * mean[0, m]
        panel[top + i, at + OMEGA + m] = -by_omega * weight * mean[0, n]
        panel[top + i, at + KAPPA + i] = -by_kappa * c0
        panel[top + i, at + KAPPA + m] = by_kappa * mean[1, n]
        panel[top + i, at + KAPPA + n] = -by_kappa * mean[1, m]


@inlined
def _translation(panel: Array, mean: Array, sign: float, weight: float, top: int, at: int, space: SpaceScheme, j: int,
                 Rs: Array, J: Array, R: Array, P_V: Array, P_w: Array, rows: Array,
                 columns: Array) -> None:  # fmt: skip
    """Tangents of (3) and (4) by one node with rotation R; `Rs` are all nodes' rotations."""
    x, y = mean[1, 1], -mean[1, 0]
    velocity, force = sign * rows[3] * columns[V], sign * rows[6] * columns[F]
    swing = -weight * rows[3] * columns[OMEGA]
    load_V, load_w = -weight * rows[6] * columns[V], -weight * rows[6] * columns[OMEGA]
    for i in range(3):
        panel[top + 3 + i, at + V + i] = velocity
        panel[top + 6 + i, at + F + i] = force
        # d(R_j (omega_m x a3)) = -R_j [omega_m x a3] J d omega
        a, b, c = y * R[i, 2], -x * R[i, 2], x * R[i, 1] - y * R[i, 0]
        for k in range(3):
            panel[top + 3 + i, at + OMEGA + k] = swing * (a * J[0, k] + b * J[1, k] + c * J[2, k])
            panel[top + 6 + i, at + V + k] = load_V * P_V[i, k]
            panel[top + 6 + i, at + OMEGA + k] = load_w * P_w[i, k]
        panel[top + 3 + i, at + OMEGA] -= swing * (space.w_left * Rs[j, i, 1] + space.w_right * Rs[j + 1, i, 1])
        panel[top + 3 + i, at + OMEGA + 1] += swing * (space.w_left * Rs[j, i, 0] + space.w_right * Rs[j + 1, i, 0])


@inlined
def _rotation(panel: Array, mean: Array, sign: float, weight: float, top: int, at: int, space: SpaceScheme, j: int,
              Rs: Array, J: Array, R: Array, W_w: Array, K: Array, rows: Array,
              columns: Array) -> None:  # fmt: skip
    """Tangents of (5) by one node with rotation R and moment q, dq / d kappa = K (3, 3)."""
    by_kappa, by_omega = rows[9] * columns[KAPPA], weight * rows[9] * columns[OMEGA]
    by_F = weight * rows[9] * columns[F]
    f0 = R[0, 0] * mean[2, 0] + R[1, 0] * mean[2, 1] + R[2, 0] * mean[2, 2]
    f1 = R[0, 1] * mean[2, 0] + R[1, 1] * mean[2, 1] + R[2, 1] * mean[2, 2]
    f2 = R[0, 2] * mean[2, 0] + R[1, 2] * mean[2, 1] + R[2, 2] * mean[2, 2]
    for i in range(3):
        m, n = (i + 1) % 3, (i + 2) % 3
        for k in range(3):
            panel[top + 9 + i, at + KAPPA + k] = by_kappa * (sign * K[i, k]
                                                             + weight * (mean[0, m] * K[n, k] - mean[0, n] * K[m, k]))
        panel[top + 9 + i, at + KAPPA + n] -= by_kappa * weight * mean[3, m]
        panel[top + 9 + i, at + KAPPA + m] += by_kappa * weight * mean[3, n]
        for k in range(3):
            panel[top + 9 + i, at + OMEGA + k] = -by_omega * W_w[i, k]
    for k in range(3):
        # d(R^t F) = (R^t F) x J d omega; a3 x y = (-y_2, y_1, 0)
        panel[top + 9, at + OMEGA + k] -= by_omega * (f2 * J[0, k] - f0 * J[2, k])
        panel[top + 10, at + OMEGA + k] += by_omega * (f1 * J[2, k] - f2 * J[1, k])
        panel[top + 9, at + F + k] = -by_F * (space.w_left * Rs[j, k, 1] + space.w_right * Rs[j + 1, k, 1])
        panel[top + 10, at + F + k] = by_F * (space.w_left * Rs[j, k, 0] + space.w_right * Rs[j + 1, k, 0])
