"""Which resolution a run to a tolerance tries next: a pure function of what those before have shown.

The coarsest mesh runs with two kinds of steps, which tells for next to nothing what shorter ones would change. Then the
mesh is made finer, or the steps shorter, or both at once: both errors fall to a quarter then, so that one difference
tells them together. It ends when their sum is below the tolerance, when the work is done that may be, or when it shows
that this work cannot bring it there. This is asked of each quantity that the tolerance is for: one that cannot be
brought there, as the curvature where a moment jumps, does not keep the others from it. Of those that can be, the one
with the largest error says what is made finer. Where no run comes to its end, the rod is given an artificial viscosity,
more and more of it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import ceil, inf, log
from typing import NamedTuple

from solver.outcome import Outcome
from solver.run import budget
from solver.run.artificial_viscosity import highest_grade
from solver.run.budget import (
    FIRST_PART,
    MOST_PATIENCE,
    NEARLY,
    OVERDRAWN,
    expected,
    growth,
    is_viscous,
    remaining,
    spent,
    suffices,
    was_waited_for,
)
from solver.run.series import Attempt, chosen, is_diagonal
from solver.run.trial import AT_REST, DAMPED, LOOSEST, Trial, grade_of, intervals_of

MADE, LOST = (tuple(Outcome).index(outcome) for outcome in (Outcome.ENERGY_MADE, Outcome.EQUILIBRIUM_LOST))
"""The outcome of a run whose steps, rather than its mesh, are the reason that it failed; and of a static analysis on
what may be too coarse a mesh."""
CROSSED = tuple(Outcome).index(Outcome.ROD_CROSSED_ITSELF)
WAVES = tuple(tuple(Outcome).index(outcome) for outcome in (Outcome.MESH_TOO_COARSE, Outcome.STEP_TOO_SMALL))
"""Outcomes of a run whose waves may be too short for its mesh."""
STEP_SHARE = 0.4
"""Part of the tolerance that the error of the steps may take."""
FAR = 64.0
"""How many times larger than that of the steps the error of the mesh is where it is made finer alone first."""
FAR_FROM_IT = 0.1
"""Relative error of the next finer mesh from which on a mesh is too coarse to show what shorter steps would change."""
STEEPER = 3
"""By how many grades more viscosity the next run has where one was slow, rather than one."""
HURRY = 3.0
"""How many times MOST_WORK, spent without an answer, after which the next run has as much as there may be."""
SAME_TIME = 0.02
"""Part of the time at which a run failed, within which another has failed at the same time."""
DEAR, FAR_OFF = 2.5, 10.0
"""How many times the work shorter steps took, and how many times the tolerance their error is, where the second mesh
has the longer ones."""
CHEAP, SAME = 0.13, 1.1
"""Part of MOST_WORK that an attempt may always take, unless it has shorter steps than one that changed nothing: the
error was the same to this."""
ENOUGH = 0.5
"""Part of MOST_WORK after which runs that fail at the same time are no longer tried on finer meshes."""
WORTH = {"kappa": 4.0}
"""How many times MOST_WORK all that a quantity needs may be, as its error last fell, for it to be refined; the others
are refined as long as their errors fall."""
LEAST_FALL, ONCE_MORE = 1.3, 0.3
"""By how much the error must have fallen last time to be thought to fall again; and how long an attempt may be, as part
of MOST_WORK, that is made all the same, for what is not given up soon: two meshes may agree by chance."""


class Excess(NamedTuple):
    """The errors of a quantity in what there is, over the tolerance, infinite where nothing tells them: by the `mesh`
    and by the `steps`; their total `before` the last attempt; and see WORTH."""

    mesh: float = inf
    steps: float = inf
    before: float = inf
    worth: float = inf
    anywhere: float = 0.0

    @property
    def total(self) -> float:
        """Their sum; of what ran with no other steps that of the mesh."""
        return self.mesh if self.steps == inf else self.mesh + self.steps


def next_trial(history: Sequence[Attempt], errors: Sequence[Excess], most_intervals: int,
               t_end: float = inf) -> Trial | None:  # fmt: skip
    """What to try after some attempts; None if what there is must be, or is, enough. Nothing is tried twice.

    `errors`: of each quantity; `t_end` (s): of the run.
    """
    tried = {(attempt.mesh, attempt.steps) for attempt in history}
    for trial in _candidates(history, errors, most_intervals, t_end):
        if trial is None or trial not in tried:
            return trial
    return None


def _candidates(history: Sequence[Attempt], errors: Sequence[Excess], most_intervals: int,
                t_end: float) -> Iterator[Trial | None]:  # fmt: skip
    """What might come next, what is wanted most first."""
    complete = [attempt for attempt in history if attempt.complete]
    if not complete:
        yield _until_one_is_complete(history, most_intervals, t_end)
        return
    if len(complete) == 1 and complete[0].work > MOST_PATIENCE * budget.MOST_WORK:
        return  # what is to tell its error may not take as long
    meshes = {attempt.mesh for attempt in complete}
    if len(meshes) == 1 and history[-1].slow and remaining(history) < 0.0:
        # what was to tell the error took far longer than what it is the error of, or had too many waves
        if any(attempt.outcome in WAVES for attempt in history):
            yield _more_damped(history[-1])
        return
    if is_viscous(_finest(complete)) and all(excess.mesh == inf for excess in errors):
        yield from _second_damped(history, _finest(complete), most_intervals)
        return
    if len(complete) == 1 and complete[0].steps != AT_REST:
        mesh, steps = complete[0].mesh, complete[0].steps
        if steps == LOOSEST and complete[0].work > FIRST_PART * budget.MOST_WORK:
            # strands rattle: the meshes differ by far more than shorter steps would change
            if expected(complete, Trial(mesh + 1, steps)) <= remaining(history) + OVERDRAWN * budget.MOST_WORK:
                yield Trial(mesh + 1, steps)
            yield Trial(max(mesh - 1, 0), steps)
        if suffices(history, Trial(mesh, steps + 1), most_intervals):
            yield Trial(mesh, steps + 1)
        yield Trial(max(mesh - 1, 0), max(steps - 1, LOOSEST))  # if it can, the last one is to tell all
    if len(meshes) == 1:
        yield from _second_mesh(history, complete, errors, most_intervals)
        return
    again = _steps_again(complete)
    if again and suffices(history, again, most_intervals):
        yield again
    if not history[-1].complete:
        yield _beyond_failures(history, most_intervals)
        return
    if _steps_are_untold(complete, errors):
        mesh, steps, *_ = min(complete)
        if suffices(history, Trial(mesh, steps + 1), most_intervals):
            yield Trial(mesh, steps + 1)
        return
    for excess in sorted(errors, key=lambda excess: -excess.total):
        for trial in _finer(_finest(complete), excess, chosen(history).many, diagonal=is_diagonal(history)):
            if excess.total > 1.0 and _may_do(history, excess, trial, most_intervals):
                yield trial
    for excess in sorted(errors, key=lambda excess: -excess.anywhere):
        for trial in _finer(_finest(complete), excess, chosen(history).many, diagonal=is_diagonal(history)):
            if excess.anywhere > 1.0 >= excess.total and _is_cheap(history, trial, most_intervals):
                yield trial


def _steps_again(complete: Sequence[Attempt]) -> Trial | None:
    """Shorter steps on the coarsest mesh that shows the motion, where that on which they were tried does not: the waves
    that it lacks need other steps. (Not where they have been tried together with finer meshes, on a diagonal.)"""
    meshes = [attempt.mesh for attempt in complete]
    compared = [attempt for attempt in complete if meshes.count(attempt.mesh) > 1]
    finer = sorted(attempt for attempt in complete if compared and attempt.mesh > max(compared).mesh)
    near = [attempt for attempt in finer if attempt.apart <= FAR_FROM_IT]
    if not near or finer[0] in near or max(attempt.steps for attempt in finer) > max(compared).steps:
        return None
    return Trial(near[0].mesh, near[0].steps + 1)


def _steps_are_untold(complete: Sequence[Attempt], errors: Sequence[Excess]) -> bool:
    """Whether meshes are compared, and nothing tells what shorter steps would change, which may be far more."""
    return all(excess.steps == inf for excess in errors) and not is_viscous(complete[0])


def _finest(complete: Sequence[Attempt]) -> Attempt:
    return max(complete, key=lambda attempt: (attempt.mesh, attempt.steps))


def _second_mesh(history: Sequence[Attempt], complete: Sequence[Attempt], errors: Sequence[Excess],
                 most_intervals: int) -> Iterator[Trial | None]:  # fmt: skip
    """A finer one, with the longer steps of two if their error is small enough, or if shorter ones cost several times
    the work and are far from enough, or leave none for a third mesh: the mesh, at least, is then told; else a coarser
    one."""
    mesh, steps = complete[0].mesh, sorted(attempt.steps for attempt in complete)
    # by two kinds of steps the error of the shorter is told as 2 / 3 of their difference, which is that of the longer
    small = 1.5 * max(excess.steps for excess in errors) <= STEP_SHARE
    dear = _steps_are_dear(complete, errors) or _no_third_mesh(history, complete, errors)
    longer = len(steps) > 1 and (small or dear)
    finer_steps = steps[-2] if longer else steps[-1]
    finer = Trial(max(attempt.mesh for attempt in history) + 1, finer_steps)
    if not longer and len(steps) > 1 and not suffices(history, finer, most_intervals):
        finer = Trial(finer.mesh, steps[-2])
    if mesh > 0 and not suffices(history, finer, most_intervals):
        yield Trial(mesh - 1, steps[-1])
    if finer.mesh == mesh + 1 and intervals_of(finer.mesh) <= most_intervals:
        yield finer
    if beyond := _beyond_failures(history, most_intervals):
        yield beyond
    failed = [attempt for attempt in history if not attempt.complete and attempt.mesh > mesh]
    if failed:
        yield _more_damped(failed[-1])


def _second_damped(history: Sequence[Attempt], finest: Attempt, most_intervals: int) -> Iterator[Trial]:
    """A finer mesh, whose waves are damped less, or else a coarser one, to tell what the mesh and the viscosity change;
    where that needs more viscosity than the `finest` has, the finest with as much. At last a finer one in any case."""
    complete = {(attempt.mesh, attempt.steps) for attempt in history if attempt.complete}
    if suffices(history, Trial(finest.mesh + 1, finest.steps), most_intervals):
        yield Trial(finest.mesh + 1, finest.steps)
    coarser = finest.mesh - 1
    crossed = any(attempt.mesh == coarser and attempt.outcome == CROSSED for attempt in history)
    for mesh in (finest.mesh + 1,) if crossed else (coarser, finest.mesh + 1):
        for trial in _with_grades(mesh, finest.steps, most_intervals):
            yield trial
            if trial in complete:
                yield Trial(finest.mesh, trial.steps)
                return


def _with_grades(mesh: int, steps: int, most_intervals: int) -> list[Trial]:
    """On a mesh, if there is one, with as much viscosity as `steps` say and more."""
    if not 0 <= mesh or intervals_of(mesh) > most_intervals:
        return []
    return [Trial(mesh, more) for more in range(steps, DAMPED - 1 - highest_grade(intervals_of(mesh)), -1)]


def _more_damped(last: Attempt, t_end: float = inf) -> Trial | None:
    """After a motion that had waves which are too short, or too many; none has more viscosity than there may be."""
    if last.steps == AT_REST or not (last.slow or last.outcome in WAVES or is_viscous(last)):
        return None
    grade, highest = grade_of(last.steps), highest_grade(intervals_of(last.mesh))
    if grade == highest:
        return None
    steeper = STEEPER if last.slow and last.t < NEARLY * t_end else 1
    higher = 0 if grade is None else min(grade + steeper, highest)
    return Trial(last.mesh, DAMPED - higher)


def _beyond_failures(history: Sequence[Attempt], most_intervals: int) -> Trial | None:
    """A mesh finer than the last one, which failed: a limp rope whips too sharply for it, and for coarser ones, which
    came to their end by being farther from the motion."""
    last = history[-1]
    finer = Trial(last.mesh + 1, last.steps)
    wanted = not (last.complete or last.slow or is_viscous(last))
    return finer if wanted and suffices(history, finer, most_intervals) else None


def _steps_are_dear(complete: Sequence[Attempt], errors: Sequence[Excess]) -> bool:
    """Whether shorter steps took several times the work, as where they follow waves, and more of them would be wanted
    for what is not soon given up."""
    dear = (growth(complete, Trial(0, 1)) or 1.0) >= DEAR
    return dear and any(excess.steps > FAR_OFF for excess in errors if excess.worth == inf)


def _no_third_mesh(history: Sequence[Attempt], complete: Sequence[Attempt], errors: Sequence[Excess]) -> bool:
    """Whether shorter steps would leave no work for a third mesh, and what the longer ones are in error is bearable."""
    mesh, steps = complete[0].mesh, max(attempt.steps for attempt in complete)
    work = sum(expected(complete, Trial(mesh + finer, steps)) for finer in (1, 2))
    bearable = all(excess.steps <= FAR_OFF for excess in errors if excess.worth == inf)
    return bearable and work > remaining(history)


def _finer(best: Attempt, excess: Excess, chain: int, diagonal: bool) -> list[Trial]:
    """Finer resolutions than the finest there is, what is wanted most first. `chain`: meshes that tell its error; with
    other steps there would be two of them, which is no loss where the error has not fallen with them."""
    mesh, steps = Trial(best.mesh + 1, best.steps), Trial(best.mesh, best.steps + 1)
    both = Trial(best.mesh + 1, best.steps + 1)
    if grade_of(steps.steps) is None and is_viscous(best):  # without viscosity it did not come to its end
        return [mesh]
    alone = [mesh, steps] if excess.mesh >= excess.steps else [steps, mesh]
    alike = excess.mesh <= FAR * excess.steps and excess.mesh > 1.0 - STEP_SHARE and excess.steps > STEP_SHARE
    if (alike and chain < 3) or (diagonal and excess.steps > STEP_SHARE):
        return [both, alone[0]]
    if alike and not diagonal and excess.worth == inf and excess.before < LEAST_FALL * excess.total:
        return [both, steps, mesh]
    return alone[:1]


def _until_one_is_complete(history: Sequence[Attempt], most_intervals: int, t_end: float) -> Trial | None:
    last = history[-1]
    if last.slow and last.steps > LOOSEST:
        return Trial(last.mesh, max(last.steps - 2, LOOSEST))
    crossed = last.outcome == CROSSED and (is_viscous(last) or was_waited_for(last))
    if crossed and intervals_of(last.mesh + 1) <= most_intervals:
        return Trial(last.mesh + 1, DAMPED)  # nodes were too far apart to press on each other as strands do
    if last.slow or is_viscous(last):
        more = _more_damped(last, t_end)
        if more and spent(history) > HURRY * budget.MOST_WORK:
            return Trial(more.mesh, DAMPED - highest_grade(intervals_of(more.mesh)))
        if more or last.slow or intervals_of(last.mesh + 1) > most_intervals or remaining(history) < 0.0:
            return more
        return Trial(last.mesh + 1, DAMPED)  # a rope may be too limp for coarse meshes, whatever damps it
    failed = [attempt for attempt in history if not attempt.slow]
    same = len(failed) > 2 and abs(failed[-1].t - failed[-2].t) <= SAME_TIME * failed[-1].t
    branch_ends = last.steps == AT_REST and len(failed) > 3 and (last.outcome != LOST or last.t > 0.0)
    # a rope may be too limp for coarse meshes
    same = same and (branch_ends or spent(history) > ENOUGH * budget.MOST_WORK)
    if same or intervals_of(last.mesh + 1) > most_intervals or remaining(history) < 0.0:
        return _more_damped(last)
    if last.outcome == MADE and not any(attempt.mesh == last.mesh for attempt in failed[:-1]):
        return Trial(last.mesh, last.steps + 1)
    return Trial(last.mesh + 1, last.steps)


def _may_do(history: Sequence[Attempt], excess: Excess, trial: Trial, most_intervals: int) -> bool:
    """Whether an attempt can be made, and is cheap or on a way to the tolerance that has an end."""
    if not suffices(history, trial, most_intervals):
        return False
    complete = [attempt for attempt in history if attempt.complete]
    fall = excess.before / excess.total
    if _is_cheap(history, trial, most_intervals):
        by_steps = len(complete) > 2 and trial.mesh == complete[-1].mesh == complete[-2].mesh
        return not (by_steps and 1.0 / SAME < fall < SAME)
    if is_viscous(trial):
        return False  # its waves do not converge
    work = expected(complete, trial)
    if excess.worth == inf and work <= ONCE_MORE * budget.MOST_WORK:
        return True
    all_of_them = spent(history) + _all_of(complete, excess, trial)
    return fall >= LEAST_FALL and all_of_them <= excess.worth * budget.MOST_WORK


def _is_cheap(history: Sequence[Attempt], trial: Trial, most_intervals: int) -> bool:
    """Whether an attempt is nearly nothing of the work that may be done, and can be made."""
    work = expected([attempt for attempt in history if attempt.complete], trial)
    return work <= CHEAP * budget.MOST_WORK and suffices(history, trial, most_intervals)


def _all_of(complete: Sequence[Attempt], excess: Excess, trial: Trial) -> float:
    """The work of an attempt and of all that are to follow it, if the error falls as it last did, at best to a
    quarter from one to the next."""
    nearest = _finest(complete)
    fall = min(max(excess.before / excess.total, LEAST_FALL), 4.0)
    work = expected(complete, trial)
    growth = max(work / max(nearest.work, 1.0), 1.1)
    many = min(max(ceil(log(max(excess.total, 1.0)) / log(fall)), 1), 20)
    return float(work * (growth**many - 1.0) / (growth - 1.0))


def to_come(history: Sequence[Attempt], errors: Sequence[Excess], trial: Trial) -> float:
    """The work that is likely to follow an attempt, for the progress."""
    complete = [attempt for attempt in history if attempt.complete]
    left = max(remaining(history), 0.0)
    if not complete:
        return budget.MOST_WORK * FIRST_PART
    work = expected(complete, trial)
    if any(excess.total == inf for excess in errors):
        return min(2.0 * work, left)
    wanted = [_all_of(complete, excess, trial) for excess in errors if excess.total > 1.0]
    return min(max(max(wanted, default=work) - work, 0.0), left)
