"""What is seen of a rod that stays straight only because nothing pushes it aside."""

from __future__ import annotations

import numpy as np

from solver.arrays import Array
from solver.measures.buckling import MUCH, can_buckle, growth_rate
from solver.measures.frame import Frame
from solver.run.remarks import Remarks
from solver.scene.scene import Scene

STRAIGHT = 1e-6
"""Curvature, in 1/L, up to which a rod is straight."""


class Aside:
    """Enters in `remarks` how much a push aside would have grown at the frames so far."""

    def __init__(self, remarks: Remarks, scene: Scene) -> None:
        self._remarks, self._scene, self._asked = remarks, scene, can_buckle(scene)
        self._t, self._rate, self._grown = 0.0, 0.0, 0.0

    def see(self, s: Array, frame: Frame) -> None:
        """The next frame, whose nodes are at `s` (n,)."""
        if not self._asked:
            return
        bent = float(np.abs(frame.kappa[:, :2]).max()) * float(self._scene.rod.length) > STRAIGHT
        along = frame.f[:, 2], frame.q[:, 2], frame.kappa[:, 2]
        rate = 0.0 if bent else growth_rate(self._scene, s, *along)
        self._grown += 0.5 * (self._rate + rate) * (frame.t - self._t)
        self._t, self._rate = frame.t, rate
        if self._grown > MUCH:
            self._remarks.growth_aside = self._grown
