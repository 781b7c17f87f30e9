"""CPU time of the paper's scene to 32 s, and of compiling the kernels when nothing is cached."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from pathlib import Path
from time import process_time

from service.cases.build import build_scene
from service.cases.library import apply_settings, load_case, parse_case
from solver import simulate

INTERVALS = (100, 200, 400, 1000)
AIM_S = {100: 0.3, 1000: 1.5}
SECOND_START_AIM_S = 2.0


def run(intervals: int, t_end: float = 32.0) -> dict[str, float]:
    """Run goyal-2003 with dt_max 0.1 s; CPU time (s) with its frames, and the solver's own count."""
    settings = {"numerics.intervals": intervals, "numerics.dt_max": 0.1, "t_end": t_end}
    scene = build_scene(parse_case(apply_settings(load_case("goyal-2003"), settings)))
    started = process_time()
    simulation = simulate(scene)
    for _ in simulation:
        pass
    cpu = process_time() - started
    counted = simulation.statistics
    return {
        "intervals": float(intervals), "CPU with frames": cpu, "CPU stepping": counted.cpu_time,
        "steps": counted.steps, "failed": counted.failed_steps, "iterations": counted.newton_iterations,
    }  # fmt: skip


def table(repeats: int = 3) -> list[dict[str, float]]:
    """Rows for all N, the best of several runs each."""
    run(100, 30.0)
    return [min((run(n) for _ in range(repeats)), key=lambda row: row["CPU with frames"]) for n in INTERVALS]


def compilation() -> dict[str, float]:
    """CPU time (s) of a first run to 32 s, N = 100, in a process of its own with an empty cache, then of a second, at
    which the aim is; that of the process that compiles included."""
    program = "import os; from benchmarks.scene import run; run(100); print(sum(os.times()[:4]))"
    times = []
    with tempfile.TemporaryDirectory() as cache:
        environment = {k: v for k, v in os.environ.items() if k != "NUMBA_CACHE_DIR"} | {"XDG_CACHE_HOME": cache}
        for _ in range(2):
            process = subprocess.run([sys.executable, "-c", program], cwd=Path(__file__).parent.parent, env=environment,
                                     capture_output=True, text=True, check=True)  # fmt: skip
            times.append(float(process.stdout.splitlines()[-1]))
    return {"first process": times[0], "second process": times[1], "compilation": times[0] - times[1],
            "aim": SECOND_START_AIM_S}
