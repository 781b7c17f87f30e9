"""What is seen of a rod that stays straight, or in its plane, only because nothing pushes it aside."""

from __future__ import annotations

from solver.arrays import Array
from solver.measures.buckling import MUCH, Across, Push
from solver.measures.frame import Frame
from solver.scene.scene import Scene

SINCE = 0.04
"""Part of the time so far that passes between two looks."""


class Aside:
    """How much a push aside would have grown at the frames so far of a run to a tolerance.

    What it remembers depends on all that the ends will do, as the state of a run with given steps must not, with which
    others begin. A static analysis counts its modes instead.
    """

    def __init__(self, scene: Scene) -> None:
        self._across, self._t = None if scene.at_rest else Across.of(scene), 0.0
        self._push = Push(self._across, scene.damping)

    def see(self, s: Array, frame: Frame) -> float:
        """The next frame, whose nodes are at `s` (n,). The logarithm of the growth until then, 0 if it is not much."""
        if self._across is not None and frame.t - self._t >= SINCE * frame.t > 0.0:
            self._push.go_on(frame.t - self._t, self._across.stiffness(s, frame))
            self._t = frame.t
        return self._push.grown if self._push.grown > MUCH else 0.0
