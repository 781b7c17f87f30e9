"""The loop that turns a scene into frames."""

from __future__ import annotations

from dataclasses import replace
from math import pi

from solver.arrays import Array
from solver.measures.frame import Frame, Statistics, complete
from solver.measures.ring import is_ring
from solver.methods.method import Method
from solver.methods.registry import discretized, tolerated_increment
from solver.methods.status import CONVERGED, LOST_DIGITS, SINGULAR
from solver.outcome import Outcome, RunFailed
from solver.physics.axial import axial_stiffness, largest_strain
from solver.physics.loads.solids import deepest_within
from solver.physics.seed import size_of_seed
from solver.run.accounts import Accounts
from solver.run.run import Run
from solver.run.step_control import CONSISTENT_STEPS, StepControl
from solver.run.warming import load
from solver.run.watch import Watch
from solver.scene.scene import Scene

FATAL = (Outcome.SHOOTING_LOST_DIGITS, Outcome.SINGULAR_SYSTEM)
"""Outcomes that a shorter step does not avert."""

LARGEST_MADE = 0.1
"""Part of the energy that changed its form or hands: a run that made or lost more of it says nothing of the rod. And
part of the largest energy that there ever was, a loss of which a run that goes on has to tell."""

class Simulation(Run):
    """Motion, by steps in time."""

    def __init__(self, scene: Scene, statistics: Statistics | None = None, goes_on: bool = False,
                 method: Method | None = None) -> None:  # fmt: skip
        """`method`: that of the scene, if not the one that it asks for. `goes_on`: energy that went nowhere is a
        remark, and does not end the run by `energy_lost`; energy that came from nowhere ends it at its last frame only,
        if it is much then."""
        super().__init__(scene, statistics)
        self._goes_on = goes_on
        self._method = method or discretized(scene)
        self._accounts = Accounts(scene, self._method)
        ends = self._method.start.corners() + self._method.end.corners()
        self._control = StepControl(
            scene.numerics.dt_max, tolerated_increment(scene.numerics), self._method.increment_order,
            self._method.easy_iterations, self._method.shortest_step, ends + self._method.applied.corners(),
            self._outputs, scene.numerics.strides,
        )  # fmt: skip
        self._switches = sorted({c.since for e in (scene.start, scene.end)
                                 for component in (*e.translation, *e.rotation) for c in component[1:]})  # fmt: skip
        if scene.numerics.method == "staggered":
            self.remarks.axial_stiffness = axial_stiffness(scene)
        self.remarks.buckling_seed = size_of_seed(scene)
        self._largest_strain = largest_strain(scene)
        self._watch = Watch(self.remarks, scene.contact is not None, is_ring(scene))
        self._turn = self._trial_turn = pi
        """The largest rotation (rad) within an interval, of the state and of the trial."""

    @property
    def s(self) -> Array:
        """Arclengths of the nodes (n,), m."""
        return self._method.s

    @property
    def pressing(self) -> int:
        """Number of pairs of points that press on each other."""
        return self._method.pressing()

    def counted(self, steps: int, iterations: int) -> float:
        """About how long steps like the last one take (us), by their number and all their `iterations`."""
        rough = self._method.applied.strikes
        placed = self._method.contact_points_placed()
        return self._method.cost.of(len(self.s) - 1, steps, iterations, placed, self.pressing, rough)

    def warm(self) -> None:
        """Have every kernel compiled."""
        numerics = self._scene.numerics
        load(numerics.method, self._method.touches, numerics.linear_solver,
             numerics.rho_inf_space < 1.0)  # fmt: skip

    def _first_frame(self) -> Frame:
        frame = self._accounts.frame(0.0)
        self.t = self._begin()
        self._watch.see(frame)
        # forces are no part of what is given at t = 0, they follow from it
        frame = replace(frame, f=self._method.fields().f, contacts=self._method.pressing())
        return complete(frame, self.s, self._scene)

    def _next_frame(self, output: float) -> Frame | None:
        if not self._control.reached(output, self.t):
            step = self._control.step_from(self.t, self._method.step_limit(), self._method.next_blow())
            self.t = self._advance(self.t, *step)
        if not self._control.reached(output, self.t):
            return None
        ago = 0.0 if self._control.reached(self.t, output) else self.t - output
        frame = self._accounts.frame(output, ago)
        self.remarks.stretched(self._method.strain(), float(self._scene.rod.length))
        self.remarks.sunk(deepest_within(self._scene, self.s, frame.r), frame.t)
        made, last = self._accounts.made, output == self._outputs[-1]
        detail = f"{abs(made):.2g} of all that changed hands"
        if made > LARGEST_MADE and (last or not self._goes_on):
            raise RunFailed(Outcome.ENERGY_MADE, self.t, self.statistics.steps, detail)
        if last:  # much of what was at first may be little of all
            if self._accounts.lost > LARGEST_MADE:
                self.remarks.energy_lost = self._accounts.lost
            if made < -LARGEST_MADE and not self._goes_on:
                raise RunFailed(Outcome.ENERGY_LOST, self.t, self.statistics.steps, detail)
        crossed = self._watch.see(frame)
        if crossed:
            raise RunFailed(Outcome.ROD_CROSSED_ITSELF, self.t, self.statistics.steps, crossed)
        return complete(frame, self.s, self._scene)

    def _begin(self) -> float:
        """Two tiny steps that find consistent accelerations and forces; return the time they reach."""
        for part in CONSISTENT_STEPS:
            dt = max(min(part * self._scene.numerics.dt_max, 0.1 * self._outputs[0]), self._method.shortest_step)
            if 2.0 * dt > self._outputs[0]:
                refusal = f"the first frame comes sooner than two steps of {dt:.3g} s; rho_inf_space bears none shorter"
                raise RunFailed(Outcome.NO_CONSISTENT_START, 0.0, 0, refusal)
            status, iterations = self._method.try_step(0.0, dt, consistent=True)
            self.statistics.newton_iterations += iterations
            if status == CONVERGED:
                self._take(0.0, dt, iterations)
                return self._advance(dt, dt, 2 * dt, consistent=True)
            self.statistics.failed_steps += 1
        refusal, outcome = self._judge(status, 0.0)
        raise RunFailed(outcome if outcome in FATAL else Outcome.NO_CONSISTENT_START, 0.0, 0, refusal)

    def _advance(self, t: float, dt: float, target: float, consistent: bool = False) -> float:
        """Take one step from t, as long as dt or shorter if need be; return the time it reached."""
        while True:
            status, iterations = self._method.try_step(t, dt, consistent)
            self.statistics.newton_iterations += iterations
            increment = 0.0 if consistent or status != CONVERGED else self._method.relative_increment(dt)
            refusal, outcome = self._judge(status, increment)
            if not refusal:
                break
            self.statistics.failed_steps += 1
            if outcome in FATAL or 0.5 * dt < self._control.smallest:
                if consistent and outcome is Outcome.STEP_TOO_SMALL:
                    raise RunFailed(Outcome.NO_CONSISTENT_START, 0.0, 0, refusal)
                crossed = "" if consistent else self._watch.see(self._accounts.frame(t))
                if crossed:  # since the last frame, which may be why no step leads on from here
                    outcome, refusal = Outcome.ROD_CROSSED_ITSELF, crossed
                raise RunFailed(outcome, t, self.statistics.steps, refusal)
            self._control.rejected(dt)
            dt *= 0.5
            target = t + dt
        self._take(t, dt, iterations)
        if not consistent:
            self._control.accepted(dt, increment, iterations)
            if self._control.stuck:
                detail = "the motion is faster than the steps, however short"
                raise RunFailed(Outcome.STEP_TOO_SMALL, self.t, self.statistics.steps, detail)
        if self._switches and self._control.reached(self._switches[0], target):
            self._method.switch_ends(max(self._switches.pop(0), target))
            self._control.restart()
        return target

    def _judge(self, status: int, increment: float) -> tuple[str, Outcome]:
        """Why the trial must not be taken, or nothing; and what that is called if no shorter step helps."""
        if status == LOST_DIGITS:
            return "the homogeneous solutions grew too much", Outcome.SHOOTING_LOST_DIGITS
        if status == SINGULAR:
            return "a pivot vanished", Outcome.SINGULAR_SYSTEM
        if status != CONVERGED:
            return "Newton's iteration stalled", Outcome.STEP_TOO_SMALL
        if self._control.too_coarse(increment):
            return "the motion is faster than the step", Outcome.STEP_TOO_SMALL
        if self._method.strain() > self._largest_strain:
            return f"stretched or squeezed by a factor of {1.0 + self._method.strain():.3g}", Outcome.ROD_STRETCHED
        refusal = self._method.refusal()
        if refusal:
            return refusal, Outcome.ROD_CROSSED_ITSELF
        self._trial_turn = self._method.turn()
        if self._trial_turn < pi:
            return "", Outcome.COMPLETED
        # where the rod was nowhere near that, it is the step that went wrong
        coarse = Outcome.MESH_TOO_COARSE if self._turn > 0.5 * pi else Outcome.STEP_TOO_SMALL
        return f"by {self._trial_turn:.3g} rad within an interval", coarse

    def _take(self, t: float, dt: float, iterations: int) -> None:
        """Make the step that was tried the state, and enter it in the books."""
        flowed = self._method.take_step(t, dt)
        self._turn = self._trial_turn
        self.statistics.steps += 1
        self._accounts.after_step(t + dt, dt, iterations, flowed)
        if self._scene.topology and self._scene.contact is not None:
            self._watch.follow(self._method.centreline())
