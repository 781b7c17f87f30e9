"""Small undamped vibration of a cantilever over five periods: its frequency and its energy."""

from __future__ import annotations

from math import pi

import numpy as np
from scipy.interpolate import CubicSpline

from benchmarks.work_precision.cantilever import Cantilever, Motion, solve
from benchmarks.work_precision.measure import Measured, Run
from benchmarks.work_precision.peers import peers
from benchmarks.work_precision.scenes.ladder import box, hockle_runs, staggered
from solver import Numerics
from validation.cantilever import BENDING, bent

SCENE = "cantilever, 5 periods"
PERIOD, PERIODS = 2 * pi / BENDING[0], 5
EACH = 20
FIXED = 1e9


def cantilever(samples: int) -> Cantilever:
    """Bent in its first mode and let go; so many samples a period."""
    return Cantilever(t_end=PERIODS * PERIOD, samples=samples * PERIODS, shape=bent(0).centreline)


def judge(motion: Motion) -> dict[str, Measured]:
    """Relative errors: of the frequency, between the tip's first and last passage; and the largest of the energy."""
    passages = CubicSpline(motion.t, motion.tip[:, 0]).roots(extrapolate=False)
    frequency = float(pi * (len(passages) - 1) / (passages[-1] - passages[0]))
    energy = motion.energy / motion.energy[0]
    return {
        "frequency": Measured(motion.cpu, abs(frequency / BENDING[0] - 1.0), frequency),
        "energy": Measured(motion.cpu, float(np.abs(energy - 1.0).max()), float(energy[-1])),
    }


def _by_us(numerics: Numerics) -> dict[str, Measured]:
    each = EACH if numerics.tolerance else round(PERIOD / numerics.dt_max)
    return judge(solve(cantilever(each), numerics))


def runs() -> list[Run]:
    """By hockle, sampled at each step, and by its default mode and the peers, sampled twenty times a period."""
    boxes = [box(n, PERIOD / steps) for n, steps in ((10, 20), (20, 40), (40, 80), (80, 160), (160, 320))]
    steps = ((10, 8), (20, 12), (40, 16), (80, 24), (160, 32))
    staggereds = [staggered(n, PERIOD / each, FIXED) for n, each in steps]
    return [*hockle_runs(SCENE, boxes, staggereds, _by_us),
            *peers(SCENE, cantilever(EACH), judge, (5, 10, 20, 30), (10,))]  # fmt: skip
