"""CPU time of the default mode against its true error, paper's scene before contact: `python -m benchmarks.tolerances`.

The truth is that of three fine meshes, extrapolated, whose steps follow even the torsional waves that the start sets
off: these are 1e-6 of the largest curvature, and attempts at a tolerance do not follow them.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import replace
from math import inf
from pathlib import Path
from time import process_time
from typing import Any

import numpy as np

from service.cases.build import build_scene
from service.cases.library import apply_settings, load_case, parse_case
from solver import Numerics, Scene, simulate
from solver.arrays import Array
from solver.run.accuracy import QUANTITIES, errors_of, sizes
from solver.run.recording import Columns, columns_of, row_of
from solver.run.richardson import extrapolate
from validation.provenance import provenance

RESULTS = Path(__file__).parent / "results"
T_END = 25.0
TOLERANCES = (3e-2, 1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 3e-5, 1e-5, 3e-6, 1e-6)
AIMS = {1e-3: 0.4, 1e-4: 0.6, 1e-5: 1.2, 1e-6: 3.0}
"""CPU time (s) in which the largest true error of `QUANTITIES` is to be no more than this."""
FINE = Numerics("staggered", dt_max=0.00625, increment_tolerance=1e-6)
MESHES = (128, 256, 512)
REPEATS, CHEAP = 3, 2.0
"""The cheapest of so many runs counts, where one takes less than that (s)."""


def scene() -> Scene:
    """goyal-2003 until just before it touches itself, with its own frames."""
    return build_scene(parse_case(apply_settings(load_case("goyal-2003"), {"t_end": T_END})))


def judged(run: Scene) -> Columns:
    """The frames' columns that a tolerance is for."""
    return columns_of(np.array([row_of(frame) for frame in simulate(run)]), judged=True)


def truth(whole: Scene) -> tuple[Columns, Columns]:
    """The extrapolated solution of the fine meshes, and its estimated error."""
    meshes = [judged(replace(whole, numerics=replace(FINE, intervals=n))) for n in MESHES]
    values, errors = zip(*(extrapolate(series, [2, 2]) for series in zip(*meshes, strict=True)), strict=True)
    return Columns(*values), Columns(*errors)


def apart(columns: Columns, true: Columns) -> Columns:
    """By how much outputs differ at the nodes that both have."""
    coarse, fine = columns.along.shape[1] - 1, true.along.shape[1] - 1
    nodes = np.gcd(coarse, fine)
    along = columns.along[:, :: coarse // nodes] - true.along[:, :: fine // nodes]
    return Columns(np.abs(along), np.abs(columns.numbers - true.numbers))


def largest(error: Columns, size: Array) -> dict[str, float]:
    """Of `QUANTITIES` the largest error of all frames."""
    return dict(zip(QUANTITIES, map(float, errors_of(error, size).max(axis=0)), strict=True))


def measure(whole: Scene, tolerance: float, true: Columns, size: Array) -> dict[str, Any]:
    """CPU time (s) of the default mode at a tolerance, its meshes, and its errors: true, and as it tells them."""
    resolved, cpu = replace(whole, numerics=Numerics("staggered", tolerance=tolerance)), inf
    for _ in range(REPEATS):
        started = process_time()
        run = simulate(resolved)
        rows = np.array([row_of(frame) for frame in run])
        cpu = min(cpu, process_time() - started)
        if cpu > CHEAP:
            break
    assert run.accuracy is not None
    errors = largest(apart(columns_of(rows, judged=True), true), size)
    return {"tolerance": tolerance, "cpu_s": cpu, "intervals": len(run.s) - 1, "true": errors,
            "told": run.accuracy.errors}  # fmt: skip


def reached(rows: Sequence[dict[str, Any]], error: float) -> dict[str, Any] | None:
    """The cheapest row whose true errors are no more than this."""
    good = [row for row in rows if max(row["true"].values()) <= error]
    return min(good, key=lambda row: row["cpu_s"], default=None)


def report(results: dict[str, Any]) -> str:
    """The table of all runs, and what is aimed at."""
    head = ("tolerance", "CPU s", "intervals", *(f"{name}: true" for name in QUANTITIES),
            *(f"{name}: told" for name in QUANTITIES))  # fmt: skip
    lines = ["# True error of the default mode", "", *(f"- {line}" for line in results["made with"]), "",
             " ".join((__doc__ or "").split("\n\n")[1].split()), "",
             f"| {' | '.join(head)} |", f"| {' | '.join(['---:'] * len(head))} |"]  # fmt: skip
    for row in results["rows"]:
        errors = [f"{row[kind][name]:.1e}" for kind in ("true", "told") for name in QUANTITIES]
        lines.append(f"| {row['tolerance']:.0e} | {row['cpu_s']:.3g} | {row['intervals']} | {' | '.join(errors)} |")
    bars = ", ".join(f"{name} {error:.0e}" for name, error in results["truth"].items())
    lines += ["", f"The truth's own errors, as its meshes tell them: {bars}.", ""]
    return "\n".join(lines)


def main() -> None:
    """Measure, print and keep."""
    whole = scene()
    true, bars = truth(whole)
    size = sizes(whole, [true])
    rows = [measure(whole, tolerance, true, size) for tolerance in TOLERANCES]
    results = {"made with": provenance(), "truth": largest(bars, size), "rows": rows}
    (RESULTS / "tolerances.json").write_text(json.dumps(results, indent=1) + "\n", encoding="utf-8")
    text = report(results)
    (RESULTS / "tolerances.md").write_text(text, encoding="utf-8")
    print(text)


if __name__ == "__main__":
    main()
