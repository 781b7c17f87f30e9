"""The balances over an interval: residuals and 12 x 24 tangents of equations (2) to (5).

With mean values over the interval (subscript m) and differences (Delta), the box scheme reads (space.py has its
family)

    (2)  Delta omega + h kappa_m x omega_m - h (kappa_t)_m            + h g (kappa_R - kappa)_m = 0   material
    (3)  Delta V - h (dT/dt)_m                                         + g (Delta r - h T_m)    = 0   lab
    (4)  Delta F - h (rho_c A dV/dt - B)_m                                                      = 0   lab
    (5)  Delta (R q) + h T_m x F_m - h (d(R I omega)/dt - Q)_m                                  = 0   lab

(3) to (5) are the paper's equations turned into the lab frame. The terms with g feed back, from the start of the
step, what time integration has let drift: kappa against the curvature kappa_R of the nodes' own frames, and
the stretch. They vanish with the step and keep Tw + Wr = Lk and the ends where they belong.
"""

from __future__ import annotations

from solver.kernel import inlined, kernel
from solver.methods.box.fields import KAPPA, OMEGA, F, Nodes, State, V
from solver.methods.box.space import SpaceScheme
from solver.rod import Array
from solver.rotation import matrix_of, relative_rotation


@kernel
def measure_drift(state: State, h: float, gain: float, drift: Array) -> None:
    """Write h g (kappa_R - kappa)_m, material, and g (Delta r - h T_m), lab, into `drift` (N, 6)."""
    turn = drift[0, :3].copy()
    left, right = drift[0, :3].repeat(3).reshape(3, 3), drift[0, :3].repeat(3).reshape(3, 3)
    matrix_of(state.quaternion[0], right)
    for j in range(len(drift)):
        for i in range(3):
            for k in range(3):
                left[i, k] = right[i, k]
        matrix_of(state.quaternion[j + 1], right)
        relative_rotation(state.quaternion[j], state.quaternion[j + 1], turn)
        for i in range(3):
            kappa = 0.5 * (state.Y[j, KAPPA + i] + state.Y[j + 1, KAPPA + i])
            drift[j, i] = gain * (turn[i] - h * kappa)
            stretch = state.r[j + 1, i] - state.r[j, i] - 0.5 * h * (left[i, 2] + right[i, 2])
            drift[j, 3 + i] = gain * stretch


@kernel
def interval_residuals(Y: Array, past: Array, c0: float, h: float, space: SpaceScheme, nodes: Nodes, drift: Array,
                       rows: Array, b: Array) -> None:  # fmt: skip
    """Write the residuals of (2) to (5), times the row scales, into `b` (N, 12); without the term of A."""
    a, left, right = space.a, space.w_left, space.w_right
    for j in range(len(drift)):
        L, R = Y[j], Y[j + 1]
        for i in range(3):
            m, n = (i + 1) % 3, (i + 2) % 3
            k_m, k_n = left * L[KAPPA + m] + right * R[KAPPA + m], left * L[KAPPA + n] + right * R[KAPPA + n]
            w_m, w_n = left * L[OMEGA + m] + right * R[OMEGA + m], left * L[OMEGA + n] + right * R[OMEGA + n]
            T_m = left * nodes.T[j, m] + right * nodes.T[j + 1, m]
            T_n = left * nodes.T[j, n] + right * nodes.T[j + 1, n]
            F_m, F_n = left * L[F + m] + right * R[F + m], left * L[F + n] + right * R[F + n]
            rate = left * (c0 * L[KAPPA + i] + past[j, 12 + i]) + right * (c0 * R[KAPPA + i] + past[j + 1, 12 + i])
            compatibility = a * (R[OMEGA + i] - L[OMEGA + i]) + h * (k_m * w_n - k_n * w_m - rate) + drift[j, i]
            inextensibility = a * (R[V + i] - L[V + i]) - h * (left * nodes.U[j, i] + right * nodes.U[j + 1, i])
            force = a * (R[F + i] - L[F + i]) - h * (left * nodes.P[j, i] + right * nodes.P[j + 1, i])
            moment = a * (nodes.M[j + 1, i] - nodes.M[j, i]) + h * (T_m * F_n - T_n * F_m)
            moment -= h * (left * nodes.W[j, i] + right * nodes.W[j + 1, i])
            b[j, i] = rows[i] * compatibility
            b[j, 3 + i] = rows[3 + i] * (inextensibility + drift[j, 3 + i])
            b[j, 6 + i] = rows[6 + i] * force
            b[j, 9 + i] = rows[9 + i] * moment


@kernel
def interval_panel(j: int, Y: Array, c0: float, h: float, space: SpaceScheme, nodes: Nodes, rows: Array,
                   columns: Array, mean: Array, panel: Array, top: int) -> None:  # fmt: skip
    """Write the tangents of interval j's residuals by the scaled unknowns into rows `top` to `top` + 11 of `panel`.

    Columns 0 to 11 belong to node j; the upper 12 of the panel's columns start at its middle. `mean` (4, 3) is scratch.
    """
    left, right = space.w_left, space.w_right
    for i in range(top, top + 12):
        for k in range(panel.shape[1]):
            panel[i, k] = 0.0
    for i in range(3):
        mean[0, i] = h * (left * Y[j, KAPPA + i] + right * Y[j + 1, KAPPA + i])
        mean[1, i] = h * (left * Y[j, OMEGA + i] + right * Y[j + 1, OMEGA + i])
        mean[2, i] = h * (left * nodes.T[j, i] + right * nodes.T[j + 1, i])
        mean[3, i] = h * (left * Y[j, F + i] + right * Y[j + 1, F + i])
    for side in range(2):
        sign = space.a if side == 1 else -space.a
        weight = right if side == 1 else left
        at = side * (panel.shape[1] // 2)
        _compatibility(panel, mean, sign, weight, top, at, h * c0, rows, columns)
        _lab_balances(panel, mean, j + side, sign, weight, top, at, h, rows, columns, nodes.T_w, nodes.U_w,
                      nodes.P_V, nodes.P_w, nodes.M_k, nodes.M_w, nodes.W_w)  # fmt: skip


@inlined
def _compatibility(panel: Array, mean: Array, sign: float, weight: float, top: int, at: int, inertia: float,
                   rows: Array, columns: Array) -> None:  # fmt: skip
    """Tangents of (2) by one node; `mean` (4, 3): weighted means of kappa, omega, T and F times h."""
    by_omega, by_kappa = rows[0] * columns[OMEGA], rows[0] * columns[KAPPA] * weight
    for i in range(3):
        m, n = (i + 1) % 3, (i + 2) % 3
        panel[top + i, at + OMEGA + i] = by_omega * sign
        panel[top + i, at + OMEGA + n] = by_omega * weight * mean[0, m]
        panel[top + i, at + OMEGA + m] = -by_omega * weight * mean[0, n]
        panel[top + i, at + KAPPA + i] = -by_kappa * inertia
        panel[top + i, at + KAPPA + m] = by_kappa * mean[1, n]
        panel[top + i, at + KAPPA + n] = -by_kappa * mean[1, m]


@inlined
def _lab_balances(panel: Array, mean: Array, node: int, sign: float, weight: float, top: int, at: int, h: float,
                  rows: Array, columns: Array, T_w: Array, U_w: Array, P_V: Array, P_w: Array, M_k: Array,
                  M_w: Array, W_w: Array) -> None:  # fmt: skip
    """Tangents of (3), (4) and (5) by one node."""
    velocity, force = sign * rows[3] * columns[V], sign * rows[6] * columns[F]
    stretch = -h * weight * rows[3] * columns[OMEGA]
    load_V, load_w = -h * weight * rows[6] * columns[V], -h * weight * rows[6] * columns[OMEGA]
    moment_k, moment_w = sign * rows[9] * columns[KAPPA], rows[9] * columns[OMEGA]
    moment_F = weight * rows[9] * columns[F]
    for i in range(3):
        m, n = (i + 1) % 3, (i + 2) % 3
        panel[top + 3 + i, at + V + i] = velocity
        panel[top + 6 + i, at + F + i] = force
        panel[top + 9 + i, at + F + n] = moment_F * mean[2, m]
        panel[top + 9 + i, at + F + m] = -moment_F * mean[2, n]
        for k in range(3):
            panel[top + 3 + i, at + OMEGA + k] = stretch * U_w[node, i, k]
            panel[top + 6 + i, at + V + k] = load_V * P_V[node, i, k]
            panel[top + 6 + i, at + OMEGA + k] = load_w * P_w[node, i, k]
            panel[top + 9 + i, at + KAPPA + k] = moment_k * M_k[node, i, k]
            thrust = T_w[node, m, k] * mean[3, n] - T_w[node, n, k] * mean[3, m] - h * W_w[node, i, k]
            panel[top + 9 + i, at + OMEGA + k] = moment_w * (sign * M_w[node, i, k] + weight * thrust)
