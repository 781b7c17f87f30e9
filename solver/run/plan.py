"""Which resolution a run to a tolerance tries next: a pure function of what those before have shown.

A resolution is a mesh of FIRST_INTERVALS 2^mesh intervals and steps whose error relative to their motion is at most
FIRST_STEPS tolerance / 4^steps. The coarsest mesh tells, for next to nothing, what shorter steps would change; finer
meshes follow with the last steps but one that it has been tried with. Whichever error is larger is made smaller, until
both are below the tolerance or the work is done that may be.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import ceil, inf, log2
from typing import NamedTuple

FIRST_INTERVALS = 16
FIRST_STEPS = 16.0
STEP_SHARE = 0.4
"""Part of the tolerance that the error of the steps may take."""
OVERHEAD = 60
"""Intervals that take as long as all else in a Newton iteration."""
MOST_WORK = 1.2e7
"""Newton iterations times (intervals + OVERHEAD), in all, after which nothing is refined: five to ten seconds."""
IN_CONTACT = 6.0
"""How many times more work an iteration is where strands press on each other."""
FIRST_PART = 0.1
"""Part of MOST_WORK that a run may take as long as there is no answer; with longer steps it is tried again."""
LAST_PART = 4.0
"""MOST_WORK that a run with the longest steps may take, where no other came to its end."""
PATIENCE = 8.0
"""How many times the work that is expected of it the first run on a second mesh, or with other steps, may take."""
LOOSEST = -4
"""The longest steps that are tried: their error hardly counts."""
SAME_TIME = 0.02
"""Part of the time at which a run failed, within which another has failed at the same time."""


class Attempt(NamedTuple):
    """A run that was tried: its `mesh` and `steps`, its `work`, the time `t` (s) that it reached, whether it is
    `complete`, whether it was `slow`: given up because it would have taken too long, and the number of its `outcome`
    among all."""

    mesh: int
    steps: int
    work: float
    t: float
    complete: bool
    slow: bool
    outcome: int = 0


class Excess(NamedTuple):
    """The errors of what there is, over the tolerance, infinite where nothing tells them: that of `mesh` number `at`,
    and that of the steps."""

    mesh: float = inf
    steps: float = inf
    at: int = -1


class Trial(NamedTuple):
    """What is to be tried."""

    mesh: int
    steps: int


def intervals_of(mesh: int) -> int:
    """Of a mesh."""
    return int(FIRST_INTERVALS * 2**mesh)


def step_tolerance(steps: int, tolerance: float) -> float:
    """The largest error of a step relative to its motion."""
    return FIRST_STEPS * tolerance / 4.0**steps


def longest_step(steps: int, interval: float) -> float:
    """The longest step (s), where frames are an `interval` apart: waves that two runs damp alike show in neither."""
    return interval / 2.0 ** max(steps, 0)


def chosen(attempts: Sequence[Attempt]) -> tuple[list[int], list[int]]:
    """Which attempts make the frames: up to three meshes of the same steps, coarsest first, and, on the coarsest, up to
    three of different steps, the longest first, which tell the error of the steps.

    Where none is complete, the last two that went as far as they could.
    """
    complete = [i for i, attempt in enumerate(attempts) if attempt.complete]
    if not complete:
        return [i for i, attempt in enumerate(attempts) if not attempt.slow][-2:] or [len(attempts) - 1], []
    best = max(complete, key=lambda i: (attempts[i].mesh, attempts[i].steps))
    steps = attempts[best].steps
    meshes = sorted((i for i in complete if attempts[i].steps == steps), key=lambda i: attempts[i].mesh)
    until = [i for i in step_series(attempts) if attempts[i].steps <= steps + 1]
    return meshes[-3:], until[-3:] if len(until) > 1 else []


def step_series(attempts: Sequence[Attempt]) -> list[int]:
    """The complete attempts on the mesh that has most of them, the coarsest if there are several, those with the
    longest steps first."""
    complete = [i for i, attempt in enumerate(attempts) if attempt.complete]
    meshes = sorted(attempts[i].mesh for i in complete)
    most = max(meshes, key=meshes.count, default=0)
    return sorted((i for i in complete if attempts[i].mesh == most), key=lambda i: attempts[i].steps)


def allowance(history: Sequence[Attempt], trial: Trial) -> float:
    """The work that an attempt may take before it is given up as slow."""
    complete = [attempt for attempt in history if attempt.complete]
    if not complete:
        return MOST_WORK * (FIRST_PART if trial.steps > LOOSEST else LAST_PART)
    left = MOST_WORK - _work(history)
    meshes = {attempt.mesh for attempt in complete}
    if len(complete) == 1 or (len(meshes) == 1 and trial.mesh not in meshes):
        return max(left, PATIENCE * expected(complete, trial))  # without it nothing is known of the error
    return max(left, 0.0)


def expected(complete: Sequence[Attempt], trial: Trial) -> float:
    """The work of an attempt, by the nearest of those before: with the intervals, and the steps by their order."""
    nearest = min(complete, key=lambda attempt: (abs(attempt.mesh - trial.mesh), abs(attempt.steps - trial.steps)))
    finer = (intervals_of(trial.mesh) + OVERHEAD) / (intervals_of(nearest.mesh) + OVERHEAD)
    return float(nearest.work * finer * 1.5 ** max(trial.steps - nearest.steps, 0))


def following(history: Sequence[Attempt], excess: Excess, first_mesh: int, most_intervals: int) -> Trial | None:
    """What to try next; None if what there is must be, or is, enough. Nothing is tried twice."""
    if not history:
        return Trial(first_mesh, 0)
    tried = {(attempt.mesh, attempt.steps) for attempt in history}
    for trial in _wishes(history, excess, most_intervals):
        if trial is None or trial not in tried:
            return trial
    return None


def _wishes(history: Sequence[Attempt], excess: Excess, most_intervals: int) -> Iterator[Trial | None]:
    """What might come next, what is wanted most first."""
    complete = [attempt for attempt in history if attempt.complete]
    if not complete:
        yield _until_one_is_complete(history, most_intervals)
        return
    series = [history[i] for i in step_series(history)]
    mesh, shortest = series[-1].mesh, series[-1].steps
    shorter = Trial(mesh, shortest + 1)
    if len(series) == 1:
        if _is_for(history, shorter, most_intervals):
            yield shorter
        yield Trial(mesh, shortest - 1)
    steps = shortest - 1 if len(series) > 1 else shortest
    if excess.at < 0:
        finer = Trial(max(attempt.mesh for attempt in history) + 1, steps)
        coarser = Trial(mesh - 1, shortest)
        if coarser.mesh >= 0 and not _is_for(history, finer, most_intervals):
            yield coarser
        yield finer if finer.mesh <= mesh + 2 and intervals_of(finer.mesh) <= most_intervals else None
        return
    short = excess.steps > STEP_SHARE and (excess.steps >= 0.5 * excess.mesh or excess.mesh < 1.0 - STEP_SHARE)
    again = Trial(max(excess.at, mesh), steps + 1)
    if short and _is_for(history, shorter, most_intervals) and _is_for(history, again, most_intervals):
        yield shorter
    yield _finer(history, complete, Trial(mesh, steps), excess, most_intervals)


def _until_one_is_complete(history: Sequence[Attempt], most_intervals: int) -> Trial | None:
    last = history[-1]
    if last.slow:
        return Trial(last.mesh, max(last.steps - 2, LOOSEST)) if last.steps > LOOSEST else None
    failed = [attempt for attempt in history if not attempt.slow]
    same = len(failed) > 2 and abs(failed[-1].t - failed[-2].t) <= SAME_TIME * failed[-1].t
    if same or intervals_of(last.mesh + 1) > most_intervals or _work(history) > LAST_PART * MOST_WORK:
        return None
    return Trial(last.mesh + 1, last.steps)


def _finer(history: Sequence[Attempt], complete: Sequence[Attempt], now: Trial, excess: Excess,
           most_intervals: int) -> Trial | None:  # fmt: skip
    """The next mesh with the steps that the coarsest one has by `now`; None if no finer one is needed or to be had."""
    there = sorted(attempt.mesh for attempt in complete if attempt.steps == now.steps)
    wanted = excess.at + max(ceil(0.5 * log2(max(excess.mesh, 1e-9) / (1.0 - STEP_SHARE))), 0)
    tried = max(attempt.mesh for attempt in history if attempt.steps == now.steps)
    if tried > there[-1] or (len(there) > 1 and there[-1] >= wanted):
        return None
    # meshes that were tried with longer steps need not be tried again, but for the one before the last
    skipped = min(wanted, excess.at + 1) - (len(there) == 1)
    trial = Trial(max(there[-1] + 1, skipped), now.steps)
    while not _is_for(history, trial, most_intervals):
        if trial.mesh == there[-1] + 1:
            return None
        trial = Trial(trial.mesh - 1, trial.steps)
    return trial


def _is_for(history: Sequence[Attempt], trial: Trial, most_intervals: int) -> bool:
    """Whether the work that may be done suffices for an attempt."""
    complete = [attempt for attempt in history if attempt.complete]
    return intervals_of(trial.mesh) <= most_intervals and _work(history) + expected(complete, trial) <= MOST_WORK


def _work(history: Sequence[Attempt]) -> float:
    return sum(attempt.work for attempt in history)


def to_come(history: Sequence[Attempt], excess: Excess, trial: Trial, most_intervals: int) -> float:
    """The work that is likely to follow an attempt, for the progress."""
    complete = [attempt for attempt in history if attempt.complete]
    if not complete:
        return MOST_WORK * FIRST_PART
    last = trial.mesh + 1 if excess.at < 0 else excess.at + ceil(0.5 * log2(max(excess.mesh, 1.0)))
    work = 0.0
    for mesh in range(trial.mesh + 1, last + 1):
        each = expected(complete, Trial(mesh, trial.steps))
        if intervals_of(mesh) > most_intervals or _work(history) + work + each > MOST_WORK:
            break
        work += each
    return work
