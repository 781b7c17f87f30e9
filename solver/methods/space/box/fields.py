"""The arrays of the box method, each named once.

Unknowns at a node, in this order: V = R v (lab), omega (material), kappa (material), F = R f (lab).
Translation is balanced in the lab frame: there its inertia is rho_c A dV/dt without a gyroscopic term and
linear momentum is conserved to rounding (docs/decisions/0002-lab-frame-balances.md).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from solver.arrays import Array

V, OMEGA, KAPPA, F = 0, 3, 6, 9
"""First column of each unknown in Y (n, 12)."""


class State(NamedTuple):
    """The rod at one time, at n nodes. What a step reads and writes, and all that a restart needs.

    `Y` (n, 12); `rate` (n, 9): time derivatives of V, omega, kappa; `aux` (n, 15): generalized-alpha's own
    rates of r, theta, V, omega, kappa; `r` (n, 3) lab positions; `quaternion` (n, 4).
    """

    Y: Array
    rate: Array
    aux: Array
    r: Array
    quaternion: Array

    @classmethod
    def empty(cls, n: int) -> State:
        """A state of zeros with n nodes."""
        return cls(np.zeros((n, 12)), np.zeros((n, 9)), np.zeros((n, 15)), np.zeros((n, 3)), np.zeros((n, 4)))


class Nodes(NamedTuple):
    """What the nodes bring to the balances, at the current iterate, and its tangents.

    (n, 3): `P` = rho_c A dV/dt - B (lab); `q` moment (material); `W` = I omega_t + omega x I omega
    - Q (material). (n, 3, 3): `R`; `J` = d psi / d omega; `K` = dq / d kappa; the rest are d(first letter)/d(V or omega
    (`w`)).
    """

    R: Array
    J: Array
    P: Array
    q: Array
    K: Array
    W: Array
    P_V: Array
    P_w: Array
    W_w: Array

    @classmethod
    def empty(cls, n: int) -> Nodes:
        """Zeros for n nodes."""
        return cls(*(np.zeros((n, 3) if name in ("P", "q", "W") else (n, 3, 3)) for name in cls._fields))
