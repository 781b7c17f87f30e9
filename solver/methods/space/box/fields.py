"""The arrays of the box method, each named once.

Unknowns at a node, in this order: V = R v (lab), omega (material), kappa (material), F = R f (lab).
Translation is balanced in the lab frame: there its inertia is rho_c A dV/dt without a gyroscopic term and
linear momentum is conserved to rounding (docs/decisions/0002-lab-frame-balances.md).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from solver.arrays import Array
from solver.methods.space.box.schemes import BOX, SpaceScheme

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
    - Q (material). (n, 3, 3): `R`; `J` = d psi / d omega; the rest are d(first letter)/d(V or omega (`w`)).
    """

    R: Array
    J: Array
    P: Array
    q: Array
    W: Array
    P_V: Array
    P_w: Array
    W_w: Array

    @classmethod
    def empty(cls, n: int) -> Nodes:
        """Zeros for n nodes."""
        return cls(*(np.zeros((n, 3) if name in ("P", "q", "W") else (n, 3, 3)) for name in cls._fields))


class Wide(NamedTuple):
    """The system of generalized-alpha in space: 24 unknowns a node, Y and the auxiliary derivatives A along s.

    `A` (n, 12); `panels` (N, 42, 48) with `swaps` (N, 24); `last` (24, 48) with `last_swaps` (24,); residuals
    `b_start` (18,), `b` (N, 24), `b_end` (6,); `rhs_start`, `rhs` the same shapes; `y` (N, 42); `x` (n, 24).
    """

    A: Array
    panels: Array
    swaps: Array
    last: Array
    last_swaps: Array
    b_start: Array
    b: Array
    rhs_start: Array
    rhs: Array
    y: Array
    x: Array

    @classmethod
    def empty(cls, intervals: int) -> Wide:
        """Zeros for a rod of `intervals` intervals; 0 where the box scheme needs none."""
        N, n = intervals, intervals + 1 if intervals else 0
        return cls(np.zeros((n, 12)), np.zeros((N, 42, 48)), np.zeros((N, 24), np.int64), np.zeros((24, 48)),
                   np.zeros(24, np.int64), np.zeros(18), np.zeros((N, 24)), np.zeros(18), np.zeros((N, 24)),
                   np.zeros((N, 42)), np.zeros((n, 24)))  # fmt: skip


class Linear(NamedTuple):
    """The almost block diagonal system and its factors.

    `space` the scheme along s; factors, see condensation.py: `swept` (N, 6, 3, 3), `by_swept` (N, 9, 6), `lower`
    (N, 72) with `swaps` (N, 6), `upper` (N, 96), `last` (12, 24) with `last_swaps` (12,); `start`, `end` (6, 12)
    rows of the ends; residuals `b` (N, 12), `b_start`, `b_end` (6,); `x` (n, 12) solution; `columns`, `rows` (12,)
    scales; `wide` what rho_inf_space < 1 needs. Scratch: `rhs` (N, 12).
    """

    space: SpaceScheme
    swept: Array
    by_swept: Array
    lower: Array
    upper: Array
    start: Array
    end: Array
    b: Array
    b_start: Array
    b_end: Array
    swaps: Array
    last: Array
    last_swaps: Array
    x: Array
    rhs: Array
    columns: Array
    rows: Array
    wide: Wide

    @classmethod
    def empty(cls, intervals: int, space: SpaceScheme = BOX) -> Linear:
        """Zeros for a rod of `intervals` intervals."""
        N = intervals
        return cls(
            space, np.zeros((N, 6, 3, 3)), np.zeros((N, 9, 6)), np.zeros((N, 72)), np.zeros((N, 96)),
            np.zeros((6, 12)), np.zeros((6, 12)), np.zeros((N, 12)), np.zeros(6), np.zeros(6),
            np.zeros((N, 6), np.int64), np.zeros((12, 24)), np.zeros(12, np.int64), np.zeros((N + 1, 12)),
            np.zeros((N, 12)), np.ones(12), np.ones(12), Wide.empty(0 if space == BOX else N),
        )  # fmt: skip
