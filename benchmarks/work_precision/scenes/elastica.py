"""The static elastica: rod R under a tip load of 5 EI/L^2. The statics solve for it, all others damp it to rest."""

from __future__ import annotations

from functools import partial

import numpy as np

from benchmarks.work_precision.cantilever import Cantilever, Motion, solve
from benchmarks.work_precision.measure import STATICS, Measured, Run, Stopwatch
from benchmarks.work_precision.peers import peers
from benchmarks.work_precision.scenes.ladder import box, hockle_runs, or_outcome, staggered
from solver import Numerics
from validation.elastica import exact
from validation.rods import EJ, LENGTH
from validation.statics import elastica

SCENE = "static elastica"
ALPHA = 5.0
CANTILEVER = Cantilever(t_end=20.0, samples=1, tip_force=ALPHA * EJ / LENGTH**2, ramp=4.0, damping=1.6)
"""Critical damping is twice the first frequency, 0.8 rad/s: it leaves 3e-6 of the motion, and no solver is favoured."""


def judge(motion: Motion) -> dict[str, Measured]:
    """The larger of the errors of both components of the tip's displacement, in L."""
    deflection, shortening, _ = exact(ALPHA)
    across, along = motion.tip[-1, 0] / LENGTH, 1.0 - motion.tip[-1, 2] / LENGTH
    return {"tip": Measured(motion.cpu, max(abs(across - deflection), abs(along - shortening)), across)}


def _static(numerics: Numerics) -> dict[str, Measured]:
    watch = Stopwatch()
    deflection, shortening, _ = elastica(ALPHA, numerics.intervals)
    tip = np.array([[deflection, 0.0, 1.0 - shortening]]) * LENGTH
    return judge(Motion(np.zeros(1), tip, np.zeros(1), watch.read()))


def runs() -> list[Run]:
    """By hockle and the peers."""
    boxes = [box(n, 1.0, 0.5) for n in (10, 20, 40, 80, 160)]
    staggereds = [staggered(n, 2.5, 1e-2) for n in (10, 20, 40, 80, 160)]
    elastica(ALPHA, 4)  # compiles what the statics need
    statics = [Run(SCENE, STATICS, f"N {n}", partial(or_outcome, _static, Numerics(intervals=n)))
               for n in (10, 20, 40, 80, 160)]  # fmt: skip
    return [
        *statics,
        *hockle_runs(SCENE, boxes, staggereds, lambda numerics: judge(solve(CANTILEVER, numerics))),
        *peers(SCENE, CANTILEVER, judge, (10, 20, 40, 80), (20,)),
    ]
