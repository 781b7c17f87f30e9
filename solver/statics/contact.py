"""Self-contact at rest: forces on the nodes, their tangent, and whether a step along a branch let strands through.

The law is that of motion, without its damping. Where no constants are given it is twice as steep, as no step in time
is the shorter for it, and so strong that strands stand for hard ones of diameter D: under the pressure p that is
foreseen they rest at the d at which D - d = U / p, with U the energy per length that they store. Hard strands would
have to be pushed apart by as much work. Where no spacing is given either, points lie closer, as a steeper law asks, and
as nothing shakes a strand that crosses another out of the hollows between that one's points.
"""

from __future__ import annotations

from math import inf

import numpy as np
from numpy.typing import NDArray

from solver.arrays import Array
from solver.kernels.kernel import kernel
from solver.physics.contact.forces import Touch, allowed_fraction, press
from solver.physics.contact.points import REACH
from solver.physics.contact.recipe import Hardness, foreseen
from solver.physics.contact.self_contact import SelfContact
from solver.scene.scene import Scene

AT_REST = Hardness(pole=0.75, spacing=0.2, margin=0.371)
"""D - d is 3 % of D: with u = (d - p D) / (2 (1 - p) D), where 1/2 - u is the integral of (1/x - 1)^4 from u to 1 over
(1/u - 1)^4, whatever the pole p; the margin is 1 / (1/u - 1)^4."""


class StaticContact(SelfContact):
    """The contact of a scene, which may have none. Nodes `r` are (N + 1, 3), lab. `energy` (J): what it stores."""

    def __init__(self, scene: Scene, s: Array, r: Array) -> None:
        """`r`: where the nodes begin."""
        super().__init__(scene.contact, scene.rod, s, 1, foreseen(scene), AT_REST)
        self._kept = r.copy(), self.rest
        self.energy = 0.0

    def begin(self, r: Array, energy: float) -> None:
        """Begin with nodes r, with the forces that `push` was asked for last, which store `energy` (J)."""
        self._kept, self.energy = (r.copy(), self.push(r).copy()), energy

    def look_ahead(self, bending: float, r: Array, moved: Array) -> None:
        """Before a step from nodes r, which may move by about `moved` (N + 1, 3): list who may touch."""
        self.prepare(bending, r, moved, 1.0, anew=True)

    def push(self, r: Array) -> Array:
        """The forces on the nodes (N + 1, 3), lab, N."""
        if not self.touching:
            return self.rest
        touch = self.touch
        press(touch, r[None], self.rest[None], 0)
        return np.asarray(touch.push[0])

    def allowed(self, moved: Array) -> float:
        """The part of a change of the nodes (N + 1, 3) that may be taken without using up a pair's distance."""
        if not self.touching:
            return 1.0
        return float(allowed_fraction(self.touch, moved, 0))

    def stiffness(self) -> tuple[Array, NDArray[np.bool_]]:
        """How the forces on the nodes change with their places (n, 3, n, 3), with the sign of a stiffness, N/m; and
        which pairs of nodes it couples (n, n)."""
        n = len(self.rest)
        S, coupled = np.zeros((n, 3, n, 3)), np.zeros((n, n), np.bool_)
        _stiffen(self.touch, S, coupled)
        return S, coupled

    def compile(self) -> None:
        """Have every kernel compiled that contact needs."""
        super().compile()
        touch, r = self.touch, self.rest
        press(touch, r[None], r[None], 0)
        allowed_fraction(touch, r, 0)
        self.stiffness()
        self.look_ahead(inf, r, r)
        self.refusal(inf, lambda: (r, r))

    def keep(self, r: Array) -> None:
        """Enter that a step has brought the nodes to r, with the forces that `push` was asked for last: the energy that
        contact stores is the work done against it, by the mean of the forces before and after."""
        push = self.touch.push[0] if self.touching else self.rest
        before, pushed = self._kept
        self.energy -= 0.5 * float(np.sum((push + pushed) * (r - before)))
        self._kept = r.copy(), push.copy()


@kernel
def _stiffen(touch: Touch, S: Array, coupled: NDArray[np.bool_]) -> None:
    """Add the stiffness of the pairs that press: as one's place and tangent change from the other's by dp, dt_a and
    dt_b, the force on it changes by n (g . dp + k0 n . dt_a + k1 n . dt_b) + pull dp (see `pair_force`)."""
    points, tangents = touch.points, touch.tangents
    for pair in range(tangents.many[0]):
        ends = tangents.first[pair], tangents.second[pair]
        n, g, k, pull = tangents.n[pair], tangents.g[pair], tangents.k[pair], tangents.pull[pair]
        for other in range(2 * REACH):
            b, e = ends[other // REACH], other % REACH
            share, along = points.weights[b, e], k[other // REACH] * points.slopes[b, e]
            share = share if other < REACH else -share
            column = points.first[b] + e
            for own in range(2 * REACH):
                a, e = ends[own // REACH], own % REACH
                weight = points.weights[a, e] if own < REACH else -points.weights[a, e]
                row = points.first[a] + e
                coupled[row, column] = True
                for p in range(3):
                    S[row, p, column, p] -= weight * share * pull
                    for q in range(3):
                        S[row, p, column, q] -= weight * n[p] * (share * g[q] + along * n[q])
