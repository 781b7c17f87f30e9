"""GMRES (Saad & Schultz 1986) for the forces of contact, in pieces that a method puts around its own solve.

A rod's tangent K is banded; contact adds E S, where S maps motion to forces y on the nodes and E puts them into the
balances. From K x + E y = b and y = S x follows (1 + S K^-1 E) y = S K^-1 b, a system for the few nodes in contact;
each product is one solve with the rod's factors. About 13 products, from 54 to 1107 pairs.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from solver.kernel import kernel
from solver.rod import Array

KRYLOV = 60
"""Largest number of products."""


class Krylov(NamedTuple):
    """`basis` (KRYLOV + 1, m); vectors `y`, `z` (m,); Hessenberg `H` (KRYLOV + 1, KRYLOV), its Givens rotations
    `givens` (KRYLOV, 2) and residual `g` (KRYLOV + 1,)."""

    basis: Array
    y: Array
    z: Array
    H: Array
    givens: Array
    g: Array

    @classmethod
    def empty(cls, size: int) -> Krylov:
        """Zeros for vectors of up to `size` numbers."""
        return cls(np.zeros((KRYLOV + 1, size)), np.zeros(size), np.zeros(size), np.zeros((KRYLOV + 1, KRYLOV)),
                   np.zeros((KRYLOV, 2)), np.zeros(KRYLOV + 1))  # fmt: skip


@kernel
def begin(krylov: Krylov, size: int) -> bool:
    """Start from the right-hand side in y; False if it is zero."""
    krylov.g[0] = _norm(krylov.y, size)
    if krylov.g[0] > 0.0:
        for c in range(size):
            krylov.basis[0, c] = krylov.y[c] / krylov.g[0]
    return bool(krylov.g[0] > 0.0)


@kernel
def unsolved(krylov: Krylov, used: int, size: int, solved: float) -> bool:
    """Whether another product is needed after `used` for a relative residual of `solved`."""
    g = krylov.g
    return bool(used < min(KRYLOV, size) and abs(g[used]) > solved * abs(g[0]) + 1e-300)


@kernel
def extend(krylov: Krylov, m: int, size: int) -> None:
    """Take in z = S K^-1 E times basis vector m: the next basis vector, column m of H, its Givens rotation."""
    Q, H, z, g, givens = krylov.basis, krylov.H, krylov.z, krylov.g, krylov.givens
    for c in range(size):
        z[c] += Q[m, c]
    for k in range(m + 1):
        overlap = 0.0
        for c in range(size):
            overlap += Q[k, c] * z[c]
        for c in range(size):
            z[c] -= overlap * Q[k, c]
        H[k, m] = overlap
    H[m + 1, m] = _norm(z, size)
    for c in range(size):
        Q[m + 1, c] = z[c] / H[m + 1, m] if H[m + 1, m] > 0.0 else 0.0
    for k in range(m):
        upper = givens[k, 0] * H[k, m] + givens[k, 1] * H[k + 1, m]
        H[k + 1, m] = -givens[k, 1] * H[k, m] + givens[k, 0] * H[k + 1, m]
        H[k, m] = upper
    norm = np.sqrt(H[m, m] ** 2 + H[m + 1, m] ** 2)
    givens[m, 0], givens[m, 1] = H[m, m] / norm, H[m + 1, m] / norm
    H[m, m], H[m + 1, m] = norm, 0.0
    g[m + 1] = -givens[m, 1] * g[m]
    g[m] = givens[m, 0] * g[m]


@kernel
def combine(krylov: Krylov, used: int, size: int) -> None:
    """Write the solution into y."""
    H, g, y = krylov.H, krylov.g, krylov.y
    for m in range(used - 1, -1, -1):
        for k in range(m + 1, used):
            g[m] -= H[m, k] * g[k]
        g[m] /= H[m, m]
    y[:size] = 0.0
    for m in range(used):
        for c in range(size):
            y[c] += g[m] * krylov.basis[m, c]


@kernel
def _norm(z: Array, size: int) -> float:
    total = 0.0
    for c in range(size):
        total += z[c] * z[c]
    return float(np.sqrt(total))
