"""The box method as the simulation sees it: a state, and steps that are tried and then taken."""

from __future__ import annotations

import numpy as np

from solver.contact.self_contact import SelfContact
from solver.ends import DrivenEnd
from solver.initial import nodes_at_rest
from solver.loads.applied import AppliedLoads
from solver.measures.energies import powers
from solver.methods.box.fields import KAPPA, OMEGA, F, Loads, Section, State, V, sample
from solver.methods.box.generalized_alpha import BACKWARD_EULER, Scheme, rescale_aux
from solver.methods.box.newton import EndValues, Scales, Work, step
from solver.rod import Array
from solver.rotation import rotate_back
from solver.scene import Initial, Scene

DRIFT_FEEDBACK = 0.2
"""Part of the constraints' drift that a step takes back."""


class BoxMethod:
    """Generalized-alpha in time and in space on the unknowns V, omega, kappa, F at the nodes."""

    def __init__(self, scene: Scene) -> None:
        numerics = scene.numerics
        self.s = np.linspace(0.0, scene.rod.length, numerics.intervals + 1)
        self.h = scene.rod.length / numerics.intervals
        self.section: Section = sample(scene.rod, self.s)
        self.applied = AppliedLoads(scene, self.section, self.s)
        self.start, self.end = DrivenEnd(scene.start), DrivenEnd(scene.end)
        self.state = _initial_state(scene.initial, self.s, self.section)
        self.contact = SelfContact(scene.contact, self.section, self.s)
        self.trial = State.empty(len(self.s))
        self._scheme = Scheme.of(numerics.rho_inf)
        self._scales = Scales(scene.rod.length, float(self.section.stiffness[:, :2].mean()),
                              numerics.linear_solver == "shooting")  # fmt: skip
        self.work = Work.empty(numerics.intervals, self._scales.shooting)
        self._last_dt, self._consistent = 0.0, False
        self._F_rate = np.zeros((len(self.s), 3))
        self.loads: Loads = self.applied.at(0.0)

    def try_step(self, t: float, dt: float, consistent: bool = False) -> tuple[int, int]:
        """Try to go from t to t + dt into `trial`; how it ended and the Newton iterations.

        With `consistent`, by backward Euler: dt is tiny, and what is wanted is accelerations and forces.
        """
        scheme = BACKWARD_EULER if consistent else self._scheme
        if not consistent and self._last_dt > 0.0 and dt != self._last_dt:
            rescale_aux(self.state, dt / self._last_dt)
        self._last_dt, self._consistent = dt, consistent
        gain = DRIFT_FEEDBACK / dt
        self.loads = self.applied.at(t + dt)
        self._guess(dt, consistent)
        self.contact.prepare(self.state)
        status, iterations = step(
            self.state, self.trial, scheme, dt, self.h, self.section, self.loads, self._ends(t, dt, gain),
            self._scales, gain, self.contact.touch, self.work,
        )  # fmt: skip
        return int(status), int(iterations)

    def take_step(self, t: float, dt: float) -> None:
        """Make the trial the state."""
        old, new = self.state, self.trial
        self._F_rate = (new.Y[:, F:] - old.Y[:, F:]) / dt
        c0 = (BACKWARD_EULER if self._consistent else self._scheme).c0(dt)
        for end, node in ((self.start, 0), (self.end, len(self.s) - 1)):
            shift = new.r[node : node + 1] - old.r[node : node + 1]
            turned = self.work.past[node, 3:6] + new.Y[node, OMEGA : OMEGA + 3] / c0
            end.follow(shift[0] if end.in_lab else rotate_back(old.quaternion[node : node + 1], shift)[0], turned)
        self.state, self.trial = new, old

    def switch_ends(self, t: float) -> None:
        """Put in force the end conditions that hold from t on."""
        for end, node in ((self.start, 0), (self.end, -1)):
            velocity = self.state.Y[node, V : V + 3] if end.in_lab else self.velocity()[node]
            end.switch(t, np.concatenate([velocity, self.state.Y[node, OMEGA : OMEGA + 3]]))

    def velocity(self) -> Array:
        """v (n, 3), material."""
        return rotate_back(self.state.quaternion, self.state.Y[:, V : V + 3])

    def relative_increment(self, dt: float) -> float:
        """The trial's local error relative to its motion, dt^2 max|dV/dt change| / max|displacement|."""
        change = float(np.abs(self.trial.rate[:, :3] - self.state.rate[:, :3]).max())
        motion = float(np.abs(self.trial.r - self.state.r).max())
        return dt * dt * change / (motion + 1e-8 * float(self.s[-1]))

    def power(self, out: Array) -> None:
        """Write the power of ends, loads and dissipation at the state just taken into `out` (3,)."""
        powers(self.state, self.work.nodes, self.section, self.loads, self.applied.weight, self.h, out)

    def _guess(self, dt: float, consistent: bool) -> None:
        self.trial.Y[:] = self.state.Y
        if not consistent:
            self.trial.Y[:, :9] += dt * self.state.rate
            self.trial.Y[:, F:] += dt * self._F_rate

    def _ends(self, t: float, dt: float, gain: float) -> EndValues:
        values = []
        for end, s in ((self.start, 0.0), (self.end, float(self.s[-1]))):
            target = end.values(t, dt, gain)
            follower = self.applied.at_end(t + dt, s, "material")
            loaded = (end.kinds == 1) | (end.kinds == 3)
            target[loaded] += follower[loaded]
            values += [end.kinds, target, self.applied.at_end(t + dt, s, "lab")]
        return EndValues(*values)


def _initial_state(initial: Initial, s: Array, section: Section) -> State:
    state = State.empty(len(s))
    r, quaternion, kappa = nodes_at_rest(initial, s)
    state.r[:], state.quaternion[:], state.Y[:, KAPPA : KAPPA + 3] = r, quaternion, kappa
    spin = np.array(initial.angular_velocity, dtype=float)
    centre = np.average(r, axis=0, weights=section.mass)
    state.Y[:, V : V + 3] = np.array(initial.velocity, dtype=float) + np.cross(spin, r - centre)
    state.Y[:, OMEGA : OMEGA + 3] = rotate_back(quaternion, np.tile(spin, (len(s), 1)))
    return state
