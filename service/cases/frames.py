"""Too few frames to see what the rod does, and a last one that tells nothing new."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from typing import Any

import numpy as np

from service.cases.case import CaseSpec
from service.cases.errors import FieldError
from service.cases.quantities import ScheduleTable
from service.cases.size import tables_in
from service.cases.stability import slowest_swing
from solver import Scene
from solver.measures.buckling import stays_straight

LONG_RUN, STILL = 200.0, 1.0
"""Periods of a swing after which a run is likely not about it; and the damping (1/s), in the frequency of a swing in
1/s, with which it soon swings no more."""
SLIVER = 0.01
"""Part of the interval from which on a last frame may tell something new."""


def frames_of(spec: CaseSpec, scene: Scene) -> list[FieldError]:
    """What frames that are far apart do not show, and the last one if it is next to none."""
    return [*([*_frames(spec)] or _swings(spec, scene)), *_last(spec)]


def _last(spec: CaseSpec) -> Iterator[FieldError]:
    """A last frame right after the one before, as of an interval that was rounded."""
    interval, many = spec.output.interval, spec.frames - 2
    rest = spec.t_end - many * interval
    if many > 0 and rest < SLIVER * interval:
        rule = (f"leaves the last frame, at t_end, {rest:.2g} s after the one before: {spec.t_end / many:.12g} leaves "
                "none")  # fmt: skip
        yield FieldError("/output/interval", interval, rule)


def _swings(spec: CaseSpec, scene: Scene) -> Iterator[FieldError]:
    """Too few frames for a rod that is let go, and swings about where an end holds it, as a beam or a string does."""
    tables = [table for part in (spec.ends, spec.loads) for _, table in tables_in(part)]
    driven = any(isinstance(table, ScheduleTable) for table in tables)
    held = any(c[0].kind != "load" for end in (scene.start, scene.end) for c in end.translation)
    if scene.at_rest or driven or not held or stays_straight(scene):
        return
    period = slowest_swing(scene)
    if spec.output.interval > period > scene.t_end / LONG_RUN and scene.damping_rate * period < STILL:
        rule = (f"is longer than {period:.2g} s, in which the rod swings to and fro once by itself: the frames cannot "
                "show how")  # fmt: skip
        yield FieldError("/output/interval", spec.output.interval, rule)


def _frames(spec: CaseSpec) -> Iterator[FieldError]:
    """Too few frames to see a schedule go up and down."""
    periods = [period for part in ("ends", "loads") for period in _periods(getattr(spec, part), f"/{part}")]
    shortest, where = min(periods, default=(np.inf, ""))
    if spec.output.interval > shortest:
        rule = f"is longer than {shortest:.3g} s, in which {where} goes up and down: the frames cannot show it"
        yield FieldError("/output/interval", spec.output.interval, rule)


def _periods(part: Any, pointer: str) -> Iterator[tuple[float, str]]:
    """The shortest time between two maxima, or two minima, of each schedule below a part; and where it is."""
    for where, table in tables_in(part, pointer):
        if isinstance(table, ScheduleTable):
            steps = np.diff(table.value)
            changing = np.flatnonzero(steps)
            turns = [table.t[j] for i, j in pairwise(changing) if steps[i] * steps[j] < 0.0]
            yield from ((late - early, where) for early, late in zip(turns, turns[2:], strict=False))
