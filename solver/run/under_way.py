"""An attempt at a tolerance that is under way: a run of the scene at one of the resolutions that are tried."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from math import inf
from typing import TYPE_CHECKING, Any

from solver.measures.frame import Frame, Statistics
from solver.run import budget
from solver.run.artificial_viscosity import has_waves, is_damped, retardation_time, with_viscosity
from solver.run.budget import SETTLING, Patience
from solver.run.checkpoint import Saved, restore, saved
from solver.run.first_mesh import first_intervals
from solver.run.simulation import Simulation
from solver.run.trial import (
    Trial,
    grade_of,
    intervals_of,
    longest_step,
    step_tolerance,
    strides_of,
)
from solver.scene.scene import Scene

if TYPE_CHECKING:
    from solver.run.equilibria import Equilibria

SMALL_MOTION = 1e-3
"""See `Numerics`: of the waves that a start excites those below it are not followed step by step."""
FRAME = 270.0
"""Microseconds that a frame takes, see `solver.methods.cost`."""


class UnderWay:
    """The `run` of a trial, with what it has taken so far: its own `statistics`, and `work` as `budget` counts it.

    `pressed`: whether strands have pressed on each other; `calm_until`: see `budget.Patience`. Its states depend on
    nothing but the scene and the trial, so another run whose scene begins alike passes through the same; and it holds
    no frames.
    """

    def __init__(self, scene: Scene, trial: Trial) -> None:
        self.trial = trial
        self.statistics = Statistics()
        self.work, self.calm_until, self.pressed = 0.0, inf, False
        tolerance = scene.numerics.tolerance or 1.0
        intervals = intervals_of(trial.mesh, first_intervals(scene))
        settles = scene.contact is not None and is_damped(scene)
        self._patience = Patience(has_waves(scene, intervals), settles, scene.t_end)
        numerics = replace(
            scene.numerics, tolerance=None, verify=False, intervals=intervals,
            dt_max=longest_step(trial.steps, scene.output_interval), strides=strides_of(tolerance, trial.steps),
            small_motion=SMALL_MOTION, increment_tolerance=step_tolerance(trial.steps, tolerance),
        )  # fmt: skip
        resolved, grade = replace(scene, numerics=numerics), grade_of(trial.steps)
        if grade is not None:
            resolved = replace(resolved, rod=with_viscosity(scene.rod, intervals, grade))
        self.run: Simulation | Equilibria
        if scene.at_rest:
            from solver.run.equilibria import Equilibria  # with scipy.linalg, a fifth of a second

            self.run = Equilibria(resolved, self.statistics)
        else:
            self.run = Simulation(resolved, self.statistics, goes_on=True)
        if grade is not None:
            self.run.remarks.retardation_time = retardation_time(resolved.rod)

    def advance(self) -> Frame | None:
        """Take a step; give the frame where it ends, if one is due there. Raises RunFailed."""
        steps, iterations = self._spent
        frame = self.run.advance()
        self.pressed = self.pressed or self.run.pressing > 0
        tried, iterated = self._spent
        self.work += self.run.counted(tried - steps, iterated - iterations) + (FRAME if frame is not None else 0.0)
        if self.work > SETTLING * budget.MOST_WORK:
            self.calm_until = min(self.calm_until, self.run.t)
        return frame

    @property
    def _spent(self) -> tuple[int, int]:
        """Steps that were tried, and Newton iterations, so far."""
        return self.statistics.steps + self.statistics.failed_steps, self.statistics.newton_iterations

    @property
    def patience(self) -> float:
        """The part of MOST_WORK that it may take if its steps are the longest, as long as there is no answer."""
        return self._patience.part(self.calm_until)

    def checkpoint(self) -> Saved:
        """All that it remembers."""
        return saved(self)

    def restore(self, checkpoint: Mapping[str, Any]) -> None:
        """Go on where another was, of the same scene and trial."""
        restore(self, checkpoint)
