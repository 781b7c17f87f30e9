"""The tangent, factored: in bands along the chain, and as a sparse matrix where strands press on each other."""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray
from scipy.linalg.lapack import dgbtrf, dgbtrs
from scipy.sparse import bsr_array, csr_array
from scipy.sparse.linalg import SuperLU, splu

from solver.arrays import Array
from solver.statics.point import BLOCK

BAND = 17
"""Off the diagonal, of the chain's tangent."""


@cache
def _places(n: int) -> tuple[tuple[NDArray[np.bool_], tuple[NDArray[np.int64], NDArray[np.int64]]], ...]:
    """Where the entries of the diagonal, lower and upper blocks lie in LAPACK's band storage."""
    a, p, q = np.meshgrid(np.arange(n), np.arange(BLOCK), np.arange(BLOCK), indexing="ij")
    places = []
    for shift in (0, -1, 1):
        row, column = BLOCK * a + p, BLOCK * (a + shift) + q
        keep = (np.abs(row - column) <= BAND) & (column >= 0) & (column < BLOCK * n)
        places.append((keep, (2 * BAND + (row - column)[keep], column[keep])))
    return tuple(places)


class Solver:
    """The factored tangent of one point."""

    def __init__(self, blocks: tuple[Array, Array, Array], units: Array) -> None:
        self.blocks = D, lower, upper = blocks
        self._units, self._shape = units, (len(D), BLOCK)
        bands = np.zeros((3 * BAND + 1, BLOCK * len(D)), order="F")
        for block, (keep, place) in zip((D, lower, upper), _places(len(D)), strict=True):
            bands[place] = block[keep]
        self._factors, self._pivots, info = dgbtrf(bands, BAND, BAND, overwrite_ab=True)
        pivots = np.abs(self._factors[2 * BAND])
        self.singular = bool(info > 0) or not np.isfinite(pivots).all()

    def solve(self, right: Array) -> Array:
        """The displacement (N + 2, 9) that the tangent takes to `right` (N + 2, 9)."""
        x, _ = dgbtrs(self._factors, BAND, BAND, right.ravel(), self._pivots)
        return np.asarray(x.reshape(self._shape) * self._units)


class CoupledSolver:
    """The same where strands press on each other, whose nodes may be far apart along s."""

    def __init__(self, blocks: tuple[Array, Array, Array], contact: csr_array, units: Array) -> None:
        self.blocks = D, lower, upper = blocks
        n = len(D)
        self._units, self._shape = units, (n, BLOCK)
        data = np.stack([lower, D, upper], axis=1).reshape(-1, BLOCK, BLOCK)[1:-1]
        columns = (np.arange(n)[:, None] + np.arange(-1, 2)).ravel()[1:-1]
        starts = np.clip(3 * np.arange(n + 1) - 1, 0, 3 * n - 2)
        chain = bsr_array((data, columns, starts), shape=(BLOCK * n, BLOCK * n))
        self.singular = False
        try:
            self._factors: SuperLU = splu((chain.tocsr() + contact).tocsc(), relax=1, panel_size=1)  # it is narrow
        except RuntimeError:  # as it says that a pivot vanished
            self.singular = True

    def solve(self, right: Array) -> Array:
        """The displacement (N + 2, 9) that the tangent takes to `right` (N + 2, 9)."""
        return np.asarray(self._factors.solve(right.ravel()).reshape(self._shape) * self._units)
