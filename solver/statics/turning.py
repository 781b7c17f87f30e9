"""How an end lies that is driven to turn about axes of its own, as a function of time.

About one of them it is turned by the rotation itself. About several at once rotations do not add up: R' = R [omega]x
is integrated, in steps of at most FINE by exp of the fourth order (Magnus; Iserles et al. 2000, Acta Numerica 9, 215),

    Omega = a + b + 2/3 a x b,

a and b being the rotations about the axes in both halves of a step.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from math import ceil

import numpy as np

from solver.arrays import Array
from solver.kernels.rotation import turn
from solver.physics.ends import travel
from solver.scene.ends import Condition

FINE = 0.02
"""Rotation (rad) in a step: what the ends turn by is within 1e-10 rad then."""
LEAST, LOOKED_AT = 8, 64
"""Steps between two corners, at the least; and parts of these in which the rotation's way is measured."""


class Turning:
    """The orientation of an end whose rotation about each of its axes is held, or free (then it counts as none)."""

    def __init__(self, home: Array, conditions: Sequence[Condition], until: float) -> None:
        """`home` (4,): at t = 0; `conditions`: of the three rotations; `until` (s): end of the schedules."""
        self._conditions, self._times, self._quaternions = conditions, np.zeros(1), home[None]
        moving = [c for c in conditions if c.kind != "load" and not c.curve.is_zero]
        if len(moving) < 2:
            return
        corners = sorted({0.0, until, *(x for c in moving for x in c.curve.corners if 0.0 < x < until)})
        spans = [self._steps(start, end) for start, end in pairwise(corners)]
        self._times = np.concatenate([*(times[:-1] for times in spans), [until]])
        orientations = [home]
        for start, end in pairwise(self._times):
            orientations.append(self._turned(orientations[-1], start, end))
        self._quaternions = np.array(orientations)

    def at(self, t: float) -> Array:
        """The quaternion (4,) at time t (s)."""
        if len(self._times) == 1:
            turned = np.empty(4)
            turn(self._quaternions[0], self._rotations(t), turned)
            return turned
        last = max(int(np.searchsorted(self._times, t, side="right")) - 1, 0)
        return self._turned(self._quaternions[last], float(self._times[last]), t)

    def _turned(self, quaternion: Array, start: float, end: float) -> Array:
        first, middle, last = (self._rotations(t) for t in (start, 0.5 * (start + end), end))
        a, b, turned = middle - first, last - middle, np.empty(4)
        turn(quaternion, a + b + 2.0 / 3.0 * np.cross(a, b), turned)
        return turned

    def _rotations(self, t: float) -> Array:
        """About each axis (3,), rad."""
        return np.array([travel(c, t) if c.kind != "load" else 0.0 for c in self._conditions])

    def _steps(self, start: float, end: float) -> Array:
        """Times of steps between two corners, short enough."""
        looked_at = np.array([self._rotations(t) for t in np.linspace(start, end, LOOKED_AT + 1)])
        fastest = LOOKED_AT * float(np.linalg.norm(np.diff(looked_at, axis=0), axis=1).max())
        return np.linspace(start, end, max(LEAST, ceil(fastest / FINE)) + 1)
