"""A question to every part of a scene: does it keep a motion about one axis?

The axis is a principal axis of the section, a_p, and stands still: n in the lab. Where it lies across the tangent the
rod stays in a plane, and the scene is its own mirror image in that plane; where it is the tangent the rod stays
straight, and the scene is its own image when turned about it by half a turn. What starts as its own image, and is given
nothing that is not, remains it. So each part answers for itself, for all times (`keeps`), and what does not answer, or
is in doubt, does not keep it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from solver.arrays import Array
from solver.scene.curve import Vector, corners_of

NONE = 1e-10
"""Angle (rad) to the plane, or to the axis, that counts as none: what Newton's iteration leaves of a rotation."""


@dataclass(frozen=True)
class View:
    """The rod as it lies at t = 0, seen along its principal axis a_p, p = `index`.

    At arclengths `s` (m,): `quaternion` (m, 4), `kappa` (m, 3); `R` (3, 3): the rotation of the start. `n` (3,): the
    axis in the lab.
    """

    index: int
    s: Array
    quaternion: Array
    kappa: Array
    R: Array

    @property
    def n(self) -> Array:
        """The axis in the lab."""
        return np.asarray(self.R[:, self.index])

    @property
    def turns(self) -> NDArray[np.bool_]:
        """The material axes about which the rod may turn."""
        return np.asarray(np.arange(3) == self.index)

    @property
    def moves(self) -> NDArray[np.bool_]:
        """The material axes along which the rod may move."""
        return self.turns if self.index == 2 else np.asarray(~self.turns)

    def along(self, profiles: Sequence[Callable[[Array], Array]]) -> Array:
        """Values (m, 3) along the rod, also at four points of each piece between corners: see `at_all_times`."""
        s = np.union1d(self.s, within_pieces(corners_of(*profiles)))
        return np.stack([profile(s) for profile in profiles], axis=1)

    def moved_by(self, vectors: object, frame: str = "lab") -> bool:
        """Whether velocities or forces (..., 3) in a frame have none but the components along which it moves."""
        return self._none_but(self.moves, vectors, frame)

    def turned_by(self, vectors: object, frame: str = "lab") -> bool:
        """Whether angular velocities or moments (..., 3) in a frame have none but that about which it turns."""
        return self._none_but(self.turns, vectors, frame)

    def _none_but(self, allowed: NDArray[np.bool_], vectors: object, frame: str) -> bool:
        material = np.atleast_2d(np.asarray(vectors, dtype=float)) @ (self.R if frame == "lab" else np.eye(3))
        return bool(np.abs(material[:, ~allowed]).max() <= NONE * np.abs(material).max())


def at_all_times(curves: Vector) -> Array:
    """Values (m, 3) of three curves at four points of each piece: a cubic that is zero there is zero."""
    times = within_pieces([0.0, *corners_of(*curves)])
    return np.stack([curve(times) for curve in curves], axis=1)


def within_pieces(corners: Sequence[float]) -> Array:
    """The corners, and two points between each and the next."""
    knots = np.unique(np.array(corners, dtype=float))
    return np.concatenate([knots, *(knots[:-1] + part * np.diff(knots) for part in (1 / 3, 2 / 3))])


def answer(part: object, view: View) -> bool:
    """Whether a part of a scene keeps the motion about an axis.

    What is absent does, as numbers and words do, which have no direction; every other part is asked, and one that does
    not answer does not.
    """
    if part is None or isinstance(part, (bool, int, float, str)):
        return True
    if hasattr(part, "keeps"):
        return bool(part.keeps(view))
    if isinstance(part, tuple) and all(hasattr(each, "keeps") for each in part):
        return all(each.keeps(view) for each in part)
    return False
