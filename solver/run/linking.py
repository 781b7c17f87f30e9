"""The linking number of a rod: the relative rotation of its ends, from Tw + Wr at the start on."""

from __future__ import annotations

from math import pi


class LinkingNumber:
    """Lk of an open rod, as its frames are looked at one after the other.

    Of a rod that lies in a plane at the start it is counted from one side of it: which one shows where the rod leaves
    the plane, for if its ends' rays cross there, Wr, of which the plane has the mean, jumps by one turn.
    """

    def __init__(self) -> None:
        self._start, self._begun, self._plane = 0.0, False, False

    def of(self, turned: float, Tw: float, Wr: float) -> float:
        """In turns, `turned` (rad) being the rotation of the end relative to that of the start since the start."""
        if not self._begun:
            self._start, self._begun, self._plane = Tw + Wr, True, Wr == 0.0
        Lk = self._start + turned / (2 * pi)
        if self._plane and Wr != 0.0:
            self._plane, jump = False, float(round(Tw + Wr - Lk))
            self._start += jump
            Lk += jump
        return Lk
