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
from dataclasses import dataclass
from math import ceil, inf, log
from typing import NamedTuple

from solver.outcome import Outcome
from solver.run.artificial_viscosity import highest_grade
from solver.run.series import Attempt, chosen, is_diagonal
from solver.run.trial import AT_REST, DAMPED, LOOSEST, OVERHEAD, Trial, grade_of, intervals_of

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
MOST_WORK = 1.2e7
"""Newton iterations times (intervals + OVERHEAD), in all, after which nothing is refined: five to ten seconds."""
MOST_WORK_AT_REST = 20.0 * MOST_WORK
"""Of a static analysis on one mesh, if none as coarse has come to its end: no waves can keep it from that."""
LETTING_GO = 3.0
"""Part of MOST_WORK in which a static analysis has let go of the initial shape, or does not."""
FIRST_PART = 0.1
"""Part of MOST_WORK that a run may take as long as there is no answer; with longer steps it is tried again."""
TO_THE_END = 6.0
"""Part of MOST_WORK that a run with the longest steps may take which no viscosity makes faster, as it has no waves."""
SETTLING, SETTLING_LATE = 1.0, 3.0
"""Likewise of a rod whose strands may strike each other, and soon rest: a loop that collapses takes most of the work of
a run that is calm before and after. Viscosity takes no less, and bends the rod elsewhere."""
OVERDRAWN = 0.25
"""Part of MOST_WORK that an attempt may take beyond what was left for it, lest all of it be lost near its end."""
PATIENCE, MOST_PATIENCE = 8.0, 2.5
"""How many times the work that is expected of it the first run on a second mesh, or with other steps, may take; and
how many times MOST_WORK."""
DAMPED_PART, LAST_PART, STEEPER = 0.6, 2.0, 3
"""Part of MOST_WORK that a run with artificial viscosity may take, and that the last ones may: after one that was slow,
or of the highest grade; and by how many grades the next one has more where one was slow, rather than one."""
NEARLY = 0.5
"""Part of the whole run from which on one was not slow by so much."""
SAME_TIME = 0.02
"""Part of the time at which a run failed, within which another has failed at the same time."""
BY_STEPS = 1.5
"""How much more work steps of a quarter of the error are expected to be, before it has shown."""
FASTER = 1.2
"""How many times more the work of shorter steps grows for every doubling of the mesh on which it was seen to grow:
waves are faster there."""
DEAR, FAR_OFF = 2.5, 10.0
"""How many times the work shorter steps took, and how many times the tolerance their error is, where the second mesh
has the longer ones."""
CHEAP, SAME = 0.1, 1.1
"""Part of MOST_WORK that an attempt may always take, unless it has shorter steps than one that changed nothing: the
error was the same to this."""
ENOUGH = 0.5
"""Part of MOST_WORK after which runs that fail at the same time are no longer tried on finer meshes."""
WORTH = {"kappa": 4.0}
"""How many times MOST_WORK all that a quantity needs may be, as its error last fell, for it to be refined; the others
are refined as long as their errors fall."""
LEAST_FALL = 1.3
"""By how much the error must have fallen last time to be thought to fall again."""


class Excess(NamedTuple):
    """The errors of a quantity in what there is, over the tolerance, infinite where nothing tells them: by the `mesh`
    and by the `steps`; their total `before` the last attempt; and see WORTH."""

    mesh: float = inf
    steps: float = inf
    before: float = inf
    worth: float = inf

    @property
    def total(self) -> float:
        """Their sum; of what ran with no other steps that of the mesh."""
        return self.mesh if self.steps == inf else self.mesh + self.steps


def _is_damped(attempt: Attempt | Trial) -> bool:
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


def _was_waited_for(attempt: Attempt) -> bool:
    """See `Patience`."""
    return attempt.steps == LOOSEST and attempt.work > 2.0 * FIRST_PART * MOST_WORK


def allowance(history: Sequence[Attempt], trial: Trial, longest: float = FIRST_PART) -> float:
    """The work that an attempt may take before it is given up as slow. With viscosity those without it do not count.
    `longest`: see `Patience`; it is waited for once."""
    complete = [attempt for attempt in history if attempt.complete and _is_damped(attempt) == _is_damped(trial)]
    if trial.steps == AT_REST and all(trial.mesh < attempt.mesh for attempt in complete):
        return MOST_WORK_AT_REST
    if not complete:
        if not _is_damped(trial):
            once = trial.steps > LOOSEST or any(map(_was_waited_for, history))
            return MOST_WORK * (FIRST_PART if once else longest)
        last = any(attempt.slow and _is_damped(attempt) for attempt in history)
        last = last or grade_of(trial.steps) == highest_grade(intervals_of(trial.mesh))
        return MOST_WORK * (LAST_PART if last else DAMPED_PART)
    remaining = MOST_WORK - _work(history)
    meshes = {attempt.mesh for attempt in complete}
    if len(complete) == 1 or (len(meshes) == 1 and trial.mesh not in meshes):
        # without it nothing is known of the error
        return max(remaining, min(PATIENCE * expected(complete, trial), MOST_PATIENCE * MOST_WORK))
    return remaining + OVERDRAWN * MOST_WORK


def expected(complete: Sequence[Attempt], trial: Trial) -> float:
    """The work of an attempt, by the nearest of those before and by how the work grew from one to the next."""
    nearest = min(complete, key=lambda attempt: (abs(attempt.mesh - trial.mesh), abs(attempt.steps - trial.steps)))
    size = (intervals_of(trial.mesh) + OVERHEAD) / (intervals_of(nearest.mesh) + OVERHEAD)
    meshes, steps = trial.mesh - nearest.mesh, max(trial.steps - nearest.steps, 0)
    mesh_growth = _growth(complete, Trial(1, 0)) or size ** (1.0 / max(meshes, 1))
    together = _growth(complete, Trial(1, 1))
    if together and meshes > 0 and steps > 0:
        common = min(meshes, steps)
        return float(nearest.work * together**common * mesh_growth ** (meshes - common) * BY_STEPS ** (steps - common))
    step_growth = _growth(complete, Trial(0, 1)) or BY_STEPS
    seen_on = max((attempt.mesh for attempt in complete if attempt.steps >= trial.steps), default=nearest.mesh)
    step_growth *= FASTER ** max(nearest.mesh - seen_on, 0)
    return float(nearest.work * (mesh_growth**meshes if meshes > 0 else size) * step_growth**steps)


def _growth(complete: Sequence[Attempt], by: Trial) -> float | None:
    """How much more work the last attempt was that was finer by `by` than another; None if none was."""
    work = {(attempt.mesh, attempt.steps): attempt.work for attempt in complete}
    for attempt in reversed(complete):
        before = work.get((attempt.mesh - by.mesh, attempt.steps - by.steps))
        if before:
            return min(max(attempt.work / before, 1.0), 8.0)
    return None


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
    if len(complete) == 1 and complete[0].work > MOST_PATIENCE * MOST_WORK:
        return  # what is to tell its error may not take as long
    meshes = {attempt.mesh for attempt in complete}
    if len(meshes) == 1 and history[-1].slow and _work(history) > MOST_WORK:
        # what was to tell the error took far longer than what it is the error of, or had too many waves
        if any(attempt.outcome in WAVES for attempt in history):
            yield _more_damped(history[-1])
        return
    if _is_damped(_finest(complete)) and all(excess.mesh == inf for excess in errors):
        yield from _second_damped(history, _finest(complete), most_intervals)
        return
    if len(complete) == 1 and complete[0].steps != AT_REST:
        mesh, steps = complete[0].mesh, complete[0].steps
        if steps == LOOSEST and complete[0].work > FIRST_PART * MOST_WORK:
            # strands rattle: the meshes differ by far more than shorter steps would change
            if expected(complete, Trial(mesh + 1, steps)) <= (1.0 + OVERDRAWN) * MOST_WORK - _work(history):
                yield Trial(mesh + 1, steps)
            yield Trial(max(mesh - 1, 0), steps)
        if _is_for(history, Trial(mesh, steps + 1), most_intervals):
            yield Trial(mesh, steps + 1)
        yield Trial(max(mesh - 1, 0), max(steps - 1, LOOSEST))  # if it can, the last one is to tell all
    if len(meshes) == 1:
        yield from _second_mesh(history, complete, errors, most_intervals)
        return
    again = _steps_again(complete)
    if again and _is_for(history, again, most_intervals):
        yield again
    if not history[-1].complete:
        yield _beyond_failures(history, most_intervals)
        return
    if _steps_are_untold(complete, errors):
        mesh, steps, *_ = min(complete)
        if _is_for(history, Trial(mesh, steps + 1), most_intervals):
            yield Trial(mesh, steps + 1)
        return
    for excess in sorted(errors, key=lambda excess: -excess.total):
        if excess.total <= 1.0:
            return
        for trial in _finer(_finest(complete), excess, chosen(history).many, diagonal=is_diagonal(history)):
            if _may_do(history, excess, trial, most_intervals):
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
    return all(excess.steps == inf for excess in errors) and not _is_damped(complete[0])


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
    if not longer and len(steps) > 1 and not _is_for(history, finer, most_intervals):
        finer = Trial(finer.mesh, steps[-2])
    if mesh > 0 and not _is_for(history, finer, most_intervals):
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
    if _is_for(history, Trial(finest.mesh + 1, finest.steps), most_intervals):
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
    if last.steps == AT_REST or not (last.slow or last.outcome in WAVES or _is_damped(last)):
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
    wanted = not (last.complete or last.slow or _is_damped(last))
    return finer if wanted and _is_for(history, finer, most_intervals) else None


def _steps_are_dear(complete: Sequence[Attempt], errors: Sequence[Excess]) -> bool:
    """Whether shorter steps took several times the work, as where they follow waves, and more of them would be wanted
    for what is not soon given up."""
    growth = _growth(complete, Trial(0, 1)) or 1.0
    return growth >= DEAR and any(excess.steps > FAR_OFF for excess in errors if excess.worth == inf)


def _no_third_mesh(history: Sequence[Attempt], complete: Sequence[Attempt], errors: Sequence[Excess]) -> bool:
    """Whether shorter steps would leave no work for a third mesh, and what the longer ones are in error is bearable."""
    mesh, steps = complete[0].mesh, max(attempt.steps for attempt in complete)
    work = sum(expected(complete, Trial(mesh + finer, steps)) for finer in (1, 2))
    bearable = all(excess.steps <= FAR_OFF for excess in errors if excess.worth == inf)
    return bearable and _work(history) + work > MOST_WORK


def _finer(best: Attempt, excess: Excess, chain: int, diagonal: bool) -> list[Trial]:
    """Finer resolutions than the finest there is, what is wanted most first. `chain`: meshes that tell its error; with
    other steps there would be two of them."""
    mesh, steps = Trial(best.mesh + 1, best.steps), Trial(best.mesh, best.steps + 1)
    both = Trial(best.mesh + 1, best.steps + 1)
    if grade_of(steps.steps) is None and _is_damped(best):  # without viscosity it did not come to its end
        return [mesh]
    alone = [mesh, steps] if excess.mesh >= excess.steps else [steps, mesh]
    alike = chain < 3 and excess.mesh <= FAR * excess.steps
    diagonal = diagonal and excess.steps > STEP_SHARE
    if diagonal or (alike and excess.mesh > 1.0 - STEP_SHARE and excess.steps > STEP_SHARE):
        return [both, alone[0]]
    return alone[:1]


def _until_one_is_complete(history: Sequence[Attempt], most_intervals: int, t_end: float) -> Trial | None:
    last = history[-1]
    if last.slow and last.steps > LOOSEST:
        return Trial(last.mesh, max(last.steps - 2, LOOSEST))
    crossed = last.outcome == CROSSED and (_is_damped(last) or _was_waited_for(last))
    if crossed and intervals_of(last.mesh + 1) <= most_intervals:
        return Trial(last.mesh + 1, DAMPED)  # nodes were too far apart to press on each other as strands do
    if last.slow or _is_damped(last):
        return _more_damped(last, t_end)
    failed = [attempt for attempt in history if not attempt.slow]
    same = len(failed) > 2 and abs(failed[-1].t - failed[-2].t) <= SAME_TIME * failed[-1].t
    branch_ends = last.steps == AT_REST and len(failed) > 3 and (last.outcome != LOST or last.t > 0.0)
    same = same and (branch_ends or _work(history) > ENOUGH * MOST_WORK)  # a rope may be too limp for coarse meshes
    if same or intervals_of(last.mesh + 1) > most_intervals or _work(history) > MOST_WORK:
        return _more_damped(last)
    if last.outcome == MADE and not any(attempt.mesh == last.mesh for attempt in failed[:-1]):
        return Trial(last.mesh, last.steps + 1)
    return Trial(last.mesh + 1, last.steps)


def _is_for(history: Sequence[Attempt], trial: Trial, most_intervals: int) -> bool:
    """Whether the work that may be done suffices for an attempt."""
    complete = [attempt for attempt in history if attempt.complete]
    return intervals_of(trial.mesh) <= most_intervals and _work(history) + expected(complete, trial) <= MOST_WORK


def _may_do(history: Sequence[Attempt], excess: Excess, trial: Trial, most_intervals: int) -> bool:
    """Whether an attempt can be made, and is cheap or on a way to the tolerance that has an end."""
    if not _is_for(history, trial, most_intervals):
        return False
    complete = [attempt for attempt in history if attempt.complete]
    fall = excess.before / excess.total
    if expected(complete, trial) <= CHEAP * MOST_WORK:
        by_steps = len(complete) > 2 and trial.mesh == complete[-1].mesh == complete[-2].mesh
        return not (by_steps and 1.0 / SAME < fall < SAME)
    if _is_damped(trial):
        return False  # its waves do not converge
    return fall >= LEAST_FALL and _work(history) + _all_of(complete, excess, trial) <= excess.worth * MOST_WORK


def _all_of(complete: Sequence[Attempt], excess: Excess, trial: Trial) -> float:
    """The work of an attempt and of all that are to follow it, if the error falls as it last did, at best to a
    quarter from one to the next."""
    nearest = _finest(complete)
    fall = min(max(excess.before / excess.total, LEAST_FALL), 4.0)
    work = expected(complete, trial)
    growth = max(work / max(nearest.work, 1.0), 1.1)
    many = min(max(ceil(log(max(excess.total, 1.0)) / log(fall)), 1), 20)
    return float(work * (growth**many - 1.0) / (growth - 1.0))


def _work(history: Sequence[Attempt]) -> float:
    return sum(attempt.work for attempt in history)


def to_come(history: Sequence[Attempt], errors: Sequence[Excess], trial: Trial) -> float:
    """The work that is likely to follow an attempt, for the progress."""
    complete = [attempt for attempt in history if attempt.complete]
    remaining = max(MOST_WORK - _work(history), 0.0)
    if not complete:
        return MOST_WORK * FIRST_PART
    work = expected(complete, trial)
    if any(excess.total == inf for excess in errors):
        return min(2.0 * work, remaining)
    wanted = [_all_of(complete, excess, trial) for excess in errors if excess.total > 1.0]
    return min(max(max(wanted, default=work) - work, 0.0), remaining)
