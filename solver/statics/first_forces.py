"""The tension with which a static analysis begins.

What holds the initial shape is let go step by step. A rope that hangs from one end would begin as limp as its section
is, and take any way down. So the rod begins with a tension tau along its tangents T, which may not push: that for which
the forces on segments and free ends, as they are loaded, are balanced best. It has no moments, so that forces hold the
shape of a straight rod: while moments do, a count of the directions of falling energy says nothing.
"""

from __future__ import annotations

import numpy as np
from scipy.linalg import solveh_banded

from solver.arrays import Array
from solver.statics.equations import Equations
from solver.statics.point import FORCE, X

AT_FREE_ENDS = 100.0
"""How much more it counts that a free end is balanced than a segment."""
SMALLEST = 1e-12
"""Of the weight of a segment's balance in each tension: where nothing says what it is there is none."""


def first_forces(equations: Equations) -> Array:
    """The tension's forces F (N + 1, 3), N, lab, at the nodes of a rod that is held where it lies without any."""
    left, T = equations.holding[:, X], equations.stages.R[0, :, :, 2]
    nodes = np.vstack([T[:1], T[1:-2] + T[2:-1], T[-1:]])
    nodes /= np.linalg.norm(nodes, axis=1)[:, None]
    weights = np.ones((len(left), 3))
    for side, end in enumerate(equations.ends):
        weights[-side] = np.where(end.held[:3], 0.0, AT_FREE_ENDS)
    D, _, upper = equations.blocks()
    behind, before = D[1:, X, FORCE] @ nodes[:, :, None], upper[:-1, X, FORCE] @ nodes[:, :, None]
    behind, before = weights[1:] * behind[:, :, 0], weights[:-1] * before[:, :, 0]
    left = weights * left
    bands = np.zeros((2, len(nodes)))
    bands[0] = np.sum(behind**2 + before**2, axis=1) + SMALLEST
    bands[1, :-1] = np.sum(behind[:-1] * before[1:], axis=1)
    tension = solveh_banded(bands, -np.sum(behind * left[1:] + before * left[:-1], axis=1), lower=True)
    return np.asarray(np.maximum(tension, 0.0)[:, None] * nodes * equations.units[FORCE])
