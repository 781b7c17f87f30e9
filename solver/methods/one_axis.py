"""The staggered method about one axis as the simulation sees it: what it tells is of space, as everywhere."""

from __future__ import annotations

from math import inf, nan

import numpy as np

from solver.arrays import Array
from solver.kernels.handed import Handed
from solver.measures.energies import Energies
from solver.measures.frame import Fields
from solver.methods.space.one_axis.axis import Axis, Plane, directions
from solver.methods.space.one_axis.balances import Driven, Motion
from solver.methods.space.one_axis.chain import Chain, Stages, State, about_axis
from solver.methods.space.one_axis.energies import energies, stage_powers
from solver.methods.space.one_axis.motion import extrapolate, follow_segments, largest_turn
from solver.methods.space.segments.chain import STAGES
from solver.methods.time.radau import tableau
from solver.methods.time.radau.method import SCHEME, RadauMethod
from solver.methods.time.radau.newton import Scheme
from solver.methods.time.radau.one_axis import Work, estimate_error, step
from solver.physics.ends import LOAD, DrivenEnd
from solver.physics.loads.registry import LoadsAbout
from solver.scene.scene import Scene


class OneAxisMethod(RadauMethod):
    """The rigid segments and the steps of `StaggeredMethod` for a scene that turns about `axis`: the same solution."""

    def __init__(self, scene: Scene, axis: Axis) -> None:
        super().__init__(scene, axis)
        N = scene.numerics.intervals
        chain, state, offset = self._lay_out(scene)
        self._axis, self._offset = axis, offset[:, axis.index].copy()
        self.chain, self.state = about_axis(axis, chain, state)
        self._origin = state.base[0] - axis.in_lab(self.state.base[0])
        self.trial, self.stages, self.driven = State.empty(N), Stages.empty(N), Driven.empty()
        self.work = Work.empty(N)
        self._condition_ends()
        self._handed = Handed.over(*self._records)
        self._last = (np.zeros_like(self.stages.theta), np.zeros(3, complex), np.zeros_like(self.stages.F))
        self._centres = np.zeros((3, N), complex)
        follow_segments(self.chain, self._tangents(), self.state.omega, self.state.alpha, self.state.base,
                        *self._centres)  # fmt: skip

    def try_step(self, t: float, dt: float, consistent: bool = False) -> tuple[int, int]:
        """Try to go from t to t + dt; how it ended and the Newton iterations. With `consistent`, from rest."""
        self._drive(t, dt)
        if consistent:
            self.stages.theta[:], self.stages.shift[:], self.stages.F[:] = 0.0, 0.0, 0.0
        else:
            self._guess(dt)
        return self._solve_anew(dt, consistent)

    def refusal(self) -> str:
        """Nothing: there is no contact."""
        return ""

    def take_step(self, t: float, dt: float) -> Array:
        """Make the trial the state; return the energy (4,) in J that flowed in the step.

        From the ends, from the loads, dissipated, none into contact. By Radau's own quadrature, of order 5.
        """
        stages, weights = self.stages, tableau.A[2] * dt
        stage_powers(self._handed.reference, self._powers)
        swing = 0.5j * self.chain.h * self.chain.swing * stages.T[:, -2] * stages.omega[:, -2]
        for end, frame, V in ((self.start, 0, stages.base[:, 1]), (self.end, -1, stages.V[:, -1] + swing)):
            if end.in_lab:
                shift = self._axis.in_lab(weights @ V)
            else:
                shift = self._axis.in_material(weights @ (V / stages.T[:, frame]))
            end.follow(shift, self._axis.about(weights @ stages.omega[:, frame]))
        ended = (stages.phi, stages.omega, stages.alpha, stages.base, stages.F)
        for mine, series in zip((*self.trial, *self._centres), (*ended, stages.r, stages.V, stages.A), strict=True):
            mine[:] = series[-1]
        self.state, self.trial = self.trial, self.state
        self._last_dt = dt
        for kept, now in zip(self._last, (stages.theta, stages.shift, stages.F), strict=True):
            kept[:] = now
        return np.append(weights @ self._powers, 0.0)

    def switch_ends(self, t: float) -> None:
        """Put in force the end conditions that hold from t on."""
        (_, V), T = self._nodes(), self._tangents()
        for end, i in ((self.start, 0), (self.end, -1)):
            velocity = self._axis.in_lab(V[i]) if end.in_lab else self._axis.in_material(V[i] / T[i])
            end.switch(t, np.concatenate([velocity, self._axis.about(self.state.omega[i])]))
        self._condition_ends()
        self._last_dt = 0.0

    def turn(self) -> float:
        """The largest rotation (rad) of the trial within a joint."""
        return float(largest_turn(self.stages.phi[-1]))

    def step_limit(self) -> float:
        """None."""
        return inf

    def fields(self) -> Fields:
        """The state along the rod, at the nodes."""
        axis, (r, V) = self._axis, self._nodes()
        phi, omega = at_nodes(self.state.phi), at_nodes(self.state.omega)
        back = directions(-self.chain.swing * phi)
        bend, elastic = np.diff(self.state.phi) / self.chain.span, self.chain.elastic
        return Fields(
            v=axis.in_material(V * back), omega=axis.about(omega), f=axis.in_material(self.state.F * back),
            kappa=axis.about(bend - self._offset), q=axis.about(elastic.K * (bend - elastic.kappa0)),
            r=self._origin + axis.in_lab(r), orientation=axis.orientations(phi),
        )  # fmt: skip

    def energies(self) -> Energies:
        """The energies of the state."""
        r, V, A = self._centres
        motion = Motion(r, V, A, self._tangents(), self.state.omega, self.chain.swing)
        return energies(self.chain, self.applied.records, STAGES - 1, self.state.phi, motion)

    def twist(self) -> float:
        """Tw of the state, in turns."""
        turned = float(self.state.phi[-1] - self.state.phi[0])
        return (1.0 - self.chain.swing) * turned / (2 * np.pi)

    def smallest_gap(self) -> float:
        """NaN: there is no contact."""
        return nan

    def pressing(self) -> int:
        """None."""
        return 0

    def compile(self) -> None:
        """Have every kernel compiled that a run may need."""
        self._last_dt = 1.0
        self._guess(1.0)
        self.relative_increment(1.0)

    @property
    def _records(self) -> tuple[Chain, LoadsAbout, Driven, Scheme, Stages, Work]:
        """What the kernels of a step get by reference."""
        return self.chain, self.applied.records, self.driven, SCHEME, self.stages, self.work

    def _solve(self, dt: float) -> tuple[int, int]:
        """Iterate on the stages from where they are; how it ended and the iterations."""
        self._handed = self._handed.again(*self._records)
        status, iterations = step(self._handed.reference, dt, self._unit, self._newton_part, self.state)
        return int(status), int(iterations)

    def _errors(self, dt: float) -> tuple[float, float, float, float]:
        """Of the trial: rotation (rad), error and motion; position (m) likewise."""
        errors: tuple[float, float, float, float] = estimate_error(
            self._handed.reference, dt, self.state, self._centres
        )
        return errors

    def _tangents(self) -> Plane:
        """T (N + 2,) of the orientations."""
        return directions(self.chain.swing * self.state.phi)

    def _nodes(self) -> tuple[Plane, Plane]:
        """Places and velocities (N + 1,) of the nodes."""
        T, h = self._tangents()[1:-1], self.chain.h
        swing = 0.5j * h * self.chain.swing * self.state.omega[1:-1] * T
        r, V = self._centres[0] + 0.5 * h * T, self._centres[1] + swing
        return np.append(self.state.base[0], r), np.append(self.state.base[1], V)

    def _guess(self, dt: float) -> None:
        """The motion of the last step goes on; after a start, that of the state."""
        stages, state = self.stages, self.state
        if self._last_dt > 0.0:
            ratio = dt / self._last_dt
            weights = tableau.extrapolation(ratio)
            theta, shift, force = self._last
            departed = np.matmul(weights, theta, out=stages.theta_t)  # which is not known yet
            extrapolate(self.trial, state, self._last_dt, tableau.C, dt, departed, stages.theta)
            stages.shift[:] = weights @ shift - shift[2]
            np.matmul(tableau.quadratic_extrapolation(ratio), force, out=stages.F)
            return
        tau = tableau.C * dt
        stages.theta[:] = 0.5 * tau[:, None] ** 2 * state.alpha
        stages.shift[:] = tau * state.base[1] + 0.5 * tau**2 * state.base[2]
        stages.F[:] = state.F

    def _drive(self, t: float, dt: float) -> None:
        """Write what is given at the stages of a step."""
        driven, axis = self.driven, self._axis
        for i, c in enumerate(tableau.C):
            self.applied.set_time(t + c * dt, i)
            for side, end, values, dead in self._ends_at(t, c * dt, dt):
                driven.values[i, side] = values[self._components(end)]
                driven.dead[i, side], driven.couple[i, side] = dead[:3] @ axis.lab, dead[3:] @ axis.n

    def _components(self, end: DrivenEnd) -> list[int]:
        """Which of an end's six conditions are not fulfilled by themselves."""
        return [*self._axis.spanning["lab" if end.in_lab else "material"], 3 + self._axis.index]

    def _condition_ends(self) -> None:
        """Write the kinds and directions of the ends' conditions."""
        axis, driven = self._axis, self.driven
        for side, end in enumerate((self.start, self.end)):
            components = self._components(end)
            driven.kinds[side] = end.kinds[components]
            driven.direction[side] = (axis.lab if end.in_lab else axis.material)[components[:2]]
            if axis.index == 2:  # nothing happens across the rod, whoever holds it there
                driven.kinds[side, 1], driven.direction[side, 1] = LOAD, 1j


def at_nodes(x: Array) -> Array:
    """Values (N + 1,) at the nodes of what (N + 2,) belongs to orientations: means, and those of the ends."""
    return np.concatenate([x[:1], 0.5 * (x[1:-2] + x[2:-1]), x[-1:]])
