"""The staggered method as the simulation sees it: rigid segments in space, steps of Radau IIA, with contact."""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property
from math import inf

import numpy as np

from solver.arrays import Array
from solver.kernels.dispatch import enter
from solver.kernels.handed import Reference
from solver.kernels.rotation import matrices_of, rotate_back
from solver.measures.energies import Energies
from solver.measures.frame import Fields
from solver.measures.passages import Shape
from solver.methods.cost import IN_SPACE, STRETCHED
from solver.methods.linear import segments_contact, segments_increments, tridiagonal
from solver.methods.linear import stages as linear
from solver.methods.linear.segments import Factors
from solver.methods.linear.segments_contact import Coupling, place_nodes, show_last_stage
from solver.methods.space import stages as space
from solver.methods.space.segments import motion, stages
from solver.methods.space.segments.balances import Driven, Motion, Tangents, load_segments
from solver.methods.space.segments.chain import Chain, Residuals, Stages, State
from solver.methods.space.segments.energies import energies, stage_powers, stretch_of_ends, twist
from solver.methods.space.segments.fields import bending_at_nodes, motion_at_nodes
from solver.methods.space.segments.joints import bend_joints, largest_turn, total_bending
from solver.methods.space.segments.motion import Interpolation, follow_segments, look_back
from solver.methods.space.segments.opening import measure_openings, pull_joints, shift_segments
from solver.methods.space.segments.viscosity import resist_at_nodes
from solver.methods.status import CONVERGED
from solver.methods.time.radau import tableau
from solver.methods.time.radau.method import RadauMethod
from solver.methods.time.radau.next_step import move_guess
from solver.physics.axial import axial_compliance, stretch_of
from solver.physics.contact.forces import Touch, keeps_apart
from solver.physics.contact.recipe import foreseen
from solver.physics.contact.self_contact import SelfContact
from solver.physics.elasticity import can_stretch, without_stretch
from solver.physics.ends import DrivenEnd
from solver.scene.curve import Curve
from solver.scene.ends import Condition, End
from solver.scene.scene import Scene

SOON = 2.0**-14
"""In dt_max: steps that find the forces at the start."""
NONE = 1e-9
"""Part of the rod's length by which nothing is moved that is held."""

JERKED = 0.01
"""Strain at the start from which on what the ends begin to do is no part of it."""

for asked in (space, linear):
    enter(asked, (Chain, State, Driven, Factors, Touch), motion, stages, tridiagonal, segments_increments,
          segments_contact)  # fmt: skip


def _held_axes(end: End, R: Array) -> Array:
    """The directions (n, 3), lab, in which an end with the rotation R is held at the start."""
    held = [component[0].kind != "load" for component in end.translation]
    return (np.eye(3) if end.frame == "lab" else R.T)[held]


def _going_on(end: End) -> End:
    """An end whose motion goes on as it is at t = 0."""
    def rate(condition: Condition) -> float:
        return condition.curve.value(0.0) if condition.kind == "rate" else condition.curve.derivative(0.0)

    one, two, three, *turns = (
        component if component[0].kind == "load" else (Condition("rate", Curve.constant(rate(component[0]))),)
        for component in (*end.translation, *end.rotation)
    )  # fmt: skip
    return replace(end, translation=(one, two, three), rotation=(turns[0], turns[1], turns[2]))


def _forces_at_start(scene: Scene) -> Array | None:
    """F of the joints, see `State`, that the rod of a scene bears at t = 0; None where it cannot begin."""
    method, dt = StaggeredMethod(scene), SOON * scene.numerics.dt_max
    for t in (0.0, dt):  # at first an end that is set going at once gives other forces
        status, _ = method.try_step(t, dt, consistent=True)
        if status != CONVERGED:
            return None
        method.take_step(t, dt)
    return method.state.F


class StaggeredMethod(RadauMethod):
    """Rigid segments joined at the nodes; Radau IIA of order 5 in time."""

    touches = True
    chain: Chain
    state: State
    stages: Stages
    driven: Driven

    def __init__(self, scene: Scene) -> None:
        super().__init__(scene)
        N = scene.numerics.intervals
        chain, state, self._offset = self._lay_out(scene)
        self.contact = SelfContact(scene.contact, scene.rod, self.s, 3, foreseen(scene))
        self._make_records(chain, state, (Stages, Driven, Residuals, Tangents, Factors),
                           Coupling.empty(N if scene.contact is not None else 0))  # fmt: skip
        compliance = axial_compliance(scene)
        self.driven.compliance[:], self._ends_give = 0.5 * compliance, compliance > 0.0
        self.driven.mass[:] = scene.start.mass, scene.end.mass
        self._joints = self._bend(self.state.quaternion)[0]
        self._R = R = np.zeros((N + 2, 3, 3))
        matrices_of(self.state.quaternion, R)
        self.cost = STRETCHED if can_stretch(scene.rod) else IN_SPACE
        if can_stretch(scene.rod):
            self._stretch_at_start(scene)
        self._nodes, self._strain = np.zeros((2, N + 1, 3)), np.zeros(len(chain.elastic.compliance))
        self._place_all()
        if self._ends_give:
            self._bear_along()
        self._R_within = np.zeros_like(R)
        self._moved = np.zeros((2, 6))
        """By how much start and end moved and turned in the last step."""
        self._joints_within, self._nodes_within = np.zeros((N + 1, 3)), np.zeros((2, N + 1, 3))

    @classmethod
    def of(cls, scene: Scene) -> StaggeredMethod:
        """The method for a scene."""
        return cls(scene)

    def lay_at_rest(self, quaternion: Array, base: Array, F: Array) -> None:
        """Have the rod begin at rest elsewhere: orientations (N + 2, 4), the start's place (3,), forces (N + 1, 3)."""
        state = self.state
        for part in (state.omega, state.alpha, state.base, state.opening):
            part[:] = 0.0
        state.quaternion[:], state.base[0], state.F[:] = quaternion, base, F
        matrices_of(quaternion, self._R)
        self._joints = self._bend(quaternion)[0]
        measure_openings(self.chain, self._R, F, self._joints, state.opening[0])
        self._place_all()

    def _place_all(self) -> None:
        """Write centres and nodes of the state."""
        state = self.state
        follow_segments(self._R, state.omega, state.alpha, state.base, self.chain.h, *self._centres)
        shift_segments(self._R, state.omega, state.alpha, state.opening, *self._centres)
        self._place_nodes()

    def _stretch_at_start(self, scene: Scene) -> None:
        """Open the joints by the forces that the rod would bear at t = 0 if it could not stretch.

        Else its sound would ring from the start on, and the steps follow it. The given centreline is that of the rod
        without stretch: what is held stays there; else the centre of mass does, of rod and bodies. Where both ends are
        held so that the rod cannot become longer, it begins without stretch. An end that is jerked has to stretch it
        first.
        """
        state, e = self.state, np.zeros_like(self.state.opening[0])
        rigid = replace(scene, rod=without_stretch(scene.rod))
        for asked in (rigid, replace(rigid, start=_going_on(scene.start), end=_going_on(scene.end))):
            F = _forces_at_start(asked)
            if F is None:
                return
            measure_openings(self.chain, self._R, F, self._joints, e)
            if np.abs(e / self.chain.span).max() <= JERKED:
                break
        moved, still = np.zeros((3, len(self.s) - 1, 3)), np.zeros_like(state.omega)
        shift_segments(self._R, still, still, np.stack([e, 0.0 * e, 0.0 * e]), *moved)
        tip = moved[0, -1] + e[-1] * self._R[-2, :, 2]
        starts, ends = (_held_axes(end, R) for end, R in ((scene.start, self._R[0]), (scene.end, self._R[-1])))
        if len(starts) and len(ends) and np.abs(ends @ tip).max() > NONE * self.s[-1]:
            return
        if not len(starts):
            masses = [scene.start.mass, *(self.chain.h * self.chain.mass), scene.end.mass]
            away = np.vstack([0.0 * tip, moved[0], tip])
            back = -(tip if len(ends) else np.average(away, axis=0, weights=masses))
            spin = np.array(scene.initial.angular_velocity, dtype=float)
            state.base[:] += np.stack([back, np.cross(spin, back), np.cross(spin, np.cross(spin, back))])
        state.opening[0], state.F[:] = e, F

    def _bear_along(self) -> None:
        """Let the state's forces bear what loads the rod along itself at t = 0, half at either end.

        So its bar does at rest. Without them it would fall into its ends, and bounce on them.
        """
        stages, tangents = self.stages, self._R[:, :, 2]
        self.applied.set_time(0.0)
        stages.R[0], stages.omega[0] = self._R, self.state.omega
        stages.r[0], stages.V[0] = self._centres[:2]
        load_segments(self._handed)
        gained = np.sum(self.work.residuals.translation[0] * tangents[1:-1], axis=1)
        pull = np.append(0.0, np.cumsum(gained))
        between = np.concatenate([tangents[:1], 0.5 * (tangents[1:-2] + tangents[2:-1]), tangents[-1:]])
        self.state.F[:] = (pull - 0.5 * pull[-1])[:, None] * between

    def try_step(self, t: float, dt: float, consistent: bool = False) -> tuple[int, int]:
        """Try to go from t to t + dt: see `RadauMethod`. What may come into contact is looked for first."""
        self.driven.push[:] = 0.0
        self.contact.prepare(total_bending(self._joints), self._nodes[0], self._nodes[1], dt)
        return super().try_step(t, dt, consistent)

    def take_step(self, t: float, dt: float) -> Array:
        """Make the trial the state: see `RadauMethod`."""
        flowed = super().take_step(t, dt)
        show_last_stage(self._handed, self.state, self._centres, self._R, self._joints, self._nodes)
        return flowed

    def switch_ends(self, t: float) -> None:
        """Put in force the end conditions that hold from t on."""
        for end, i in ((self.start, 0), (self.end, -1)):
            velocity = self._nodes[1, i]
            if not end.in_lab:
                velocity = rotate_back(self.state.quaternion[[i]], velocity[None].copy())[0]
            end.switch(t, np.concatenate([velocity, self.state.omega[i]]))
        self._last_dt = 0.0

    def turn(self) -> float:
        """The largest rotation (rad) of the trial within a joint."""
        return float(largest_turn(self._joints, self.stages.bend[2]))

    def refusal(self) -> str:
        """Why contact does not let the trial be trusted, or nothing."""
        if not self.contact.present:
            return ""
        return self.contact.refusal(total_bending(self.stages.bend[2]), self._trial_nodes)

    def step_limit(self) -> float:
        """The longest next step (s) that contact and loads allow: where strands touch, it passes no frames."""
        by_contact = min(self.contact.step_limit, self._dt_max if self.contact.touching else inf)
        return min(by_contact, self.applied.longest_step(self._nodes[0], self._nodes[1]))

    @property
    def orientations(self) -> Array | None:
        """Of the ends and the segments."""
        return self.state.quaternion

    def fields(self) -> Fields:
        """The state along the rod, at the nodes."""
        (state, _), (R, _, nodes) = self._shown, self._shape
        orientation, shown = np.empty((len(self.s), 4)), np.empty((3, len(self.s), 3))
        motion_at_nodes(state.quaternion, R, state.omega, nodes[1], state.F, orientation, shown)
        joints = self._bend(state.quaternion)
        pull_joints(self.chain, R, state.F, *joints)
        viscous = len(self.chain.elastic.viscosity) > 0
        bend = joints[0].copy() if viscous else joints[0]
        bending_at_nodes(self.chain, *joints)
        kappa, q, *_ = joints
        if viscous:
            resist_at_nodes(self.chain, state.omega, bend, q)
        fields = Fields(
            v=shown[0], omega=shown[1], f=shown[2], kappa=kappa - self._offset, q=q,
            strain=state.opening[0] / self.chain.span,
            r=nodes[0].copy(), orientation=orientation,
        )  # fmt: skip
        self.unresolved_bending = self._layers.complete(fields, self._held, self._time - self._ago)
        return fields

    def centreline(self) -> Shape:
        """The state's centreline."""
        R, _, nodes = self._shape
        return Shape(nodes[0], R[[0, -1], :, 2])

    def energies(self) -> Energies:
        """The energies of the state, but for contact."""
        (state, (r, V, A)), (R, joints, _) = self._shown, self._shape
        return energies(self._hand_over(), joints, state.F, Motion(r, V, A, R, state.omega))

    def twist(self) -> float:
        """Tw of the state, in turns."""
        return float(twist(self._shown[0].quaternion) / (2 * np.pi))

    def smallest_gap(self) -> float:
        """Smallest surface-to-surface distance (m) of points more than the skip apart; NaN if contact is ruled out."""
        _, joints, nodes = self._shape
        return self.contact.smallest_gap(total_bending(joints), nodes[0])

    def pressing(self) -> int:
        """Number of pairs of points that press on each other."""
        return self.contact.pressing

    def contact_points_placed(self) -> int:
        """Number of points of self-contact that the last step looked at."""
        return self.contact.placed

    def compile(self) -> None:
        """Have every kernel compiled that a run may need, after its first step."""
        super().compile()
        self.contact.compile()
        measure_openings(self.chain, self._R, self.state.F, self._joints, np.zeros(0))
        load_segments(self._handed)
        if self.contact.present:
            self._guess_keeps_apart(1.0)

    @cached_property
    def _looking(self) -> Reference:
        """What `look_back` writes, for runs that do."""
        return Reference.to(Interpolation.into(self._within))

    @property
    def _touch(self) -> Touch:
        """What contact needs."""
        return self.contact.touch

    def _trial_nodes(self) -> tuple[Array, Array]:
        """Places and velocities (N + 1, 3) at the end of the trial, where the solve with contact has its own."""
        stages, r, V = self.stages, self.work.coupling.r[2], self.work.coupling.V[2]
        place_nodes(self.chain, stages.R[2], stages.omega[2], stages.base[2], stages.opening[2], stages.r[2],
                    stages.V[2], r, V)  # fmt: skip
        return r, V

    @property
    def _shape(self) -> tuple[Array, Array, Array]:
        """R (N + 2, 3, 3), the joints' rotation vectors (N + 1, 3), and the nodes' places and velocities (2, N + 1, 3)
        that are shown."""
        if self._ago > 0.0:
            return self._R_within, self._joints_within, self._nodes_within
        return self._R, self._joints, self._nodes

    def _interpolate(self, part: float, cubic: Array, parabola: Array) -> None:
        before, R, then, centres = self.trial, self._R_within, self._within, self._centres_within
        look_back(self._handed, self._looking, before, part, self._step, cubic, parabola, R, centres)
        if len(self._strain):
            then.opening[:] = before.opening + np.tensordot(cubic, self.stages.opening - before.opening, 1)
            shift_segments(R, then.omega, then.alpha, then.opening, *centres)
        self._joints_within[:] = self._bend(then.quaternion)[0]
        place_nodes(self.chain, R, then.omega, then.base, then.opening, centres[0], centres[1], *self._nodes_within)

    def _twisted(self, weights: Array) -> tuple[float, float]:
        start, end = weights @ self.stages.omega[:, [0, -1], 2]
        return float(start), float(end)

    def _place_nodes(self) -> None:
        """Write places and velocities of the nodes of the state."""
        state = self.state
        place_nodes(self.chain, self._R, state.omega, state.base, state.opening, *self._centres[:2], *self._nodes)

    def _bend(self, quaternion: Array) -> list[Array]:
        """What `bend_joints` writes, (N + 1, 3) each."""
        written = [np.zeros((len(self.s), 3)) for _ in range(4)]
        bend_joints(self.chain, quaternion, *written)
        return written

    def _follow_ends(self, weights: Array) -> None:
        stage_powers(self._handed, weights, self._moved, self._powers)
        self.start.follow(self._moved[0])
        self.end.follow(self._moved[1])

    def strain(self) -> float:
        """The trial's largest strain, see `stretch_of`; or by the compliance of its ends, in rod lengths."""
        if len(self._strain):
            np.divide(self.stages.opening[-1, 0], self.chain.span, out=self._strain)
            return stretch_of(self._strain)
        return stretch_of_ends(self._handed) / float(self.s[-1]) if self._ends_give else 0.0

    def _flowed(self, weights: Array) -> Array:
        flowed = super()._flowed(weights)
        if self.contact.touching:
            stored, rubbed = weights @ self.contact.power()
            flowed[2:] += rubbed, stored
        return flowed

    def _guess(self, dt: float) -> None:
        """The motion goes on, or nothing moves where that would close the gap of parts that press on each other."""
        super()._guess(dt)
        if self.contact.touching and not self._guess_keeps_apart(dt):
            self._guess_standstill(dt)

    def _guess_rest(self) -> None:
        """Steady motion, and no forces but those by which the rod is stretched: these do not jump."""
        super()._guess_rest()
        if len(self._strain):
            self.stages.F[:] = self.state.F

    def _guess_keeps_apart(self, dt: float) -> bool:
        """Whether the guess leaves parts that press on each other apart: where they rattle, the last step misleads."""
        move_guess(self._handed, dt, self.state)
        touch = self.contact.touch
        return bool(keeps_apart(touch.points, touch.pairs, self._trial_nodes()[0]))

    def _guess_standstill(self, dt: float) -> None:
        """Nothing moves."""
        self.stages.theta[:] = -(tableau.C * dt)[:, None, None] * self.state.omega
        self.stages.shift[:] = 0.0
        self.stages.F[:] = self.state.F

    def _drive_end(self, side: int, end: DrivenEnd, values: Array, dead: Array) -> None:
        self.driven.values[:, side], self.driven.kinds[side] = values, end.kinds
        if self.applied.at_ends:
            self.driven.dead[:, side] = dead
