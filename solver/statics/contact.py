"""Self-contact at rest: forces on the nodes, their tangent, and whether a step along a branch let strands through.

The law is that of motion, without its damping. Where no constants are given it is as strong as the pressure that is
foreseen, so that strands rest at d = D, with no margin for those that come flying. Where no spacing is given either,
points lie closer: nothing shakes a strand that crosses another out of the hollows between that one's points.
"""

from __future__ import annotations

from dataclasses import replace
from math import inf

import numpy as np
from scipy.sparse import bsr_array, csr_array, kron

from solver.arrays import Array
from solver.physics.contact.forces import allowed_fraction, move_points, press
from solver.physics.contact.points import REACH
from solver.physics.contact.recipe import MARGIN, foreseen
from solver.physics.contact.self_contact import SelfContact
from solver.scene.scene import Scene

SPACING = 0.2
"""In D: of the points along the rod."""


class StaticContact:
    """The contact of a scene, which may have none. Nodes `r` are (N + 1, 3), lab. `energy` (J): what it stores."""

    def __init__(self, scene: Scene, s: Array, r: Array) -> None:
        """`r`: where the nodes begin."""
        contact = scene.contact
        if contact is not None and contact.automatic and contact.spacing is None:
            contact = replace(contact, spacing=SPACING * float(np.min(scene.rod.diameter(s))))
        self._contact = SelfContact(contact, scene.rod, s, 1, foreseen(scene))
        if contact is not None and contact.automatic:
            self._contact.touch.points.mass[:] /= MARGIN
        self._still = np.zeros((1, len(s), 3))
        self._kept = r.copy(), self._still[0]
        self.energy = 0.0

    @property
    def present(self) -> bool:
        """Whether the scene has contact at all."""
        return self._contact.present

    @property
    def pressing(self) -> int:
        """Pairs that press on each other, of the nodes that `push` was asked for last."""
        return int(self._contact.pressing)

    def prepare(self, bending: float, r: Array, moved: Array) -> None:
        """Before a step from nodes r, which may move by about `moved` (N + 1, 3): list who may touch."""
        if self.present:
            self._contact.prepare(bending, r, moved, 1.0, anew=True)

    def refusal(self, bending: float, r: Array) -> str:
        """After a step to nodes r: why it cannot be trusted, or nothing."""
        return self._contact.refusal(bending, lambda: (r, self._still[0])) if self.present else ""

    def smallest_gap(self, bending: float, r: Array) -> float:
        """Smallest surface-to-surface distance (m) of points more than the skip apart; NaN if contact is ruled out."""
        return float(self._contact.smallest_gap(bending, r, self._still[0]))

    def push(self, r: Array) -> Array:
        """The forces on the nodes (N + 1, 3), lab, N."""
        if not self._contact.touching:
            return np.asarray(self._still[0])
        touch = self._contact.touch
        press(touch, touch.pressing, r[None], self._still)
        return np.asarray(touch.push[0])

    def allowed(self, moved: Array) -> float:
        """The part of a change of the nodes (N + 1, 3) that may be taken without using up a pair's distance."""
        if not self._contact.touching:
            return 1.0
        touch = self._contact.touch
        move_points(touch, touch.pairs.members, moved, self._still[0])
        return float(allowed_fraction(touch, touch.pressing, 0))

    def stiffness(self) -> csr_array:
        """How the forces on the nodes change with their places (3 (N + 1), 3 (N + 1)), with the sign of a stiffness."""
        pressing, points = self._contact.touch.pressing, self._contact.touch.points
        many = self.pressing
        first, second = pressing.first[0, :many], pressing.second[0, :many]
        n, g = pressing.n[0, :many], pressing.g[0, :many]
        nodes = len(self._still[0])
        place, along = (_shares(points.first, shares, nodes) for shares in (points.weights, points.slopes))
        apart = place[first] - place[second]
        own = n[:, :, None] * g[:, None, :] + pressing.pull[0, :many, None, None] * np.eye(3)
        normal = n[:, :, None] * n[:, None, :]
        force = _blocks(own) @ kron(apart, np.eye(3))
        for k, side in ((0, first), (1, second)):
            force = force + _blocks(pressing.k[0, :many, k, None, None] * normal) @ kron(along[side], np.eye(3))
        return csr_array(-kron(apart, np.eye(3)).T @ force)

    def compile(self) -> None:
        """Have every kernel compiled that contact needs."""
        touch, r = self._contact.touch, self._still[0]
        self._contact.compile()
        press(touch, touch.pressing, self._still, self._still)
        move_points(touch, touch.pairs.members, r, r)
        allowed_fraction(touch, touch.pressing, 0)
        self._contact.prepare(inf, r, r, 1.0, anew=True)
        self._contact.refusal(inf, lambda: (r, r))

    def keep(self, r: Array) -> None:
        """Enter that a step has brought the nodes to r, with the forces that `push` was asked for last: the energy that
        contact stores is the work done against it, by the mean of the forces before and after."""
        push = self._contact.touch.push[0] if self._contact.touching else self._still[0]
        before, pushed = self._kept
        self.energy -= 0.5 * float(np.sum((push + pushed) * (r - before)))
        self._kept = r.copy(), push.copy()


def _shares(first: Array, shares: Array, nodes: int) -> csr_array:
    """Shares (M, 4) of four nodes each, from the `first` on, as a matrix (M, nodes)."""
    rows = np.repeat(np.arange(len(first)), REACH)
    columns = (first[:, None] + np.arange(REACH)).ravel()
    return csr_array((shares.ravel(), (rows, columns)), shape=(len(first), nodes))


def _blocks(blocks: Array) -> csr_array:
    """Blocks (K, 3, 3) along the diagonal."""
    return csr_array(bsr_array((blocks, np.arange(len(blocks)), np.arange(len(blocks) + 1))))
