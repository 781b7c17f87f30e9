"""How much work an attempt at a tolerance may take, and how much it is expected to, by those before it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf

from solver.run.artificial_viscosity import highest_grade
from solver.run.series import Attempt
from solver.run.trial import AT_REST, LOOSEST, Trial, grade_of, intervals_of

MOST_WORK = 1e7
"""Microseconds as `solver.methods.cost` counts them, in all, after which nothing is refined: some ten seconds."""
MOST_WORK_AT_REST = 20.0 * MOST_WORK
"""Of a static analysis on one mesh, if none as coarse has come to its end: no waves can keep it from that."""
LETTING_GO = 3.0
"""Part of MOST_WORK in which a static analysis has let go of the initial shape, or does not."""
FIRST_PART = 0.1
"""Part of MOST_WORK that a run may take as long as there is no answer; with longer steps it is tried again."""
TO_THE_END = 6.0
"""Part of MOST_WORK that a run with the longest steps may take which no viscosity makes faster, as it has no waves."""
SETTLING, SETTLING_LATE = 0.8, 2.2
"""Likewise of a rod whose strands may strike each other, and soon rest: a loop that collapses takes most of the work of
a run that is calm before and after. Viscosity takes no less, and bends the rod elsewhere."""
OVERDRAWN = 0.25
"""Part of MOST_WORK that an attempt may take beyond what was left for it, lest all of it be lost near its end."""
PATIENCE, MOST_PATIENCE = 8.0, 2.0
"""How many times the work that is expected of it the first run on a second mesh, or with other steps, may take; and
how many times MOST_WORK."""
DAMPED_PART, LAST_PART = 0.6, 1.5
"""Part of MOST_WORK that a run with artificial viscosity may take, and that the last ones may: after one that was slow,
or of the highest grade."""
NEARLY = 0.5
"""Part of the whole run from which on one was not slow by so much."""
OVERHEAD = 60
"""Intervals that take as long as all else of a step, before it has shown."""
BY_STEPS = 1.5
"""How much more work steps of a quarter of the error are expected to be, before it has shown."""
FASTER = 1.2
"""How many times more the work of shorter steps grows for every doubling of the mesh on which it was seen to grow:
waves are faster there."""


def is_viscous(attempt: Attempt | Trial) -> bool:
    """Whether the rod has an artificial viscosity there."""
    return grade_of(attempt.steps) is not None


@dataclass(frozen=True)
class Patience:
    """How long a run with the longest steps is waited for as long as there is no answer.

    `waves`: whether the rod may have such as viscosity damps; `settles`: whether strands that rattle soon rest;
    `t_end` (s): of the run.
    """

    waves: bool = True
    settles: bool = False
    t_end: float = inf

    def part(self, calm_until: float) -> float:
        """Of MOST_WORK. `calm_until`: the time (s) at which it had taken SETTLING of it, infinite before. (This falls
        but once: what is not given up now was not given up before.)"""
        if self.settles:
            return SETTLING if calm_until < NEARLY * self.t_end else SETTLING_LATE
        return FIRST_PART if self.waves else TO_THE_END


def spent(history: Sequence[Attempt]) -> float:
    """The work of all attempts."""
    return sum(attempt.work for attempt in history)


def remaining(history: Sequence[Attempt]) -> float:
    """What is left of the work that may be done; negative where more was."""
    return MOST_WORK - spent(history)


def was_waited_for(attempt: Attempt) -> bool:
    """See `Patience`."""
    return attempt.steps == LOOSEST and attempt.work > 2.0 * FIRST_PART * MOST_WORK


def allowance(history: Sequence[Attempt], trial: Trial, longest: float = FIRST_PART) -> float:
    """The work that an attempt may take before it is given up as slow. With viscosity those without it do not count.
    `longest`: see `Patience`; it is waited for once."""
    complete = [attempt for attempt in history if attempt.complete and is_viscous(attempt) == is_viscous(trial)]
    if trial.steps == AT_REST and all(trial.mesh < attempt.mesh for attempt in complete):
        return MOST_WORK_AT_REST
    if not complete:
        if not is_viscous(trial):
            once = trial.steps > LOOSEST or any(map(was_waited_for, history))
            return MOST_WORK * (FIRST_PART if once else longest)
        last = any(attempt.slow and is_viscous(attempt) for attempt in history)
        last = last or grade_of(trial.steps) == highest_grade(intervals_of(trial.mesh))
        return MOST_WORK * (LAST_PART if last else DAMPED_PART)
    left = remaining(history)
    meshes = {attempt.mesh for attempt in complete}
    if len(complete) == 1 or (len(meshes) == 1 and trial.mesh not in meshes):
        # without it nothing is known of the error
        return max(left, min(PATIENCE * expected(complete, trial), MOST_PATIENCE * MOST_WORK))
    return left + OVERDRAWN * MOST_WORK


def expected(complete: Sequence[Attempt], trial: Trial) -> float:
    """The work of an attempt, by the nearest of those before and by how the work grew from one to the next."""
    nearest = min(complete, key=lambda attempt: (abs(attempt.mesh - trial.mesh), abs(attempt.steps - trial.steps)))
    size = (intervals_of(trial.mesh) + OVERHEAD) / (intervals_of(nearest.mesh) + OVERHEAD)
    meshes, steps = trial.mesh - nearest.mesh, max(trial.steps - nearest.steps, 0)
    mesh_growth = growth(complete, Trial(1, 0)) or size ** (1.0 / max(meshes, 1))
    together = growth(complete, Trial(1, 1))
    if together and meshes > 0 and steps > 0:
        common = min(meshes, steps)
        return float(nearest.work * together**common * mesh_growth ** (meshes - common) * BY_STEPS ** (steps - common))
    step_growth = growth(complete, Trial(0, 1)) or BY_STEPS
    seen_on = max((attempt.mesh for attempt in complete if attempt.steps >= trial.steps), default=nearest.mesh)
    step_growth *= FASTER ** max(nearest.mesh - seen_on, 0)
    return float(nearest.work * (mesh_growth**meshes if meshes > 0 else size) * step_growth**steps)


def growth(complete: Sequence[Attempt], by: Trial) -> float | None:
    """How much more work the last attempt was that was finer by `by` than another; None if none was."""
    work = {(attempt.mesh, attempt.steps): attempt.work for attempt in complete}
    for attempt in reversed(complete):
        before = work.get((attempt.mesh - by.mesh, attempt.steps - by.steps))
        if before:
            return min(max(attempt.work / before, 1.0), 8.0)
    return None


def suffices(history: Sequence[Attempt], trial: Trial, most_intervals: int) -> bool:
    """Whether the work that may be done suffices for an attempt."""
    complete = [attempt for attempt in history if attempt.complete]
    return intervals_of(trial.mesh) <= most_intervals and expected(complete, trial) <= remaining(history)
