"""A suture thread, 100 mm long and 0.4 mm thick, whose middle is pulled 10 mm aside.

It cannot stretch, so ends that are both clamped in place would not let it: here each end is clamped in direction and
across, and free to slide along the thread's axis. The guide that pulls holds the middle's direction; the two halves are
then mirror images, and one of them is solved. The speed of 10 mm/s is reached and left smoothly within 50 ms (the first
period is 9 ms), for a jump of the speed has no converged answer in an undamped thread.
"""

from __future__ import annotations

from functools import cache

import numpy as np

from benchmarks.work_precision.measure import PYELASTICA, Measured, Run, Skipped, Stopwatch
from benchmarks.work_precision.peers import pyelastica
from benchmarks.work_precision.scenes.ladder import box, hockle_runs, staggered
from solver import FIXED, FREE, Condition, Curve, End, Initial, Numerics, Rod, Scene, simulate
from solver.arrays import Array

SCENE = "suture thread"
HALF, RADIUS, E, DENSITY = 0.05, 2e-4, 7.5e8, 1300.0
T_END, DAMPING = 2.0, 10.0
"""s, 1/s."""


def _scene(numerics: Numerics) -> Scene:
    pull = Curve.table([0.0, 0.05, 1.0, 1.05], [0.0, 0.01, 0.01, 0.0], "smoothstep")
    middle = End(((Condition("rate", pull),), FIXED, FIXED), (FIXED, FIXED, FIXED), frame="lab")
    held = End((FIXED, FIXED, FREE), (FIXED, FIXED, FIXED), frame="lab")
    rod = Rod.circular(HALF, 2 * RADIUS, E, E / 2.8, DENSITY)
    return Scene(rod, Initial.straight(), middle, held, T_END, 0.25, damping=DAMPING, numerics=numerics, topology=False)


def _solve(numerics: Numerics) -> tuple[Array, float]:
    """Elastic energy of the half (m,) in J at each quarter of a second, and the CPU time (s)."""
    watch = Stopwatch()
    energy = [frame.energy_bending for frame in simulate(_scene(numerics))][1:]
    return np.array(energy), watch.read()


@cache
def reference() -> Array:
    """Extrapolated from two fine runs of the box method, of order 2 in ds."""
    coarse, fine = (_solve(box(n, 0.005, 0.5))[0] for n in (320, 640))
    return (4.0 * fine - coarse) / 3.0


def _judge(numerics: Numerics) -> dict[str, Measured]:
    energy, cpu = _solve(numerics)
    return {"energy": Measured(cpu, float(np.abs(energy / reference() - 1.0).max()), float(energy[-1]))}


def _too_long() -> dict[str, Measured]:
    """What PyElastica would take: its steps are as short as its rod is stiff."""
    raise Skipped(pyelastica.forecast(HALF, RADIUS, E, E / 2.8, DENSITY, 100, T_END))


def runs() -> list[Run]:
    """By hockle; PyElastica's cost is foretold, not paid."""
    boxes = [box(n, dt, 0.5) for n, dt in ((20, 0.05), (40, 0.025), (80, 0.025), (160, 0.0125), (320, 0.0125))]
    staggereds = [staggered(n, 0.1, 1e-2) for n in (20, 40, 80, 160, 320)]
    return [*hockle_runs(SCENE, boxes, staggereds, _judge), Run(SCENE, PYELASTICA, "100 elements", _too_long)]
