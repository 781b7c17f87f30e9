"""The staggered method about one axis as the simulation sees it: what it tells is of space, as everywhere."""

from __future__ import annotations

import numpy as np

from solver.arrays import Array
from solver.kernels.dispatch import enter
from solver.measures.energies import Energies
from solver.measures.frame import Fields
from solver.measures.passages import Shape, shape_of
from solver.methods.cost import ABOUT_AXIS
from solver.methods.linear import one_axis
from solver.methods.linear import stages as linear
from solver.methods.linear.one_axis import Factors
from solver.methods.space import stages as space
from solver.methods.space.one_axis import balances, motion, stages
from solver.methods.space.one_axis.axis import Axis, Plane, axis_of, directions
from solver.methods.space.one_axis.balances import Driven, Motion, Tangents
from solver.methods.space.one_axis.chain import Chain, Residuals, Stages, State, about_axis
from solver.methods.space.one_axis.energies import energies, stage_powers
from solver.methods.space.one_axis.fields import InSpace, Shown, place_nodes, show
from solver.methods.space.one_axis.motion import follow_segments, largest_turn
from solver.methods.time.radau.method import RadauMethod
from solver.physics.axial import axial_compliance
from solver.physics.ends import LOAD, DrivenEnd
from solver.scene.scene import Scene

for asked in (space, linear):
    enter(asked, (Chain, State, Driven, Factors, type(None)), motion, balances, stages, one_axis)


class OneAxisMethod(RadauMethod):
    """The rigid segments and the steps of `StaggeredMethod` for a scene that turns about `axis`: the same solution."""

    touches, cost = False, ABOUT_AXIS
    chain: Chain
    state: State
    stages: Stages
    driven: Driven

    def __init__(self, scene: Scene, axis: Axis) -> None:
        super().__init__(scene, axis)
        chain, state, offset = self._lay_out(scene)
        self._axis, self._offset = axis, offset[:, axis.index].copy()
        self._make_records(*about_axis(axis, chain, state), (Stages, Driven, Residuals, Tangents, Factors))
        self._in_space = InSpace.of(axis, state.base[0] - axis.in_lab(self.state.base[0]))
        self._moved = np.zeros((2, 3))
        """By how much start and end moved, z, and turned in the last step."""
        self._in_six = np.stack([axis.six_components(end.in_lab) for end in (self.start, self.end)])
        self._components = [[*axis.spanning["lab" if end.in_lab else "material"], 3 + axis.index]
                            for end in (self.start, self.end)]  # fmt: skip
        """Which of the ends' six conditions are not fulfilled by themselves."""
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

    def fields(self) -> Fields:
        """The state along the rod, at the nodes."""
        shown, nodes = Shown.empty(len(self.s)), self._nodes()
        show(self._hand_over(), self._shown[0], *nodes, self._offset, self._in_space, shown)
        fields = Fields(**shown._asdict(), strain=np.zeros(len(self.s)))
        self.unresolved_bending = self._layers.complete(fields, self._held, self._time - self._ago)
        return fields

    def centreline(self) -> Shape:
        """The state's centreline."""
        return shape_of(self.fields())

    def energies(self) -> Energies:
        """The energies of the state."""
        state, (r, V, A) = self._shown
        motion = Motion(r, V, A, self._tangents(), state.omega, self.chain.swing)
        return energies(self._hand_over(), state.phi, motion)

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
        r, V = np.empty((2, len(self.s)), complex)
        place_nodes(self._hand_over(), *self._shown, r, V)
        return r, V

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
        stage_powers(self._handed, weights, self._moved, self._powers)
        moved = (self._moved[:, :, None] * self._in_six).sum(axis=1)
        self.start.follow(moved[0])
        self.end.follow(moved[1])

    def _drive_end(self, side: int, end: DrivenEnd, values: Array, dead: Array) -> None:
        driven, axis = self.driven, self._axis
        driven.values[:, side] = values[:, self._components[side]]
        if self.applied.at_ends:
            driven.dead[:, side], driven.couple[:, side] = dead[:, :3] @ axis.lab, dead[:, 3:] @ axis.n

    def _condition_ends(self) -> None:
        """Write the kinds and directions of the ends' conditions."""
        axis, driven = self._axis, self.driven
        for side, end in enumerate((self.start, self.end)):
            components = self._components[side]
            driven.kinds[side] = end.kinds[components]
            driven.direction[side] = (axis.lab if end.in_lab else axis.material)[components[:2]]
            if axis.index == 2:  # nothing happens across the rod, whoever holds it there
                driven.kinds[side, 1], driven.direction[side, 1] = LOAD, 1j
