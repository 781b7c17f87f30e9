"""What the staggered method does alike in space and about one axis: what is given, and steps by Radau IIA."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator
from typing import Any

import numpy as np

from solver.arrays import Array
from solver.methods.space.segments.chain import STAGES, Chain, State
from solver.methods.space.segments.initial import chain_of, lay_out, loads_on_segments, segments_of
from solver.methods.status import CONVERGED
from solver.methods.time.radau import tableau
from solver.methods.time.radau.newton import LARGEST_ITERATIONS, TOLERANCE, Scheme
from solver.physics.elasticity import mean_bending
from solver.physics.ends import DrivenEnd
from solver.scene.scene import Scene

SCHEME = Scheme(
    tableau.C, tableau.INVERSE, tableau.TRANSFORM, tableau.BACK, tableau.GAMMA, tableau.LAMBDA, tableau.ERROR
)
NEWTON_PART = 1e-3
"""Of the tolerance of a step's error: what Newton's iteration may leave. (Nothing where steps are of fixed length.)"""
FEEDBACK = 0.5
"""Part of an end's lag behind its prescribed place that a step takes back."""
SMALL_MOTION = 1e-7
"""Rotation (rad) and displacement (rod lengths) in a step below which it is not shortened; or, if that is more, those
of which the tolerated part is what Newton's iteration leaves: no shorter step has a smaller error."""


class RadauMethod(ABC):
    """Steps of Radau IIA of order 5 in time, for a chain that a subclass describes."""

    increment_order = 4.0
    increment_tolerance = 0.01
    easy_iterations = 4
    shortest_step = 0.0

    def __init__(self, scene: Scene, axis: Any = None) -> None:
        N, length = scene.numerics.intervals, float(scene.rod.length)
        self.s = np.linspace(0.0, length, N + 1)
        self.applied = loads_on_segments(scene, self.s, STAGES, axis)
        self.start, self.end = DrivenEnd(scene.start), DrivenEnd(scene.end)
        tolerance = scene.numerics.increment_tolerance or self.increment_tolerance
        self._newton_part = NEWTON_PART * tolerance if tolerance < 1.0 else 0.0
        self._small_motion = max(SMALL_MOTION, TOLERANCE / tolerance)
        self._last_dt = 0.0
        self._powers = np.zeros((3, 3))

    def relative_increment(self, dt: float) -> float:
        """The embedded estimate of the trial's error relative to its motion, the larger of rotation and place."""
        turn_error, turned, move_error, moved = self._errors(dt)
        small = self._small_motion
        return max(turn_error / (turned + small), move_error / (moved + small * float(self.s[-1])))

    def strain(self) -> float:
        """None: segments are rigid."""
        return 0.0

    @abstractmethod
    def _solve(self, dt: float) -> tuple[int, int]:
        """Iterate on the stages from where they are; how it ended and the iterations."""

    @abstractmethod
    def _errors(self, dt: float) -> tuple[float, float, float, float]:
        """Of the trial: rotation (rad), error and motion; position (m) likewise."""

    def _lay_out(self, scene: Scene) -> tuple[Chain, State, Array]:
        """The chain in space, its state at t = 0, and by what its curvature differs from the centreline's."""
        chain = chain_of(scene.rod, segments_of(scene.rod, self.s), self.applied.entrained, self.s)
        self._unit = mean_bending(chain.elastic) / float(self.s[-1]) ** 2
        return chain, *lay_out(scene.initial, chain, self.s)

    def _solve_anew(self, dt: float, consistent: bool) -> tuple[int, int]:
        """As `_solve`; with `consistent` in two turns, if need be."""
        status, iterations = self._solve(dt)
        if consistent and iterations == LARGEST_ITERATIONS and status != CONVERGED:
            # an end that is let go turns at once, however short the step: go on from there, with new tangents
            status, more = self._solve(dt)
            iterations += more
        return status, iterations

    def _ends_at(self, t: float, tau: float, dt: float) -> Iterator[tuple[int, DrivenEnd, Array, Array]]:
        """What is given at both ends at t + tau of a step of dt: side, end, values (6,) and dead lab loads (6,)."""
        for side, (end, s) in enumerate(((self.start, 0.0), (self.end, float(self.s[-1])))):
            yield side, end, *self.applied.driving(end, s, t, tau, FEEDBACK / dt)
