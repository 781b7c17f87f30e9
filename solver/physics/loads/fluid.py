"""Morison's fluid forces at a node, in the lab frame, with their tangents.

u = V - U is the velocity relative to the current, T the tangent, u_n = u - (u.T) T:

    B = -Ca rho_w A a_n - 0.5 rho_w D Cdn |u_n| u_n - 0.5 rho_w pi D Cdt |u_3| u_3 T.

Each function subtracts its B from `P` (3,) and from its tangents by V and omega; `T_w` is dT/d omega.
"""

from __future__ import annotations

import numpy as np

from solver.arrays import Array
from solver.kernels.kernel import kernel


@kernel
def add_added_mass(coefficient: float, c0: float, acceleration: Array, T: Array, T_w: Array,
                   P: Array, P_V: Array, P_w: Array) -> None:  # fmt: skip
    """Added mass `coefficient` (kg/m) on the normal acceleration a_n = (I - T T^t) dV/dt.

    This is Morison's law. (With v_t on v1, v2 alone, whose power is the rate of 1/2 Ca rho_w A |u_n|^2, the paper's
    scene reaches Wr(25 s) = 0.572 instead of the reference's 0.580: the difference is no detail.)
    """
    along = acceleration[0] * T[0] + acceleration[1] * T[1] + acceleration[2] * T[2]
    for i in range(3):
        P[i] += coefficient * (acceleration[i] - along * T[i])
        P_V[i, i] += coefficient * c0
        for k in range(3):
            P_V[i, k] -= coefficient * c0 * T[i] * T[k]
            swing = acceleration[0] * T_w[0, k] + acceleration[1] * T_w[1, k] + acceleration[2] * T_w[2, k]
            P_w[i, k] -= coefficient * (along * T_w[i, k] + T[i] * swing)


@kernel
def add_fluid_force(added_mass: float, normal: float, tangential: float, acceleration: Array, u: Array, T: Array,
                    P: Array) -> None:  # fmt: skip
    """What `add_added_mass` and `add_drag` do to P, without tangents."""
    along = u[0] * T[0] + u[1] * T[1] + u[2] * T[2]
    pushed = acceleration[0] * T[0] + acceleration[1] * T[1] + acceleration[2] * T[2]
    n0, n1, n2 = u[0] - along * T[0], u[1] - along * T[1], u[2] - along * T[2]
    drag = normal * np.sqrt(n0 * n0 + n1 * n1 + n2 * n2)
    by_T = tangential * abs(along) * along - added_mass * pushed
    P[0] += added_mass * acceleration[0] + drag * n0 + by_T * T[0]
    P[1] += added_mass * acceleration[1] + drag * n1 + by_T * T[1]
    P[2] += added_mass * acceleration[2] + drag * n2 + by_T * T[2]


@kernel
def fluid_power(added_mass: float, normal: float, tangential: float, velocity: Array, current: Array,
                acceleration: Array, T: Array, T_t: Array) -> tuple[float, float]:  # fmt: skip
    """Power (W/m) that the current gives to the rod, and that the fluid takes from it for good.

    The second holds what drag dissipates and u_3 Ca rho_w A u_n.T_t, the part of the power of the added mass that
    does not go into its kinetic energy 1/2 Ca rho_w A |u_n|^2.
    """
    along, swing = 0.0, 0.0
    for i in range(3):
        along += (velocity[i] - current[i]) * T[i]
        swing += acceleration[i] * T[i]
    square, turning = 0.0, 0.0
    for i in range(3):
        across = velocity[i] - current[i] - along * T[i]
        square += across * across
        turning += across * T_t[i]
    speed = np.sqrt(square)
    given = 0.0
    for i in range(3):
        across = velocity[i] - current[i] - along * T[i]
        force = normal * speed * across + tangential * abs(along) * along * T[i]
        force += added_mass * (acceleration[i] - swing * T[i])
        given -= force * current[i]
    lost = normal * speed * square + tangential * abs(along) ** 3 + added_mass * along * turning
    return given, lost


@kernel
def add_drag(normal: float, tangential: float, u: Array, T: Array, T_w: Array,
             P: Array, P_V: Array, P_w: Array) -> None:  # fmt: skip
    """Quadratic drag with `normal` = 0.5 rho_w D Cdn and `tangential` = 0.5 rho_w pi D Cdt (kg/m^2)."""
    along = u[0] * T[0] + u[1] * T[1] + u[2] * T[2]
    n0, n1, n2 = u[0] - along * T[0], u[1] - along * T[1], u[2] - along * T[2]
    speed = np.sqrt(n0 * n0 + n1 * n1 + n2 * n2)
    unit = 1.0 / speed if speed > 0.0 else 0.0
    slide = tangential * abs(along)
    for i in range(3):
        n_i = n0 if i == 0 else (n1 if i == 1 else n2)
        P[i] += normal * speed * n_i + slide * along * T[i]
        for k in range(3):
            n_k = n0 if k == 0 else (n1 if k == 1 else n2)
            delta = 1.0 if i == k else 0.0
            # d|u_n|u_n = (|u_n| I + u_n u_n^t/|u_n|) du_n and du_n = (I - T T^t) du - T (u.dT) - along dT;
            # u_n.T = 0 and T.dT = 0
            P_V[i, k] += normal * (speed * (delta - T[i] * T[k]) + unit * n_i * n_k)
            P_V[i, k] += 2.0 * slide * T[i] * T[k]
            swing = u[0] * T_w[0, k] + u[1] * T_w[1, k] + u[2] * T_w[2, k]
            across = n0 * T_w[0, k] + n1 * T_w[1, k] + n2 * T_w[2, k]
            P_w[i, k] -= normal * (speed * (T[i] * swing + along * T_w[i, k]) + unit * n_i * along * across)
            P_w[i, k] += slide * (2.0 * T[i] * swing + along * T_w[i, k])
