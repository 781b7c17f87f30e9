"""The staggered method as the simulation sees it: a state, and steps that are tried and then taken."""

from __future__ import annotations

import numpy as np

from solver.arrays import Array
from solver.kernels.handed import Handed
from solver.kernels.rotation import matrix_of, rotate_back
from solver.measures.energies import Energies
from solver.measures.frame import Fields
from solver.methods.linear.segments_contact import place_nodes
from solver.methods.space.segments.balances import Driven, Motion
from solver.methods.space.segments.chain import STAGES, Chain, Stages, State
from solver.methods.space.segments.energies import energies, stage_powers, twist
from solver.methods.space.segments.joints import bend_joints, largest_turn, total_bending
from solver.methods.space.segments.motion import extrapolate, follow_segments, move, spin_steadily
from solver.methods.time.radau import tableau
from solver.methods.time.radau.method import SCHEME, RadauMethod
from solver.methods.time.radau.newton import Scheme, Work, estimate_error, finish, step
from solver.physics.contact.forces import Touch, keeps_apart
from solver.physics.contact.self_contact import SelfContact
from solver.physics.loads.registry import Loads
from solver.scene.scene import Scene


class StaggeredMethod(RadauMethod):
    """Rigid segments joined at the nodes; Radau IIA of order 5 in time."""

    def __init__(self, scene: Scene) -> None:
        super().__init__(scene)
        N = scene.numerics.intervals
        self.chain, self.state, self._offset = self._lay_out(scene)
        self.trial = State.empty(N)
        self.contact = SelfContact(scene.contact, scene.rod, self.s, stages=3)
        self.stages, self.driven = Stages.empty(N), Driven.empty(N)
        self.work = Work.empty(N, scene.contact is not None)
        self._handed = Handed.over(*self._records)
        self._last = (np.zeros_like(self.stages.theta), np.zeros((3, 3)), np.zeros_like(self.stages.F))
        self._joints = self._bend(self.state.quaternion)[0]
        R = np.zeros((N + 2, 3, 3))
        for quaternion, matrix in zip(self.state.quaternion, R, strict=True):
            matrix_of(quaternion, matrix)
        self._R, self._centres = R, np.zeros((3, N, 3))
        follow_segments(R, self.state.omega, self.state.alpha, self.state.base, self.chain.h, *self._centres)
        self._nodes = np.zeros((2, N + 1, 3))
        self._place_nodes(R, self.state.omega, self.state.base, self._centres)

    def try_step(self, t: float, dt: float, consistent: bool = False) -> tuple[int, int]:
        """Try to go from t to t + dt; how it ended and the Newton iterations.

        With `consistent`, from rest: an end that is set going at once gives forces that say nothing of what follows.
        """
        self._drive(t, dt)
        self.contact.prepare(total_bending(self._joints), self._nodes[0], self._nodes[1], dt)
        if consistent:
            self._guess_rest()
        else:
            self._guess(dt)
            if self.contact.touching and not self._guess_keeps_apart(dt):
                self._guess_standstill(dt)
        return self._solve_anew(dt, consistent)

    def turn(self) -> float:
        """The largest rotation (rad) of the trial within a joint."""
        return float(largest_turn(self._joints, self.stages.bend[2]))

    def refusal(self) -> str:
        """Why contact does not let the trial be trusted, or nothing."""
        if not self.contact.present:
            return ""
        return self.contact.refusal(total_bending(self.stages.bend[2]), self._trial_nodes)

    def _trial_nodes(self) -> tuple[Array, Array]:
        """Places and velocities (N + 1, 3) at the end of the trial, where the solve with contact has its own."""
        stages, r, V = self.stages, self.work.coupling.r[2], self.work.coupling.V[2]
        place_nodes(self.chain, stages.R[2], stages.omega[2], stages.base[2], stages.r[2], stages.V[2], r, V)
        return r, V

    def take_step(self, t: float, dt: float) -> Array:
        """Make the trial the state; return the energy (4,) in J that flowed in the step.

        From the ends, from the loads, dissipated, into contact. By Radau's own quadrature, of order 5.
        """
        stages, weights = self.stages, tableau.A[2] * dt
        ends = self._end_velocities()
        stage_powers(self._handed.reference, ends, self._powers)
        for side, (end, frame) in enumerate(((self.start, 0), (self.end, -1))):
            velocity = ends[:, side].copy()
            if not end.in_lab:
                velocity = rotate_back(stages.quaternion[:, frame].copy(), velocity)
            end.follow(weights @ velocity, weights @ stages.omega[:, frame])
        finish(self._handed.reference, self.trial)
        self.state, self.trial = self.trial, self.state
        self._R[:] = stages.R[2]
        self._joints[:] = stages.bend[2]
        for mine, last in zip(self._centres, (stages.r[2], stages.V[2], stages.A[2]), strict=True):
            mine[:] = last
        self._place_nodes(self._R, self.state.omega, self.state.base, self._centres)
        self._last_dt = dt
        for kept, now in zip(self._last, (stages.theta, stages.shift, stages.F), strict=True):
            kept[:] = now
        stored, rubbed = self.contact.power().T
        powers = np.column_stack([self._powers, stored])
        powers[:, 2] += rubbed
        return np.asarray(weights @ powers)

    def switch_ends(self, t: float) -> None:
        """Put in force the end conditions that hold from t on."""
        for end, frame, node in ((self.start, 0, 0), (self.end, -1, -1)):
            velocity = self._nodes[1, node]
            if not end.in_lab:
                velocity = rotate_back(self.state.quaternion[[frame]], velocity[None].copy())[0]
            end.switch(t, np.concatenate([velocity, self.state.omega[frame]]))
        self._last_dt = 0.0

    def step_limit(self) -> float:
        """The longest next step (s) that contact allows."""
        return self.contact.step_limit

    def fields(self) -> Fields:
        """The state along the rod, at the nodes."""
        orientation = orientations_at_nodes(self.state.quaternion)
        omega = self._R @ self.state.omega[:, :, None]
        between = 0.5 * (omega[1:-2] + omega[2:-1])
        omega_lab = np.concatenate([omega[:1], between, omega[-1:]])[:, :, 0]
        bend, q = self._bend(self.state.quaternion)
        return Fields(
            v=rotate_back(orientation, self._nodes[1]), omega=rotate_back(orientation, omega_lab),
            f=rotate_back(orientation, self.state.F), kappa=bend / self.chain.span[:, None] - self._offset, q=q,
            r=self._nodes[0].copy(), orientation=orientation,
        )  # fmt: skip

    def energies(self) -> Energies:
        """The energies of the state, but for contact."""
        r, V, A = self._centres
        return energies(self.chain, self.applied.records, STAGES - 1, self._joints,
                        Motion(r, V, A, self._R, self.state.omega))  # fmt: skip

    def twist(self) -> float:
        """Tw of the state, in turns."""
        return float(twist(self.state.quaternion) / (2 * np.pi))

    def smallest_gap(self) -> float:
        """Smallest surface-to-surface distance (m) of points more than the skip apart; NaN if contact is ruled out."""
        return self.contact.smallest_gap(total_bending(self._joints), self._nodes[0], self._nodes[1])

    def pressing(self) -> int:
        """Number of pairs of points that press on each other."""
        return self.contact.pressing

    def compile(self) -> None:
        """Have every kernel compiled that a run may need."""
        self.contact.compile()
        self._guess(1.0)
        if self.contact.present:
            self._guess_keeps_apart(1.0)
        self.relative_increment(1.0)

    @property
    def _records(self) -> tuple[Chain, Loads, Driven, Scheme, Stages, Touch, Work]:
        """What the kernels of a step get by reference."""
        return self.chain, self.applied.records, self.driven, SCHEME, self.stages, self.contact.touch, self.work

    def _solve(self, dt: float) -> tuple[int, int]:
        """Iterate on the stages from where they are; how it ended and the iterations."""
        self._handed = self._handed.again(*self._records)
        status, iterations = step(self._handed.reference, dt, self._unit, self._newton_part, self.state)
        self.applied.check()
        return int(status), int(iterations)

    def _errors(self, dt: float) -> tuple[float, float, float, float]:
        """Of the trial: rotation (rad), error and motion; position (m) likewise."""
        errors: tuple[float, float, float, float] = estimate_error(
            self._handed.reference, dt, self.state, self._centres
        )
        return errors

    def _place_nodes(self, R: Array, omega: Array, base: Array, centres: Array) -> None:
        place_nodes(self.chain, R, omega, base, centres[0], centres[1], self._nodes[0], self._nodes[1])

    def _bend(self, quaternion: Array) -> tuple[Array, Array]:
        """Rotation vectors of the joints and moments q, (N + 1, 3) each."""
        bend, q, left, right = (np.zeros((len(self.s), 3)) for _ in range(4))
        bend_joints(self.chain, quaternion, bend, q, left, right)
        return bend, q

    def _end_velocities(self) -> Array:
        """V (3, 2, 3) of the first and the last node at the stages, lab."""
        stages = self.stages
        omega, R = stages.omega[:, -2], stages.R[:, -2]
        swing = R[:, :, 0] * omega[:, 1:2] - R[:, :, 1] * omega[:, 0:1]
        return np.stack([stages.base[:, 1], stages.V[:, -1] + 0.5 * self.chain.h * swing], axis=1)

    def _guess(self, dt: float) -> None:
        """The motion of the last step goes on; after a start, that of the state."""
        stages, state = self.stages, self.state
        if self._last_dt > 0.0:
            ratio = dt / self._last_dt
            weights = tableau.extrapolation(ratio)
            theta, shift, force = self._last
            extrapolate(self.trial, theta, self._last_dt, state, tableau.C, weights, ratio, stages.theta)
            stages.shift[:] = weights @ shift - shift[2]
            np.matmul(tableau.quadratic_extrapolation(ratio), force.reshape(3, -1), out=stages.F.reshape(3, -1))
            return
        tau = (tableau.C * dt)[:, None, None]
        stages.theta[:] = 0.5 * tau**2 * state.alpha
        stages.shift[:] = tau[:, 0] * state.base[1] + 0.5 * tau[:, 0] ** 2 * state.base[2]
        stages.F[:] = state.F

    def _guess_rest(self) -> None:
        """Steady motion, and no forces."""
        self.stages.theta[:] = 0.0
        self.stages.shift[:] = 0.0
        self.stages.F[:] = 0.0

    def _guess_keeps_apart(self, dt: float) -> bool:
        """Whether the guess leaves parts that press on each other apart: where they rattle, the last step misleads."""
        spin_steadily(self.state, tableau.C, dt, self.stages)
        move(self.state, self.stages, tableau.INVERSE, dt, self.chain.h)
        return bool(keeps_apart(self.contact.touch, self._trial_nodes()[0]))

    def _guess_standstill(self, dt: float) -> None:
        """Nothing moves."""
        self.stages.theta[:] = -(tableau.C * dt)[:, None, None] * self.state.omega
        self.stages.shift[:] = 0.0
        self.stages.F[:] = self.state.F

    def _drive(self, t: float, dt: float) -> None:
        """Write what is given at the stages of a step."""
        driven = self.driven
        driven.push[:] = 0.0
        for i, c in enumerate(tableau.C):
            self.applied.set_time(t + c * dt, i)
            for side, end, values, dead in self._ends_at(t, c * dt, dt):
                driven.values[i, side], driven.dead[i, side] = values, dead
                driven.kinds[side] = end.kinds


def orientations_at_nodes(quaternion: Array) -> Array:
    """Orientations (N + 1, 4) at the nodes: half way between the segments, and those of the ends."""
    left, right = quaternion[1:-2], quaternion[2:-1]
    middle = left + np.sign(np.sum(left * right, axis=1))[:, None] * right
    middle /= np.linalg.norm(middle, axis=1)[:, None]
    return np.concatenate([quaternion[:1], middle, quaternion[-1:]])
