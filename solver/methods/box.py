"""The box method as the simulation sees it: a state, and steps that are tried and then taken."""

from __future__ import annotations

import numpy as np

from solver.arrays import Array
from solver.kernels.handed import Reference
from solver.kernels.rotation import relative_rotations, rotate_back, tangents_of
from solver.measures.energies import Energies
from solver.measures.frame import Fields
from solver.measures.passages import Shape
from solver.measures.topology import tangents_of_ends
from solver.methods.linear.registry import linear_solver_of
from solver.methods.method import Method
from solver.methods.schemes import BACKWARD_EULER, Scheme, c0_of
from solver.methods.space.box.energies import energies
from solver.methods.space.box.fields import KAPPA, OMEGA, F, State, V
from solver.methods.space.box.flows import Flows, enter_step
from solver.methods.space.box.nodes import moments
from solver.methods.space.box.schemes import SpaceScheme
from solver.methods.space.box.trial import Measured, mean_turning, measure_trial, total_bending
from solver.methods.time.generalized_alpha.guess import force_rate, guess, stretch_feedback
from solver.methods.time.generalized_alpha.history import rescale_aux
from solver.methods.time.generalized_alpha.newton import EndValues, Scales, StepRecords, Work, step
from solver.physics.cells import around_nodes
from solver.physics.contact.recipe import foreseen
from solver.physics.contact.self_contact import SelfContact
from solver.physics.elasticity import mean_bending, needs_segments, principal
from solver.physics.ends import DrivenEnd
from solver.physics.loads.applied import AppliedLoads
from solver.physics.section import Beside, Section, sample_over
from solver.scene.initial import Initial
from solver.scene.layout import nodes_at_rest
from solver.scene.scene import Scene

STRETCH_FEEDBACK, OF_WAVES = 1.0, 5.0
"""The rate at which the stretch is taken back, in that at which the tangents turn, and how often that of waves as short
as the rod is bent is added; the largest so far. It must not depend on the step, or the order in dt is lost, nor rise
and fall with the motion, or it turns the rod. See docs/decisions/0002."""
LARGEST_FEEDBACK = 0.5
"""Part of the stretch, and of an end's lag, that a step may take back at the most: more would be a jolt."""

LEFT_BEHIND = 0.05
"""Rotation (rad), or displacement in rod lengths, by which a step leaves an end behind, worth as much as a motion that
changes altogether within it."""
DIVISIBLE = 0.5
"""Of the time that twist takes to run along an interval: in less the mesh cannot follow an end, which it overshoots."""
SMALL_MOTION = 1e-6
"""In rod lengths a step: motion below it does not shorten the step."""


class BoxMethod(Method):
    """Generalized-alpha in time and in space on the unknowns V, omega, kappa, F at the nodes."""

    increment_order = 2.0
    increment_tolerance = 0.1
    easy_iterations = 4
    touches = True

    def __init__(self, scene: Scene) -> None:
        numerics = scene.numerics
        self.s = np.linspace(0.0, scene.rod.length, numerics.intervals + 1)
        self.h = float(scene.rod.length) / numerics.intervals
        self.section: Section = sample_over(scene.rod, around_nodes(self.s, scene.rod.corners))
        self.beside = Beside.steps(scene.rod, self.s, self.section.elastic.K)
        self.applied = AppliedLoads(scene, self.section, self.s)
        self.start, self.end = DrivenEnd(scene.start), DrivenEnd(scene.end)
        self.state, correction = _initial_state(scene.initial, self.s, self.section)
        self.section.elastic.kappa0[:] += correction
        self.contact = SelfContact(scene.contact, scene.rod, self.s, 1, foreseen(scene))
        self.trial = State.empty(len(self.s))
        self._scheme = Scheme.of(numerics.rho_inf)
        self._scales = Scales(float(scene.rod.length), mean_bending(self.section.elastic))
        self._measured = Measured(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
        self._bending = total_bending(self.state.Y, self.h)
        stiffness, mass = mean_bending(self.section.elastic), float(self.section.mass.mean())
        self._natural_rate = float(np.sqrt(stiffness / mass)) / float(scene.rod.length) ** 2
        self._gain = self._feedback_rate(mean_turning(self.state.Y))
        self._stretch, self._stretch_before, self._trial_stretch = np.zeros((3, numerics.intervals, 3))
        self.work = Work.empty(numerics.intervals, SpaceScheme.of(numerics.rho_inf_space), linear_solver_of(numerics),
                               scene.contact is not None)  # fmt: skip
        if numerics.rho_inf_space < 1.0:  # in shorter steps the scheme along s does not resolve the equations
            softest = principal(self.section.elastic)[:, 0]
            self.shortest_step = float(np.max(self.h**2 * np.sqrt(self.section.mass / softest)))
        self._last_dt, self._taken_dt, self._consistent, self._left_behind = 0.0, 0.0, False, 0.0
        twisting = np.sqrt(self.section.inertia[:, 2] / principal(self.section.elastic)[:, 2])
        self._divisible = DIVISIBLE * self.h * float(twisting.mean())
        """Step (s) that is not shortened for an end: what it does within it is made up for in those that follow."""
        self._F_rate = np.zeros((len(self.s), 3))
        self._flows, self._R = Flows.empty(len(self.s)), np.zeros((len(self.s), 3, 3))
        self._handed = Reference.to(self._records)

    @classmethod
    def of(cls, scene: Scene) -> BoxMethod:
        """The method for a scene. Raises ValueError for a rod with a law, or a body, that is not known here."""
        if scene.start.mass or scene.end.mass:
            raise ValueError('method must be "staggered" for a body at an end, got "box"')
        if needs_segments(scene.rod):
            raise ValueError(f'method must be "staggered" for a rod that {needs_segments(scene.rod)}, got "box"')
        return cls(scene)

    def try_step(self, t: float, dt: float, consistent: bool = False) -> tuple[int, int]:
        """Try to go from t to t + dt into `trial`; how it ended and the Newton iterations.

        With `consistent`, by backward Euler: dt is tiny, and what is wanted is accelerations and forces.
        """
        if not consistent and self._last_dt > 0.0 and dt != self._last_dt:
            rescale_aux(self.state, dt / self._last_dt)
        self._last_dt, self._consistent, self._left_behind = dt, consistent, 0.0
        ahead = dt / self._taken_dt if dt <= 2.0 * self._taken_dt else 0.0
        gain = min(self._gain, LARGEST_FEEDBACK / dt)
        self.applied.set_time(t + dt)
        follows = dt > self._divisible and not consistent
        stretch_feedback(self._stretch, self._stretch_before, ahead, gain, self.work.feedback)
        guess(self.state, self._F_rate, 0.0 if consistent else dt, self.trial.Y)
        self.contact.prepare(self._bending, self.state.r, self.state.Y, dt)
        status, iterations = step(self._hand_over(), self.state, self.trial, self._rule, dt, self.h,
                                  self._ends(t, dt, follows))  # fmt: skip
        self.applied.check()
        self._measured = measure_trial(self.state, self.trial, self.h, self._trial_stretch)
        return int(status), int(iterations)

    def take_step(self, t: float, dt: float) -> Array:
        """Make the trial the state; return the energy (4,) that flowed: see `Method`."""
        old, new = self.state, self.trial
        force_rate(old.Y, new.Y, dt, self._F_rate)
        # a step that finds forces knows none at its begin: there those of its end count
        late = 1.0 if self._consistent else 0.5
        enter_step(self._handed, old, new, self.contact.power()[0], c0_of(self._rule, dt), dt, late, self.h,
                   self._flows)  # fmt: skip
        for end, node in self._at_ends:
            end.follow(_along_axes(end, self._flows.moved[node], old.quaternion[node]))
        self.state, self.trial, self._taken_dt, self._bending = new, old, dt, self._measured.bending
        self._gain = max(self._gain, self._feedback_rate(self._measured.turning))
        self._stretch_before, self._stretch, self._trial_stretch = (
            self._stretch, self._trial_stretch, self._stretch_before
        )  # fmt: skip
        return self._flows.energy

    def _feedback_rate(self, turning: float) -> float:
        return float(STRETCH_FEEDBACK * (turning + OF_WAVES * self._natural_rate * self._bending**2))

    def switch_ends(self, t: float) -> None:
        """Put in force the end conditions that hold from t on."""
        for end, node in self._at_ends:
            end.switch(t, self._rates(end, node))

    def relative_increment(self, dt: float) -> float:
        """The trial's local error relative to its motion, dt^2 max|dV/dt change| / max|displacement|; at the least by
        what it leaves an end behind, in LEFT_BEHIND."""
        change, motion = self._measured.acceleration, self._measured.motion
        return max(dt * dt * change / (motion + SMALL_MOTION * float(self.s[-1])), self._left_behind / LEFT_BEHIND)

    def strain(self) -> float:
        """The trial's largest strain of an interval."""
        return self._measured.strain

    def turn(self) -> float:
        """The largest rotation (rad) of the trial within an interval."""
        return self._measured.turn

    def refusal(self) -> str:
        """Why contact does not let the trial be trusted, or nothing."""
        trial = self.trial
        return self.contact.refusal(self._measured.bending, lambda: (trial.r, trial.Y))

    def step_limit(self) -> float:
        """The longest next step (s) that contact and loads allow."""
        return min(self.contact.step_limit, self.applied.longest_step(self.state.r, self.state.Y[:, V : V + 3]))

    @property
    def orientations(self) -> Array | None:
        """Of the nodes."""
        return self.state.quaternion

    def fields(self) -> Fields:
        """The state along the rod."""
        Y, quaternion = self.state.Y, self.state.quaternion
        q = np.empty((len(Y), 3))
        moments(self._hand_over(), Y, q)
        return Fields(
            v=rotate_back(quaternion, Y[:, V : V + 3].copy()), omega=Y[:, OMEGA : OMEGA + 3].copy(),
            f=rotate_back(quaternion, Y[:, F:].copy()), kappa=Y[:, KAPPA : KAPPA + 3].copy(), q=q,
            strain=np.zeros(len(self.s)), r=self.state.r.copy(), orientation=quaternion.copy(),
        )  # fmt: skip

    def centreline(self) -> Shape:
        """The state's centreline."""
        return Shape(self.state.r, tangents_of_ends(self.state.quaternion))

    def energies(self) -> Energies:
        """The energies of the state, but for contact."""
        return energies(self._hand_over(), self.state, self.h, self._R)

    def twist(self) -> float:
        """Tw of the state, in turns."""
        twist = self.state.Y[:, KAPPA + 2]
        return float(np.sum(0.5 * (twist[1:] + twist[:-1])) * self.h / (2 * np.pi))

    def smallest_gap(self) -> float:
        """Smallest surface-to-surface distance (m) of points more than the skip apart; NaN if contact is ruled out."""
        return self.contact.smallest_gap(self._bending, self.state.r)

    def pressing(self) -> int:
        """Number of pairs of points that press on each other."""
        return self.contact.pressing

    def compile(self) -> None:
        """Have every kernel compiled that a run may need."""
        self.applied.compile()
        self.contact.compile()
        rescale_aux(self.state, 1.0)

    @property
    def _at_ends(self) -> tuple[tuple[DrivenEnd, int], ...]:
        return (self.start, 0), (self.end, -1)

    @property
    def _records(self) -> StepRecords:
        return StepRecords(self.section, self.applied.records, self._scales, self.contact.touch, self.work)

    def _hand_over(self) -> Reference:
        """The records, as they are now."""
        self._handed = self._handed.again(self._records)
        return self._handed

    @property
    def _rule(self) -> Scheme:
        """The scheme of the step at hand."""
        return BACKWARD_EULER if self._consistent else self._scheme

    def _ends(self, t: float, dt: float, follows: bool) -> EndValues:
        """What is given at both ends at the end of the step; where it `follows` them, so that they arrive."""
        values, dead = self._driven(self.start, 0, t, dt, follows)
        end_values, end_dead = self._driven(self.end, -1, t, dt, follows)
        return EndValues(self.start.kinds, values, dead, self.end.kinds, end_values, end_dead)

    def _driven(self, end: DrivenEnd, node: int, t: float, dt: float, follows: bool) -> tuple[Array, Array]:
        """Values and dead loads (6,) of an end."""
        corrected = follows and end.driven
        gain = 0.0 if corrected else LARGEST_FEEDBACK / dt
        values, dead = self.applied.driving(end, float(self.s[node]), t, (dt,), gain)
        if corrected:
            rates, length = self._rates(end, node), float(self.s[-1])
            extra, still = end.correction(t, dt, rates, self._rule.left_out, length)
            values[0] += extra
            self._left_behind = max(self._left_behind, still)
        return values[0], dead[0]

    def _rates(self, end: DrivenEnd, node: int) -> Array:
        """Velocity and omega (6,) that an end has now, along its axes."""
        return _along_axes(end, self.state.Y[node, V : OMEGA + 3], self.state.quaternion[node])


def _along_axes(end: DrivenEnd, moved: Array, quaternion: Array) -> Array:
    """A displacement or velocity (lab), and a rotation or omega (material), along the axes of an end (6,)."""
    if end.in_lab:
        return moved
    along = moved.copy()
    along[:3] = rotate_back(quaternion[None], moved[None, :3])[0]
    return along


def _initial_state(initial: Initial, s: Array, section: Section) -> tuple[State, Array]:
    """The state at t = 0, and by how much its kappa (n, 3) differs from the centreline's own.

    kappa's means must be the relative rotations of the nodes. kappa0 is to be shifted by as much, so that a rod whose
    natural shape is its initial one starts without stress.
    """
    state = State.empty(len(s))
    r, quaternion, kappa = nodes_at_rest(initial, s)
    state.quaternion[:] = quaternion
    state.r[:] = _follow_tangents(r[0], quaternion, s)
    correction = _kappa_correction(quaternion, kappa, s)
    state.Y[:, KAPPA : KAPPA + 3] = kappa + correction
    spin = np.array(initial.angular_velocity, dtype=float)
    weights = section.mass * np.gradient(s) * np.where((s == s[0]) | (s == s[-1]), 0.5, 1.0)
    centre = np.average(state.r, axis=0, weights=weights)
    state.Y[:, V : V + 3] = np.array(initial.velocity, dtype=float) + np.cross(spin, state.r - centre)
    state.Y[:, OMEGA : OMEGA + 3] = rotate_back(quaternion, np.tile(spin, (len(s), 1)))
    return state, correction


def _follow_tangents(start: Array, quaternion: Array, s: Array) -> Array:
    """Positions (n, 3) that satisfy the scheme's own Delta r = h T_m, from the first node on."""
    tangent = np.empty((len(s), 3))
    tangents_of(quaternion, tangent)
    steps = 0.5 * np.diff(s)[:, None] * (tangent[1:] + tangent[:-1])
    return np.vstack([start, start + np.cumsum(steps, axis=0)])


def _kappa_correction(quaternion: Array, kappa: Array, s: Array) -> Array:
    """The smallest change of kappa (n, 3) that makes its means those of the nodes' relative rotations."""
    from scipy.linalg import solveh_banded  # a fifth of a second

    turns = np.empty((len(s) - 1, 3))
    relative_rotations(quaternion[:-1], quaternion[1:], turns)
    missing = turns / np.diff(s)[:, None] - 0.5 * (kappa[1:] + kappa[:-1])
    bands = np.full((2, len(missing)), 0.25)
    bands[1] = 0.5
    shares = solveh_banded(bands, missing)
    correction = np.zeros_like(kappa)
    correction[1:] += 0.5 * shares
    correction[:-1] += 0.5 * shares
    return correction
