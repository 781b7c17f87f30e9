"""What is seen from frame to frame of a run that touches or passes through itself."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise

import numpy as np

from solver.arrays import Array
from solver.kernels.rotation import rotate
from solver.measures.frame import Fields, Frame
from solver.measures.passages import Shape, passages
from solver.run.remarks import Remarks

JUMP = 1.0
"""Turns by which Tw + Wr - Lk may change between frames without anything having passed through: half of a jump."""
EVERY = 10
"""Steps after which a shape between two frames may be kept."""
FAR = 0.02
"""In rod lengths: how far a node has moved since the last shape that was kept, when another one is."""
MOST = 200
"""Shapes that are kept; of more, every second one."""


class Watch:
    """Enters what it sees in `remarks`: at frames only, so that what is undone before the next one is not seen.

    Where strands are held apart it also keeps shapes between frames, to tell which way the rod went.
    """

    def __init__(self, remarks: Remarks, holds: bool) -> None:
        """`holds`: the scene has contact."""
        self._remarks, self._holds = remarks, holds
        self._turns = 0.0
        self._steps = 0
        self._r: list[Array] = []
        self._tangents: list[Array] = []

    def follow(self, fields: Callable[[], Fields]) -> None:
        """After each step: keep the shape, if it is another one than the last that was kept."""
        self._steps += 1
        if not self._holds or self._steps % EVERY or not self._r:
            return
        now, last = fields(), self._r[-1]
        length = float(np.sqrt(((last[1:] - last[:-1]) ** 2).sum(axis=1)).sum())
        if np.abs(now.r - last).max() > FAR * length:
            self._keep(now)
            if len(self._r) > MOST:
                self._r, self._tangents = self._r[::2], self._tangents[::2]

    def see(self, frame: Frame) -> str:
        """Enter the next frame. Why the run must end, or nothing."""
        self._see_overlap(frame)
        turns, before = frame.Tw + frame.Wr - frame.Lk, self._turns
        self._turns = turns
        self._keep(frame)
        shapes = [Shape(*one) for one in zip(self._r, self._tangents, strict=True)]
        self._r, self._tangents = self._r[-1:], self._tangents[-1:]
        if len(shapes) < 2 or not abs(turns - before) > JUMP:
            return ""
        seen = np.sum([passages(*two) for two in pairwise(shapes)], axis=0)
        if self._holds and round(0.5 * (turns - before)) != seen[1]:  # not all of it is hops
            return "Tw + Wr - Lk jumped"
        crossings, hops = 0 if self._holds else abs(int(seen[0])), abs(int(seen[1]))
        if crossings and not self._remarks.crossings:
            self._remarks.first_crossing = frame.t
        self._remarks.crossings += crossings
        self._remarks.end_hops += hops
        return ""

    def _keep(self, now: Fields) -> None:
        self._r.append(now.r)
        self._tangents.append(rotate(now.orientation[[0, -1]], np.array([[0.0, 0.0, 1.0]] * 2)))

    def _see_overlap(self, frame: Frame) -> None:
        if -frame.min_gap > self._remarks.deepest_overlap:  # NaN is not
            self._remarks.deepest_overlap, self._remarks.deepest_overlap_at = -frame.min_gap, frame.t
