"""Moves of the whole rod by which an equilibrium stays one: it turns about an axis, and about itself.

An arch between two pins may swing about their chord, and a round rod that nothing twists spin about its own axis: what
is near such a state is one of many, and an iteration ends at any of them. Of these the path goes on from the nearest to
where it was. Between clamps in one line a buckle turns about them, and each section about itself as much back. Whether
a turn changes nothing is asked of the tangent at an equilibrium, so that loads, ends and the rod's law need not be
asked.
"""

from __future__ import annotations

import numpy as np

from solver.arrays import Array
from solver.kernels.rotation import matrices_of, relative_rotations, rotation_of, turn
from solver.scene.layout import across
from solver.statics.equations import Equations
from solver.statics.point import BLOCK, FORCE, PSI, Point, X
from solver.statics.solvers import CoupledSolver, Solver
from solver.statics.stability import NEUTRAL

SAME = 1e-9
"""Least part of the largest move at which one is not made of the others, as a straight rod's turn about itself is."""
PASSES = 3
"""In which the nearest of the states is found: each leaves of a turn the square of the step, or less."""


class Neutral:
    """The turns by which an equilibrium stays one: `turns` (k, 4), each about the axes of the lab, through a pivot,
    and about the rod itself, of the point that was looked at last."""

    def __init__(self, equations: Equations) -> None:
        self._equations = equations
        self._clamps = [side for side, end in enumerate(equations.ends) if end.held[3:].all()]
        """Ends that hold the rod's rotation: what turns about the tangent there is turned back about itself."""
        self.turns = np.empty((0, 4))

    def look(self, solver: Solver | CoupledSolver) -> None:
        """Look at the equilibrium that `equations` has just linearised."""
        R = self._equations.stages.R[0]
        candidates = np.array([[*R[-self._clamps[0], :, 2], -1.0]]) if self._clamps else np.eye(4)
        self.turns = self._at_rest(candidates, solver.blocks)

    def _at_rest(self, candidates: Array, blocks: tuple[Array, Array, Array]) -> Array:
        """See `turns`: of those that are made of some candidates (k, 4), of unit mean square rotation of the sections,
        and at right angles to each other."""
        R = self._equations.stages.R[0]
        psi = np.stack([_rotations(about, R).ravel() for about in candidates])
        sizes, turns = np.linalg.eigh(psi @ psi.T / len(R))
        distinct = sizes > SAME * max(1.0, sizes[-1])
        if not distinct.any():
            return np.empty((0, 4))
        turns = turns[:, distinct].T @ candidates / np.sqrt(sizes[distinct])[:, None]
        changes = self._equations.changed_by(self._moves(turns), blocks).reshape(len(turns), -1)
        mixed, sizes, _ = np.linalg.svd(np.sqrt(len(R)) * changes, full_matrices=False)
        return np.asarray(mixed[:, sizes < NEUTRAL * self._equations.loading()].T @ turns)

    def nearest(self, point: Point, before: Point) -> Point:
        """Of all that turn into `point`, which was looked at last, the one that is nearest to another point."""
        away, R, pivot = np.empty((len(point.quaternion), 3)), np.empty((len(point.quaternion), 3, 3)), self._pivot()
        for _ in range(PASSES):
            matrices_of(point.quaternion, R)
            relative_rotations(before.quaternion, point.quaternion, away)
            parts = [np.sum(_rotations(about, R) * away) / len(away) for about in self.turns]
            point = _turned(point, -np.asarray(parts) @ self.turns, R, pivot)
        return point

    def without(self, z: Array) -> Array:
        """A displacement (N + 2, 9) of the point that was looked at last, less what only turns a buckle about the rod:
        next to nothing stands against it, and rounding makes it large."""
        if self._clamps:
            for move in self._moves(self.turns):
                z = z - np.sum(move[:, PSI] * z[:, PSI]) / np.sum(move[:, PSI] ** 2) * move
        return z

    def _pivot(self) -> Array:
        """A point (3,) that all turns leave where it is: where an end is held."""
        held = [end.pin for end in self._equations.ends if end.held[:3].any()]
        return held[0] if held else self._equations.stages.base[0, 0]

    def _moves(self, turns: Array) -> Array:
        """The displacements (k, N + 2, 9) of turns (k, 4)."""
        if not len(turns):
            return np.empty((0, 0, BLOCK))
        stages = self._equations.stages
        R, F = stages.R[0], stages.F[0]
        places = np.vstack([stages.base[0, 0], stages.r[0], self._equations.tip()]) - self._pivot()
        z = np.zeros((len(turns), len(R), BLOCK))
        for move, about in zip(z, turns, strict=True):
            move[:, PSI] = _rotations(about, R)
            move[:, X] = across(about[:3], places)
            move[1:, FORCE] = across(about[:3], F)
        return z


def _turned(point: Point, about: Array, R: Array, pivot: Array) -> Point:
    """A point, of whose sections R are the rotations, after a turn (4,) `about` a pivot."""
    z, quaternion = np.zeros((len(R), BLOCK)), np.empty(4)
    z[:, PSI] = _rotations(about, R)
    turned = point.moved(z, 0.0)
    turn(np.array([1.0, 0.0, 0.0, 0.0]), about[:3], quaternion)
    rotation = rotation_of(quaternion)
    turned.F[:], turned.base[:] = point.F @ rotation.T, pivot + rotation @ (point.base - pivot)
    return turned


def _rotations(about: Array, R: Array) -> Array:
    """The sections' own (N + 2, 3) in a turn (4,) of all of them."""
    return np.asarray(about[:3] @ R + about[3] * np.array([0.0, 0.0, 1.0]))
