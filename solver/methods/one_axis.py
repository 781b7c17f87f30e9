"""The staggered method about one axis as the simulation sees it: what it tells is of space, as everywhere."""

from __future__ import annotations

import numpy as np

from solver.arrays import Array
from solver.kernels.dispatch import enter
from solver.measures.energies import Energies
from solver.measures.frame import Fields
from solver.measures.passages import Shape, shape_of
from solver.methods.linear import one_axis
from solver.methods.linear import stages as linear
from solver.methods.linear.one_axis import Factors
from solver.methods.space import stages as space
from solver.methods.space.one_axis import balances, motion, stages
from solver.methods.space.one_axis.axis import Axis, Plane, axis_of, directions
from solver.methods.space.one_axis.balances import Driven, Motion, Tangents
from solver.methods.space.one_axis.chain import Chain, Residuals, Stages, State, about_axis
from solver.methods.space.one_axis.energies import energies, stage_powers
from solver.methods.space.one_axis.motion import bend_joints, extrapolate, follow_segments, largest_turn
from solver.methods.time.radau import tableau
from solver.methods.time.radau.method import RadauMethod
from solver.physics.axial import axial_compliance
from solver.physics.ends import LOAD, DrivenEnd
from solver.scene.scene import Scene

for asked in (space, linear):
    enter(asked, (Chain, State, Driven, Factors, type(None)), motion, balances, stages, one_axis)


class OneAxisMethod(RadauMethod):
    """The rigid segments and the steps of `StaggeredMethod` for a scene that turns about `axis`: the same solution."""

    touches = False
    chain: Chain
    state: State
    stages: Stages
    driven: Driven

    def __init__(self, scene: Scene, axis: Axis) -> None:
        super().__init__(scene, axis)
        chain, state, offset = self._lay_out(scene)
        self._axis, self._offset = axis, offset[:, axis.index].copy()
        self._make_records(*about_axis(axis, chain, state), (Stages, Driven, Residuals, Tangents, Factors))
        self._origin = state.base[0] - axis.in_lab(self.state.base[0])
        self._condition_ends()
        follow_segments(self.chain, self._tangents(), self.state.omega, self.state.alpha, self.state.base,
                        *self._centres)  # fmt: skip

    @classmethod
    def of(cls, scene: Scene) -> OneAxisMethod | None:
        """The method for a scene, if that turns about one axis."""
        axis = None if axial_compliance(scene) > 0.0 else axis_of(scene)
        return None if axis is None else cls(scene, axis)

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

    @property
    def orientations(self) -> Array | None:
        """None: see `Method`."""
        return None

    def fields(self) -> Fields:
        """The state along the rod, at the nodes."""
        axis, (r, V), (state, _) = self._axis, self._nodes(), self._shown
        phi, omega = at_nodes(state.phi), at_nodes(state.omega)
        back = directions(-self.chain.swing * phi)
        bend, q = np.diff(state.phi) / self.chain.span, np.empty(len(self.s))
        bend_joints(self.chain, state.phi, state.omega, q)
        return Fields(
            v=axis.in_material(V * back), omega=axis.about(omega), f=axis.in_material(state.F * back),
            kappa=axis.about(bend - self._offset), q=axis.about(q),
            strain=np.zeros(len(self.s)), r=self._origin + axis.in_lab(r), orientation=axis.orientations(phi),
        )  # fmt: skip

    def centreline(self) -> Shape:
        """The state's centreline."""
        return shape_of(self.fields())

    def energies(self) -> Energies:
        """The energies of the state."""
        state, (r, V, A) = self._shown
        motion = Motion(r, V, A, self._tangents(), state.omega, self.chain.swing)
        return energies(self._hand_over(), self.chain, state.phi, motion)

    def twist(self) -> float:
        """Tw of the state, in turns."""
        phi = self._shown[0].phi
        turned = float(phi[-1] - phi[0])
        return (1.0 - self.chain.swing) * turned / (2 * np.pi)

    def _tangents(self) -> Plane:
        """T (N + 2,) of the orientations."""
        return directions(self.chain.swing * self._shown[0].phi)

    def _nodes(self) -> tuple[Plane, Plane]:
        """Places and velocities (N + 1,) of the nodes."""
        (state, centres), T, h = self._shown, self._tangents()[1:-1], self.chain.h
        swing = 0.5j * h * self.chain.swing * state.omega[1:-1] * T
        r, V = centres[0] + 0.5 * h * T, centres[1] + swing
        return np.append(state.base[0], r), np.append(state.base[1], V)

    def _interpolate(self, part: float, cubic: Array, parabola: Array) -> None:
        before, stages, then = self.trial, self.stages, self._within
        then.phi[:] = before.phi + part * self._step * before.omega + cubic @ stages.theta
        then.omega[:] = before.omega + cubic @ stages.theta_t
        then.base[0] = before.base[0] + cubic @ stages.shift
        then.base[1] = before.base[1] + cubic @ (stages.base[:, 1] - before.base[1])
        then.F[:] = parabola @ stages.F
        T = directions(self.chain.swing * then.phi)
        follow_segments(self.chain, T, then.omega, then.alpha, then.base, *self._centres_within)

    def _twisted(self, weights: Array) -> tuple[float, float]:
        start, end = (float(self._axis.about(weights @ self.stages.omega[:, frame])[2]) for frame in (0, -1))
        return start, end

    def _follow_ends(self, weights: Array) -> None:
        stages, axis = self.stages, self._axis
        stage_powers(self._handed.reference, self._powers)
        swing = 0.5j * self.chain.h * self.chain.swing * stages.T[:, -2] * stages.omega[:, -2]
        for end, frame, V in ((self.start, 0, stages.base[:, 1]), (self.end, -1, stages.V[:, -1] + swing)):
            if end.in_lab:
                shift = axis.in_lab(weights @ V)
            else:
                shift = axis.in_material(weights @ (V / stages.T[:, frame]))
            end.follow(shift, axis.about(weights @ stages.omega[:, frame]))

    def _extrapolate(self, dt: float, weights: Array, theta: Array) -> None:
        departed = np.matmul(weights, theta, out=self.stages.theta_t)  # which is not known yet
        extrapolate(self.trial, self.state, self._last_dt, tableau.C, dt, departed, self.stages.theta)

    def _drive_end(self, side: int, end: DrivenEnd, values: Array, dead: Array) -> None:
        driven, axis = self.driven, self._axis
        driven.values[:, side] = values[:, self._components(end)]
        driven.dead[:, side], driven.couple[:, side] = dead[:, :3] @ axis.lab, dead[:, 3:] @ axis.n

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
