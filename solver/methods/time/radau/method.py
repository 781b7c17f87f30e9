"""Steps by Radau IIA of a chain of rigid segments of any kind: guess, trial, error, and the step that is taken."""

from __future__ import annotations

from abc import abstractmethod
from math import inf
from typing import Any

import numpy as np
from numpy.typing import NDArray

from solver.arrays import Array
from solver.kernels.handed import Reference
from solver.methods.linear.stages import Scheme
from solver.methods.method import NOTHING_AHEAD, Ahead, Method
from solver.methods.space.segments.chain import STAGES, Chain, State
from solver.methods.space.segments.initial import chain_of, lay_out, loads_on_segments, segments_of
from solver.methods.space.segments.layers import Layers
from solver.methods.space.stages import Record
from solver.methods.status import CONVERGED
from solver.methods.time.radau import tableau
from solver.methods.time.radau.newton import LARGEST_ITERATIONS, TOLERANCE, StepRecords, Work, estimate_error, step
from solver.methods.time.radau.next_step import Last, finish, go_on
from solver.physics.elasticity import mean_bending
from solver.physics.ends import RATE, DrivenEnd
from solver.physics.section import Beside
from solver.scene.scene import Scene

SCHEME = Scheme(
    tableau.C, tableau.INVERSE, tableau.TRANSFORM, tableau.BACK, tableau.GAMMA, tableau.LAMBDA, tableau.ERROR,
    tableau.TO_CUBIC, tableau.TO_PARABOLA,
)  # fmt: skip
NEWTON_PART = 1e-3
"""Of the tolerance of a step's error: what Newton's iteration may leave. (Nothing where steps are of fixed length.)"""
FEEDBACK = 0.5
"""Part of an end's lag behind its prescribed place that a step takes back."""


class RadauMethod(Method):
    """Steps of Radau IIA of order 5 in time, for a chain that a subclass describes; there is no contact."""

    increment_order = 4.0
    increment_tolerance = 0.01
    easy_iterations = 7
    chain: Record
    state: Record
    trial: Record
    stages: Record
    driven: Record

    def __init__(self, scene: Scene, axis: Any = None) -> None:
        N, length = scene.numerics.intervals, float(scene.rod.length)
        self.s = np.linspace(0.0, length, N + 1)
        section = segments_of(scene.rod, self.s)
        self.applied = loads_on_segments(scene, section, self.s, STAGES, axis)
        self.chain = chain_of(scene.rod, section, self.applied.entrained, self.s)
        self.start, self.end = DrivenEnd(scene.start), DrivenEnd(scene.end)
        self._layers = Layers.of(scene, self.s)
        tolerance = scene.numerics.increment_tolerance or self.increment_tolerance
        self._tolerance = min(tolerance, 1.0)
        self._newton_part = NEWTON_PART * min(tolerance, 1.0) if tolerance < inf else 0.0
        self._dt_max = scene.numerics.dt_max
        # no shorter step has an error below what Newton's iteration leaves
        self._small_motion = max(scene.numerics.small_motion, TOLERANCE / tolerance)
        self._time = self._last_dt = self._step = self._ago = 0.0
        self._powers = np.zeros((STAGES, 3))

    def try_step(self, t: float, dt: float, consistent: bool = False) -> tuple[int, int]:
        """Try to go from t to t + dt; how it ended and the Newton iterations.

        With `consistent`, from rest: an end that is set going at once gives forces that say nothing of what follows.
        """
        self._drive(t, dt)
        self._hand_over()
        if consistent:
            self._guess_rest()
        else:
            self._guess(dt)
        status, iterations = self._solve(dt, consistent)
        if consistent and iterations == LARGEST_ITERATIONS and status != CONVERGED:
            # an end that is let go turns at once, however short the step: go on from there, with new tangents
            status, more = self._solve(dt, consistent)
            iterations += more
        return status, iterations

    def relative_increment(self, dt: float) -> float:
        """The embedded estimate of the trial's error relative to its motion, the larger of rotation and place.

        What is too small to count in a step of dt_max does count in one that is far longer.
        """
        errors: tuple[float, ...] = estimate_error(self._handed, dt, self.state, self._centres)
        turn_error, turned, move_error, moved = errors
        if self.applied.strikes:
            places = np.concatenate([self._centres[:1], self.stages.r])
            move_error = max(move_error, self.applied.missed(places, self._borne, dt))
        small = self._small_motion * min((self._dt_max / dt) ** 2, 1.0)
        return max(turn_error / (turned + small), move_error / (moved + small * float(self.s[-1])))

    def take_step(self, t: float, dt: float) -> Array:
        """Make the trial the state; return the energy (4,) that flowed, by Radau's quadrature: see `Method`."""
        weights = tableau.A[-1] * dt
        self._follow_ends(weights)
        finish(self._handed, self.trial, self._centres, self._last)
        self.state, self.trial = self.trial, self.state
        self._time, self._last_dt, self._step, self._ago = t + dt, dt, dt, 0.0
        return self._flowed(weights)

    def look_back(self, ago: float) -> Ahead:
        """Show the rod within the last step: see `Method`. By the polynomials that are collocated, of order 3 as the
        estimate of the step's error is."""
        self._ago = ago
        if ago == 0.0:
            return NOTHING_AHEAD
        part = 1.0 - ago / self._step
        cubic, parabola, gained = tableau.within(part)
        self._interpolate(part, cubic, parabola)
        weights = self._step * gained
        return Ahead(self._flowed(weights), self._twisted(weights))

    def next_blow(self) -> float:
        """As the loads have it."""
        return self.applied.next_blow(self._centres, self._borne, self._tolerance) if self.applied.strikes else inf

    def compile(self) -> None:
        """Have every kernel compiled that a run may need, after its first step."""
        self.applied.compile()
        self._guess(1.0)
        self.relative_increment(1.0)
        self.look_back(0.5 * self._step)
        self.look_back(0.0)

    @abstractmethod
    def _drive_end(self, side: int, end: DrivenEnd, values: Array, dead: Array) -> None:
        """Write what is given at an end at the stages: `values` (3, 6) of its conditions, `dead` lab loads (3, 6)."""

    @abstractmethod
    def _follow_ends(self, weights: Array) -> None:
        """Tell the ends how they moved in a step, by the `weights` (3,) of its stages; write the power (W) of ends and
        loads, and what is dissipated, at the stages into `_powers`."""

    @abstractmethod
    def _interpolate(self, part: float, cubic: Array, parabola: Array) -> None:
        """Write what the rod was like after a part of the last step into `_within`, by the weights (3,) of the stages:
        of what begins with the step, and of forces, which may jump there."""

    @abstractmethod
    def _twisted(self, weights: Array) -> tuple[float, float]:
        """By how much start and end turn about a3 (rad), by the weights (3,) of the stages' rates."""

    @property
    def _shown(self) -> tuple[Record, NDArray[Any]]:
        """The state that is shown, and the places, velocities and accelerations of its segments' centres."""
        return (self._within, self._centres_within) if self._ago > 0.0 else (self.state, self._centres)

    def _flowed(self, weights: Array) -> Array:
        """The energy (4,) that flowed in a step."""
        flowed = np.zeros(4)
        flowed[:3] = weights @ self._powers
        return flowed

    @property
    def _held(self) -> list[NDArray[np.bool_]]:
        """Whether each end is held about a1 and a2."""
        return [end.kinds[3:5] == RATE for end in (self.start, self.end)]

    @property
    def _borne(self) -> Array:
        """The mass per length (N,) of the segments, with what they take along."""
        return np.asarray(self.chain.mass + self.applied.entrained)

    @property
    def _touch(self) -> Record:
        """What contact needs: nothing."""
        return None

    @property
    def _records(self) -> StepRecords:
        return StepRecords(self.chain, self.applied.records, self.driven, SCHEME, self.stages, self._touch, self.work)

    def _lay_out(self, scene: Scene) -> tuple[Chain, State, Array]:
        """The chain in space, its state at t = 0, and by what its curvature differs from the centreline's."""
        chain: Chain = self.chain
        self._unit = mean_bending(chain.elastic) / float(self.s[-1]) ** 2
        self.beside = Beside.steps(scene.rod, self.s, chain.elastic.K, chain.elastic.kappa0)
        return chain, *lay_out(scene, chain, self.s)

    def _make_records(self, chain: Record, state: Record, kinds: tuple[Any, ...], coupling: Record = None) -> None:
        """All that the steps of a chain write, from its state at t = 0 on; `kinds`: the classes of these records."""
        N, (stages, driven, residuals, tangents, factors) = len(self.s) - 1, kinds
        self.chain, self.state, self.trial = chain, state, type(state).empty(N)
        self.stages, self.driven = stages.empty(N), driven.empty(N)
        self.work = Work(
            residuals.empty(N), residuals.empty(N), tangents.empty(N), factors.empty(N, np.float64),
            factors.empty(N, np.complex128), coupling, np.zeros_like(self.stages.r[0]),
            factors.empty(N, np.float64).x, factors.empty(N, np.complex128).x,
        )  # fmt: skip
        self._handed = Reference.to(self._records)
        unknown = self.stages.theta, self.stages.shift, self.stages.F
        self._last = Last(*(np.zeros_like(series) for series in unknown))
        self._centres: NDArray[Any] = np.zeros_like(self.stages.r)
        """Positions, velocities and accelerations of the segments' centres, of the state."""
        self._within, self._centres_within = type(state).empty(N), np.zeros_like(self._centres)
        """The same within the last step, where somebody looks back."""

    def _drive(self, t: float, dt: float) -> None:
        """Write what is given at the stages of a step."""
        later = [float(c * dt) for c in tableau.C]
        self.applied.set_time(t, later)
        for side, (end, s) in enumerate(((self.start, 0.0), (self.end, float(self.s[-1])))):
            self._drive_end(side, end, *self.applied.driving(end, s, t, later, FEEDBACK / dt))

    def _guess(self, dt: float) -> None:
        """The motion of the last step goes on; after a start, that of the state."""
        stages, state = self.stages, self.state
        if self._last_dt > 0.0:
            go_on(self._handed, self._last, self.trial, state, self._last_dt, dt)
            return
        tau = tableau.C * dt
        stages.theta[:] = np.multiply.outer(0.5 * tau**2, state.alpha)
        stages.shift[:] = np.multiply.outer(tau, state.base[1]) + np.multiply.outer(0.5 * tau**2, state.base[2])
        stages.F[:] = state.F

    def _guess_rest(self) -> None:
        """Steady motion, and no forces."""
        self.stages.theta[:], self.stages.shift[:], self.stages.F[:] = 0.0, 0.0, 0.0

    def _hand_over(self) -> Reference:
        """The records, as they are now."""
        self._handed = self._handed.again(self._records)
        return self._handed

    def _solve(self, dt: float, consistent: bool) -> tuple[int, int]:
        """Iterate on the stages from where they are; how it ended and the iterations."""
        rough = self.applied.strikes and not consistent
        status, iterations = step(self._handed, dt, self._unit, self._newton_part, rough, self.state)
        self.applied.check()
        return int(status), int(iterations)
