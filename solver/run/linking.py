"""The linking number of a rod: Tw + Wr at the start, and what its ends have done since then."""

from __future__ import annotations

from math import pi

import numpy as np

from solver.arrays import Array
from solver.measures.holonomy import swept


class LinkingNumber:
    """Lk of an open rod: by how much its end has turned more than its start about their tangents, and what these have
    swept as they moved, both in turns.

    Of a rod that lies in a plane at the start it is counted from one side of it: which one shows where the rod leaves
    the plane, for if its ends' rays cross there, Wr, of which the plane has the mean, jumps by one turn.
    """

    def __init__(self) -> None:
        self._start, self._begun, self._plane = 0.0, False, False
        self._swept, self._turned, self._ends = 0.0, 0.0, np.zeros((2, 4))
        """Until the last step's end: turns, and rotation (rad) and orientations then."""

    def follow(self, turned: float, orientation: Array) -> None:
        """After each step of a rod whose ends' tangents may move: rotation (rad) of the end relative to that of the
        start since t = 0, and quaternions of which the first and the last are the ends'."""
        if self._begun:
            self._swept += swept(self._ends, orientation, turned - self._turned)
        self._turned, self._ends[0], self._ends[1] = turned, orientation[0], orientation[-1]

    def of(self, turned: float, Tw: float, Wr: float, swept_since: float = 0.0) -> float:
        """In turns, `turned` (rad) being the rotation of the end relative to that of the start since t = 0;
        `swept_since` (turns): what the tangents have swept since the end of the last step."""
        moved = turned / (2 * pi) + self._swept + swept_since
        if not self._begun:
            self._start, self._begun, self._plane = Tw + Wr - moved, True, Wr == 0.0
        Lk = self._start + moved
        if self._plane and Wr != 0.0:
            self._plane, jump = False, float(round(Tw + Wr - Lk))
            self._start += jump
            Lk += jump
        return Lk

    def swept_since(self, turned: float, orientation: Array) -> float:
        """What the tangents have swept (turns) from the last step's end to, or back to, another time."""
        return float(swept(self._ends, orientation, turned - self._turned))
