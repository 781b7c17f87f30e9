"""Whether a straight or a plane rod would stay so, if it were disturbed."""

from __future__ import annotations

from solver.arrays import Array
from solver.measures.buckling import MUCH, Disturbance, Transverse
from solver.measures.frame import Frame
from solver.scene.scene import Scene

INTERVAL = 0.04
"""Part of the time so far that passes between two frames that are looked at."""


class Stability:
    """How much a small disturbance across the rod would have grown, at the frames of a run to a tolerance.

    Its state depends on all that the ends will do, as the state of a run with given steps must not, from which other
    runs begin. A static analysis counts its negative modes instead.
    """

    def __init__(self, scene: Scene) -> None:
        self._transverse, self._t = None if scene.at_rest else Transverse.of(scene), 0.0
        self._disturbance = Disturbance(self._transverse, scene.damping_rate)

    def growth_until(self, s: Array, frame: Frame) -> float:
        """The logarithm of the growth until the next frame, whose nodes are at `s` (n,), m; 0 if it is not MUCH."""
        if self._transverse is not None and frame.t - self._t >= INTERVAL * frame.t > 0.0:
            self._disturbance.go_on(frame.t - self._t, self._transverse.stiffness(s, frame))
            self._t = frame.t
        return self._disturbance.growth if self._disturbance.growth > MUCH else 0.0
