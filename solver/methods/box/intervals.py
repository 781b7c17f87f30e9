"""The balances over an interval: residuals and 12 x 24 tangents of equations (2) to (5).

With mean values over the interval (subscript m) and differences (Delta), the box scheme reads

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
from solver.methods.box.fields import KAPPA, OMEGA, F, Linear, Nodes, State, V
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
def interval_residuals(Y: Array, past: Array, c0: float, h: float, nodes: Nodes, drift: Array,
                       system: Linear) -> None:  # fmt: skip
    """Write the residuals of (2) to (5), times the system's row scales, into `system.b` (N, 12)."""
    rows, half = system.rows, 0.5 * h
    for j in range(len(drift)):
        L, R = Y[j], Y[j + 1]
        for i in range(3):
            a, c = (i + 1) % 3, (i + 2) % 3
            k_a, k_c = 0.5 * (L[KAPPA + a] + R[KAPPA + a]), 0.5 * (L[KAPPA + c] + R[KAPPA + c])
            w_a, w_c = 0.5 * (L[OMEGA + a] + R[OMEGA + a]), 0.5 * (L[OMEGA + c] + R[OMEGA + c])
            T_a, T_c = 0.5 * (nodes.T[j, a] + nodes.T[j + 1, a]), 0.5 * (nodes.T[j, c] + nodes.T[j + 1, c])
            F_a, F_c = 0.5 * (L[F + a] + R[F + a]), 0.5 * (L[F + c] + R[F + c])
            rate = c0 * (L[KAPPA + i] + R[KAPPA + i]) + past[j, 12 + i] + past[j + 1, 12 + i]
            compatibility = R[OMEGA + i] - L[OMEGA + i] + h * (k_a * w_c - k_c * w_a) - half * rate + drift[j, i]
            inextensibility = R[V + i] - L[V + i] - half * (nodes.U[j, i] + nodes.U[j + 1, i]) + drift[j, 3 + i]
            force = R[F + i] - L[F + i] - half * (nodes.P[j, i] + nodes.P[j + 1, i])
            moment = nodes.M[j + 1, i] - nodes.M[j, i] + h * (T_a * F_c - T_c * F_a)
            moment -= half * (nodes.W[j, i] + nodes.W[j + 1, i])
            system.b[j, i] = rows[i] * compatibility
            system.b[j, 3 + i] = rows[3 + i] * inextensibility
            system.b[j, 6 + i] = rows[6 + i] * force
            system.b[j, 9 + i] = rows[9 + i] * moment


@inlined
def interval_panel(j: int, Y: Array, c0: float, h: float, nodes: Nodes, rows: Array, columns: Array, mean: Array,
                   panel: Array) -> None:  # fmt: skip
    """Write the tangents of interval j's residuals by the scaled unknowns into rows 6 to 17 of `panel` (18, 24).

    Columns 0 to 11 belong to node j, 12 to 23 to node j + 1. `mean` (4, 3) is scratch.
    """
    for i in range(6, 18):
        for k in range(24):
            panel[i, k] = 0.0
    for i in range(3):
        mean[0, i] = 0.25 * h * (Y[j, KAPPA + i] + Y[j + 1, KAPPA + i])
        mean[1, i] = 0.25 * h * (Y[j, OMEGA + i] + Y[j + 1, OMEGA + i])
        mean[2, i] = 0.25 * h * (nodes.T[j, i] + nodes.T[j + 1, i])
        mean[3, i] = 0.25 * h * (Y[j, F + i] + Y[j + 1, F + i])
    for side in range(2):
        _compatibility(panel, mean, 2.0 * side - 1.0, 12 * side, 0.5 * h * c0, rows, columns)
        _lab_balances(panel, mean, j + side, 2.0 * side - 1.0, 12 * side, 0.5 * h, rows, columns, nodes.T_w,
                      nodes.U_w, nodes.P_V, nodes.P_w, nodes.M_k, nodes.M_w, nodes.W_w)  # fmt: skip


@inlined
def _compatibility(panel: Array, mean: Array, sign: float, at: int, inertia: float, rows: Array,
                   columns: Array) -> None:  # fmt: skip
    """Tangents of (2) by one node; `mean` (4, 3): means of kappa, omega, T and F times h/2."""
    by_omega, by_kappa = rows[0] * columns[OMEGA], rows[0] * columns[KAPPA]
    for i in range(3):
        a, c = (i + 1) % 3, (i + 2) % 3
        panel[6 + i, at + OMEGA + i] = by_omega * sign
        panel[6 + i, at + OMEGA + c] = by_omega * mean[0, a]
        panel[6 + i, at + OMEGA + a] = -by_omega * mean[0, c]
        panel[6 + i, at + KAPPA + i] = -by_kappa * inertia
        panel[6 + i, at + KAPPA + a] = by_kappa * mean[1, c]
        panel[6 + i, at + KAPPA + c] = -by_kappa * mean[1, a]


@inlined
def _lab_balances(panel: Array, mean: Array, node: int, sign: float, at: int, half: float, rows: Array,
                  columns: Array, T_w: Array, U_w: Array, P_V: Array, P_w: Array, M_k: Array, M_w: Array,
                  W_w: Array) -> None:  # fmt: skip
    """Tangents of (3), (4) and (5) by one node."""
    velocity, force = sign * rows[3] * columns[V], sign * rows[6] * columns[F]
    stretch = -half * rows[3] * columns[OMEGA]
    load_V, load_w = -half * rows[6] * columns[V], -half * rows[6] * columns[OMEGA]
    moment_k, moment_w, moment_F = sign * rows[9] * columns[KAPPA], rows[9] * columns[OMEGA], rows[9] * columns[F]
    for i in range(3):
        a, c = (i + 1) % 3, (i + 2) % 3
        panel[9 + i, at + V + i] = velocity
        panel[12 + i, at + F + i] = force
        panel[15 + i, at + F + c] = moment_F * mean[2, a]
        panel[15 + i, at + F + a] = -moment_F * mean[2, c]
        for k in range(3):
            panel[9 + i, at + OMEGA + k] = stretch * U_w[node, i, k]
            panel[12 + i, at + V + k] = load_V * P_V[node, i, k]
            panel[12 + i, at + OMEGA + k] = load_w * P_w[node, i, k]
            panel[15 + i, at + KAPPA + k] = moment_k * M_k[node, i, k]
            thrust = T_w[node, a, k] * mean[3, c] - T_w[node, c, k] * mean[3, a]
            panel[15 + i, at + OMEGA + k] = moment_w * (sign * M_w[node, i, k] - half * W_w[node, i, k] + thrust)
