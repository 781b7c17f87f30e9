"""`python -m benchmarks.in_turn CHECKOUT`: costs of another checkout and of this one, measured in turn; kept.

Each checkout measures by its own benchmarks what it has in common with the other: kernels, scenes, and hockle's own
runs of the work-precision figure. Both run the same row one after the other, several times, and the least counts; what
takes milliseconds is run the more often, as one interruption is as long. Each has two processes that take turns: where
a process's arrays lie in memory is chance, and makes the same run up to a quarter slower for as long as it lives.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Callable
from functools import partial
from pathlib import Path
from time import process_time
from typing import Any

ROOT = Path(__file__).parents[1]
RESULTS = ROOT / "benchmarks" / "results"
PROCESSES, REPEATS = 2, 6
ENOUGH = 1.0
"""Seconds that all repeats of a row shall take together."""
MOST_REPEATS = 50
SLOWER = 1.03
"""The largest ratio that is aimed at."""
Costs = dict[str, float]


class Checkout:
    """A process that measures in a checkout, a group of rows at a time."""

    def __init__(self, folder: Path) -> None:
        environment = os.environ | {"PYTHONPATH": str(folder)}
        environment.pop("NUMBA_CACHE_DIR", None)
        self._process = subprocess.Popen([sys.executable, "-P", __file__], cwd=folder, env=environment, text=True,
                                         stdin=subprocess.PIPE, stdout=subprocess.PIPE)  # fmt: skip
        self.origin, self.groups = self._answer()

    def costs(self, group: str) -> Costs:
        """Of each row of a group."""
        assert self._process.stdin
        print(group, file=self._process.stdin, flush=True)
        return dict(self._answer())

    def close(self) -> None:
        """End the process."""
        assert self._process.stdin
        self._process.stdin.close()
        self._process.wait()

    def _answer(self) -> Any:
        assert self._process.stdout
        return json.loads(self._process.stdout.readline())


def serve() -> None:
    """Measure the groups named on the standard input, in the checkout that is imported, until the input ends."""
    from validation.provenance import provenance

    answers, sys.stdout = sys.stdout, sys.stderr
    measures = groups()
    print(json.dumps([provenance(), list(measures)]), file=answers, flush=True)
    for line in sys.stdin:
        print(json.dumps(measures[line.strip()]()), file=answers, flush=True)


def groups() -> dict[str, Callable[[], Costs]]:
    """What can be measured, by its name."""
    from benchmarks import kernels, scene
    from benchmarks.skipping.scenes import ONE_AXIS, SCENES
    from benchmarks.work_precision.measure import METHODS
    from benchmarks.work_precision.processes import SCENES as FIGURE
    from benchmarks.work_precision.processes import runs_of

    measures: dict[str, Callable[[], Costs]] = {}
    for n in (100, 1000):
        measures[f"an iteration of the box method, N = {n}, us"] = partial(kernels.cost, n)
        measures[f"an iteration of the staggered method, N = {n}, us"] = partial(kernels.staggered_cost, n)
    for n in (100, 400):
        measures[f"goyal-2003 to 32 s, N = {n}, s"] = partial(_seconds, lambda n: scene.run(n)["CPU with frames"], n)
    for name, make in (SCENES | ONE_AXIS).items():
        for method in ("box", "staggered"):
            measures[f"{name}, {method}, s"] = partial(_simulated, make, method)
    for scene_name in FIGURE:
        for i, run in enumerate(runs_of(scene_name)):
            if run.solver in METHODS:
                measures[f"{scene_name}, {run.solver}, {run.resolution}, s"] = partial(_figured, runs_of, scene_name, i)
    return measures


def _seconds(measure: Callable[[Any], float], of: Any) -> Costs:
    return {"CPU": measure(of)}


def _simulated(make: Callable[[str], Any], method: str) -> Costs:
    from solver import simulate

    scene, started = make(method), process_time()
    for _ in simulate(scene):
        pass
    return {"CPU": process_time() - started}


def _figured(runs_of: Any, scene: str, i: int) -> Costs:
    from benchmarks.work_precision.measure import Skipped

    try:
        return {"CPU": max(measured.cpu for measured in runs_of(scene)[i].go().values())}
    except Skipped:  # as the figure does: the paper's method fails on some of its meshes
        return {}


Checkouts = list[Checkout]
"""The processes of one checkout."""


def compared(before: Checkouts, after: Checkouts, group: str) -> list[tuple[str, float, float]]:
    """The least cost of each row of a group that both have, before and after."""
    measured: list[tuple[Costs, Costs]] = []
    while len(measured) < REPEATS or (len(measured) < MOST_REPEATS and _cost(measured) < ENOUGH):
        turn = len(measured) % PROCESSES
        measured.append((before[turn].costs(group), after[turn].costs(group)))
    rows = [name for name in measured[0][0] if name in measured[0][1] and name != "intervals"]
    return [(name, *(min(costs[side][name] for costs in measured) for side in (0, 1))) for name in rows]


def _cost(measured: list[tuple[Costs, Costs]]) -> float:
    return sum(sum(costs.values()) for _, costs in measured)


def main(other: Path) -> None:
    """Measure, print and keep."""
    before, after = ([Checkout(folder) for _ in range(PROCESSES)] for folder in (other, ROOT))
    lines = ["# Before and after", "", *(f"- before: {line}" for line in before[0].origin),
             *(f"- after: {line}" for line in after[0].origin), "",
             f"Both in turn, {PROCESSES} processes each, the least of {REPEATS}, or of as many as take {ENOUGH:g} s, "
             f"{MOST_REPEATS} at the most. Aim: no ratio above {SLOWER}.", "",
             "| | before | after | ratio |", "| --- | ---: | ---: | ---: |"]  # fmt: skip
    print("\n".join(lines), flush=True)
    records = []
    for group in (name for name in after[0].groups if name in before[0].groups):
        for name, old, new in compared(before, after, group):
            records.append({"group": group, "row": name, "before": old, "after": new})
            shown = group if name == "CPU" else f"{group}: {name}"
            lines.append(f"| {shown} | {old:.3g} | {new:.3g} | {new / old:.2f} |")
            print(lines[-1], flush=True)
    for checkout in (*before, *after):
        checkout.close()
    (RESULTS / "in_turn.md").write_text("\n".join([*lines, ""]), encoding="utf-8")
    (RESULTS / "in_turn.json").write_text(json.dumps(records, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1]).absolute()) if sys.argv[1:] else serve()
