"""Large undamped motion in three dimensions: rod R, curled out of its plane, clamped at its start and let go."""

from __future__ import annotations

from functools import cache

import numpy as np

from benchmarks.work_precision.cantilever import Cantilever, Motion, solve
from benchmarks.work_precision.measure import Measured, Run
from benchmarks.work_precision.peers import peers
from benchmarks.work_precision.scenes.ladder import box, hockle_runs, staggered
from solver.arrays import Array
from validation.free_flight import curled
from validation.rods import LENGTH

SCENE = "release of a curled rod, 1 s"
CANTILEVER = Cantilever(t_end=1.0, samples=10, shape=curled)


@cache
def reference() -> Array:
    """The tip (m, 3) in m, extrapolated from two fine runs of the staggered method, of order 2 in ds."""
    coarse, fine = (solve(CANTILEVER, staggered(n, 0.01, 1e9)).tip for n in (160, 320))
    return np.asarray((4.0 * fine - coarse) / 3.0)


def judge(motion: Motion) -> dict[str, Measured]:
    """The largest distance of the tip from where it should be, in L."""
    error = np.linalg.norm(motion.tip - reference(), axis=1).max() / LENGTH
    return {"tip": Measured(motion.cpu, float(error), float(motion.tip[-1, 2] / LENGTH))}


def runs() -> list[Run]:
    """By hockle and the peers."""
    boxes = [box(n, 1.0 / n, 0.9) for n in (10, 14, 20, 28, 40, 56, 80, 160)]
    staggereds = [staggered(n, 1.0, 0.1) for n in (10, 14, 20, 28, 40, 56, 80, 160)]
    return [
        *hockle_runs(SCENE, boxes, staggereds, lambda numerics: judge(solve(CANTILEVER, numerics))),
        *peers(SCENE, CANTILEVER, judge, (10, 20, 30, 40, 60), (10, 20, 40)),
    ]
