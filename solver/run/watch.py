"""What is seen of a run whose rod touches or passes through itself."""

from __future__ import annotations

from math import isnan

from solver.arrays import Array
from solver.measures.frame import Frame
from solver.measures.passages import QUIET, Passages, Shape, joined, passages, shape_of
from solver.measures.topology import share_of_rays
from solver.run.remarks import Remarks

JUMP = 1.5
"""Turns by which Tw + Wr - Lk may change between frames without anything having passed through, which makes 2. Where a
rod leaves a plane in which its ends' rays cross it changes by 1."""


class Watch:
    """Enters what it sees in `remarks`: crossings and overlaps at frames only, so that what is undone before the next
    one is not seen.

    Where strands are held apart it looks at the rays of the ends after every step: what jumps there is a hop over an
    end, and what is left of the jumps of Tw + Wr - Lk is a crossing.
    """

    def __init__(self, remarks: Remarks, holds: bool, ring: bool = False) -> None:
        """`holds`: the scene has contact; `ring`: see `measures.ring`."""
        self._remarks, self._holds, self._ring = remarks, holds, ring
        self._turns, self._share = 0.0, 0.0
        self._hops, self._hopped = 0, False
        """Over an end since the last frame, with signs; and whether there were any."""
        self._last: tuple[Array, ...] = ()
        """The parts of the last shape, if there is one."""

    def follow(self, shape: Shape) -> None:
        """After each step of a rod whose strands are held apart."""
        shape = joined(shape) if self._ring else shape
        share = share_of_rays(*shape)
        if self._last and abs(share - self._share) > QUIET:
            hops = passages(Shape(*self._last), shape).hops
            self._hops, self._hopped = self._hops + hops, self._hopped or hops != 0
        self._share = share
        self._keep(shape)

    def see(self, frame: Frame) -> str:
        """Enter the next frame. Why the run must end, or nothing."""
        if -frame.min_gap > self._remarks.deepest_overlap:  # NaN is not
            self._remarks.deepest_overlap, self._remarks.deepest_overlap_at = -frame.min_gap, frame.t
        if not self._holds and isnan(frame.Wr):
            return ""
        shape, turns = joined(shape_of(frame)) if self._ring else shape_of(frame), frame.Tw + frame.Wr - frame.Lk
        jump = turns - self._turns
        self._turns = turns
        if self._holds:
            self.follow(shape)
            hops, hopped, self._hops, self._hopped = self._hops, self._hopped, 0, False
            self._remarks.end_hops += abs(hops)
            left = jump - 2.0 * hops
            if hopped:  # as where the ends of a ring nearly meet: a step's way past them is not straight
                self._remarks.unclear_jumps += abs(round(0.5 * left))
                return ""
            return "Tw + Wr - Lk jumped" if abs(left) > JUMP else ""
        if self._last and abs(jump) > JUMP:
            self._enter(round(0.5 * jump), passages(Shape(*self._last), shape), frame.t)
        self._keep(shape)
        return ""

    def _keep(self, shape: Shape) -> None:
        if not self._last:
            self._last = shape.r.copy(), shape.tangents.copy()
        for old, new in zip(self._last, shape, strict=True):
            old[:] = new

    def _enter(self, jumps: int, seen: Passages, t: float) -> None:
        """Enter what is seen between the last frame and that at `t`, and what else must have been."""
        if seen.crossings and not self._remarks.crossings:
            self._remarks.first_crossing = t
        self._remarks.crossings += abs(seen.crossings)
        self._remarks.end_hops += abs(seen.hops)
        self._remarks.unclear_jumps += abs(jumps - seen.crossings - seen.hops)
