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

from solver.kernel import kernel
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


@kernel
def interval_tangents(Y: Array, c0: float, h: float, nodes: Nodes, system: Linear) -> None:
    """Write the tangents of the residuals by the scaled unknowns into rows 6 to 17 of `system.panels`."""
    half = 0.5 * h
    for j in range(len(system.panels)):
        panel = system.panels[j, 6:]
        panel[:, :] = 0.0
        for side in range(2):
            node, sign, at = j + side, 2.0 * side - 1.0, 12 * side
            _compatibility_tangent(panel, Y[j], Y[j + 1], sign, at, half, c0)
            _lab_tangents(panel, Y[j], Y[j + 1], node, j, sign, at, half, nodes)
        for i in range(12):
            for k in range(12):
                scale = system.rows[i] * system.columns[k]
                panel[i, k] *= scale
                panel[i, 12 + k] *= scale


@kernel
def _compatibility_tangent(panel: Array, L: Array, R: Array, sign: float, at: int, half: float, c0: float) -> None:
    for i in range(3):
        a, c = (i + 1) % 3, (i + 2) % 3
        panel[i, at + OMEGA + i] = sign
        panel[i, at + OMEGA + c] = half * 0.5 * (L[KAPPA + a] + R[KAPPA + a])
        panel[i, at + OMEGA + a] = -half * 0.5 * (L[KAPPA + c] + R[KAPPA + c])
        panel[i, at + KAPPA + i] = -half * c0
        panel[i, at + KAPPA + a] = half * 0.5 * (L[OMEGA + c] + R[OMEGA + c])
        panel[i, at + KAPPA + c] = -half * 0.5 * (L[OMEGA + a] + R[OMEGA + a])


@kernel
def _lab_tangents(panel: Array, L: Array, R: Array, node: int, j: int, sign: float, at: int, half: float,
                  nodes: Nodes) -> None:  # fmt: skip
    for i in range(3):
        a, c = (i + 1) % 3, (i + 2) % 3
        F_a, F_c = 0.5 * (L[F + a] + R[F + a]), 0.5 * (L[F + c] + R[F + c])
        panel[3 + i, at + V + i] = sign
        panel[6 + i, at + F + i] = sign
        panel[9 + i, at + F + c] = half * 0.5 * (nodes.T[j, a] + nodes.T[j + 1, a])
        panel[9 + i, at + F + a] = -half * 0.5 * (nodes.T[j, c] + nodes.T[j + 1, c])
        for k in range(3):
            panel[3 + i, at + OMEGA + k] = -half * nodes.U_w[node, i, k]
            panel[6 + i, at + V + k] = -half * nodes.P_V[node, i, k]
            panel[6 + i, at + OMEGA + k] = -half * nodes.P_w[node, i, k]
            panel[9 + i, at + KAPPA + k] = sign * nodes.M_k[node, i, k]
            thrust = nodes.T_w[node, a, k] * F_c - nodes.T_w[node, c, k] * F_a
            panel[9 + i, at + OMEGA + k] = sign * nodes.M_w[node, i, k] + half * (thrust - nodes.W_w[node, i, k])
