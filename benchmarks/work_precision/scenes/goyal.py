"""The paper's scene, goyal-2003, to 25 s (before contact) and to 32 s (loop closed and intertwining).

The peers have neither added mass across the rod only nor Morison's drag: not run.
"""

from __future__ import annotations

from dataclasses import replace

from benchmarks.work_precision.measure import Measured, Run, Stopwatch
from benchmarks.work_precision.scenes.ladder import box, hockle_runs, staggered
from service.cases.build import build_scene
from service.cases.library import apply_settings, load_case, parse_case
from solver import Numerics, simulate
from validation.goyal import REFERENCE

SCENE = "goyal-2003"
TIMES = (25.0, 32.0)


def solve(numerics: Numerics) -> dict[str, Measured]:
    """Error of Wr at both times, and the time it took to get there, a frame each second."""
    settings = {"t_end": TIMES[-1], "output.interval": 1.0}
    scene = replace(build_scene(parse_case(apply_settings(load_case("goyal-2003"), settings))), numerics=numerics)
    measured, watch = {}, Stopwatch()
    for frame in simulate(scene):
        for t in TIMES:
            if abs(frame.t - t) < 1e-9:
                reference = REFERENCE["values"]["Wr"][f"{t:g}"]
                measured[f"Wr({t:g} s)"] = Measured(watch.read(), abs(frame.Wr - reference), frame.Wr)
    return measured


def runs() -> list[Run]:
    """By hockle."""
    boxes = [box(n, dt, 0.5, 0.1) for n, dt in ((50, 0.2), (100, 0.1), (100, 0.05), (200, 0.025), (400, 0.0125))]
    meshes = ((50, 1e-2), (100, 1e-3), (200, 1e-3), (200, 1e-4), (400, 1e-4))
    return hockle_runs(SCENE, boxes, [staggered(n, 0.5, tolerance) for n, tolerance in meshes], solve)
