"""Generalized conjugate residuals (Eisenstat, Elman & Schultz 1983) for the forces of contact, in pieces that a method
puts around its own solve; of real or of complex numbers.

A rod's tangent K is banded; contact adds E S, where S maps motion to forces y on the nodes and E puts them into the
balances. From K x + E y = b and y = S x follows A y = (1 + S K^-1 E) y = S K^-1 b, a system for the few nodes in
contact; each product with A is one solve with the rod's factors. As GMRES it takes the least residual among all
combinations of the directions so far; but a direction may be any: those of a solve before serve again where K is the
same, and cost no solve.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from solver.arrays import Array
from solver.kernels.kernel import inner, kernel

LARGEST_NUMBER = 80
"""Largest number of directions."""
KEPT = 40
"""How many of them may serve again."""
DEPENDENT = 1e-10
"""Part of an image that is left beside those before, below which its direction says nothing new."""


class Krylov(NamedTuple):
    """`directions` (LARGEST_NUMBER, m); orthonormal combinations of their `images` by A, with `R` (LARGEST_NUMBER,
    LARGEST_NUMBER) upper triangular; `parts` (LARGEST_NUMBER,) of the right-hand side along them. `y` (m,): right-hand
    side, then residual, then solution; `z` (m,): a direction's motion as forces; `left` (2,): norms of the first
    two."""

    directions: Array
    images: Array
    R: Array
    parts: Array
    y: Array
    z: Array
    left: Array

    @classmethod
    def empty(cls, size: int, dtype: type = np.float64) -> Krylov:
        """Zeros for vectors of up to `size` numbers."""
        n = LARGEST_NUMBER
        directions: Array = np.zeros((n, size), dtype)
        R: Array = np.zeros((n, n), dtype)
        return cls(directions, directions.copy(), R, R[0].copy(), directions[0].copy(), directions[0].copy(),
                   np.zeros(2))  # fmt: skip


@kernel
def begin(krylov: Krylov, size: int) -> None:
    """Start from the right-hand side in y."""
    krylov.left[:] = _norm(krylov.y, size)


@kernel
def unsolved(krylov: Krylov, used: int, size: int, solved: float) -> bool:
    """Whether another direction is needed after `used` for a relative residual of `solved`."""
    return bool(used < min(LARGEST_NUMBER, size) and krylov.left[1] > solved * krylov.left[0] + 1e-300)


@kernel
def set_out(krylov: Krylov, m: int, size: int) -> None:
    """Make the residual direction m."""
    for c in range(size):
        krylov.directions[m, c] = krylov.y[c] / krylov.left[1]


@kernel
def follow(krylov: Krylov, m: int, size: int) -> None:
    """Go along direction m, z being S K^-1 E times it, as far as the residual falls."""
    V, R, z = krylov.images, krylov.R, krylov.z
    for c in range(size):
        z[c] += krylov.directions[m, c]
    whole = _norm(z, size)
    for k in range(m):
        R[k, m] = np.vdot(V[k, :size], z[:size])
        for c in range(size):
            z[c] -= R[k, m] * V[k, c]
    left = _norm(z, size)
    if not left > DEPENDENT * whole:
        R[m, m], krylov.parts[m] = 1.0, 0.0
        V[m, :size] = 0.0
        return
    R[m, m] = left
    for c in range(size):
        V[m, c] = z[c] / left
    _go_along(krylov, m, size)
    krylov.left[1] = _norm(krylov.y, size)


@inner
def _go_along(krylov: Krylov, m: int, size: int) -> None:
    """Take out of the residual its part along the image of direction m."""
    V, y = krylov.images, krylov.y
    krylov.parts[m] = np.vdot(V[m, :size], y[:size])
    for c in range(size):
        y[c] -= krylov.parts[m] * V[m, c]


@kernel
def project(krylov: Krylov, known: int, size: int) -> None:
    """Go along the first `known` directions, whose images are known, as far as the residual falls."""
    for m in range(known):
        _go_along(krylov, m, size)
    krylov.left[1] = _norm(krylov.y, size)


@kernel
def combine(krylov: Krylov, used: int, size: int) -> None:
    """Write the solution into y."""
    R, parts, y = krylov.R, krylov.parts, krylov.y
    y[:size] = 0.0
    for m in range(used - 1, -1, -1):
        for k in range(m + 1, used):
            parts[m] -= R[m, k] * parts[k]
        parts[m] /= R[m, m]
        for c in range(size):
            y[c] += parts[m] * krylov.directions[m, c]


@inner
def _norm(z: Array, size: int) -> float:
    return float(np.sqrt(np.vdot(z[:size], z[:size]).real))
