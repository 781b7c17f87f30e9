"""`python -m benchmarks`: print the costs beside their aims, and keep them in results/ as text and JSON."""

from __future__ import annotations

import json
from collections.abc import Iterable
from math import nan
from pathlib import Path

import numpy as np

from benchmarks import kernels, scene
from solver.measures.topology import writhe
from validation.provenance import provenance
from validation.writhe import open_curve

RESULTS = Path(__file__).parent / "results"


def markdown(title: str, rows: Iterable[dict[str, float]]) -> list[str]:
    """A table of rows with the same keys."""
    rows = list(rows)
    lines = [f"## {title}", "", "| " + " | ".join(rows[0]) + " |", "|" + " ---: |" * len(rows[0])]
    lines += ["| " + " | ".join(_number(value) for value in row.values()) + " |" for row in rows]
    return [*lines, ""]


def _number(value: float) -> str:
    if value != value:
        return ""
    return f"{value:.0f}" if abs(value) >= 100 or float(value).is_integer() else f"{value:.3g}"


def writhe_cost(intervals: int) -> dict[str, float]:
    """CPU time (us) of the writhe of one frame."""
    curve, tangents = np.ascontiguousarray(open_curve(intervals)), np.array([[0.0, 0.0, 1.0]] * 2)
    cost = kernels.best(lambda: writhe(curve, tangents))
    return {"intervals": float(intervals), "writhe": cost, "aim": kernels.WRITHE_AIM_US.get(intervals, nan)}


def _beside_aim(row: dict[str, float]) -> dict[str, float]:
    return row | {"aim": kernels.AIM_US.get(int(row["intervals"]), nan)}


def main() -> None:
    """Measure, print and keep."""
    iterations = [_beside_aim(row) for row in kernels.table()]
    staggered = [_beside_aim(row) for row in kernels.staggered_table()]
    scenes = [row | {"aim": scene.AIM_S.get(int(row["intervals"]), nan)} for row in scene.table()]
    writhes = [writhe_cost(intervals) for intervals in kernels.INTERVALS]
    compiling = [scene.compilation()]
    text = [f"- {line}" for line in provenance()] + [""]
    text += markdown("One Newton iteration of the box method, CPU us", iterations)
    text += markdown("One Newton iteration of the staggered method, three stages, CPU us", staggered)
    text += markdown("goyal-2003 to 32 s, dt_max 0.1 s, CPU s", scenes)
    text += markdown("Writhe of a frame, CPU us", writhes)
    text += markdown("With and without compiled kernels in the cache, N = 100, CPU s", compiling)
    print("\n".join(text))
    RESULTS.mkdir(exist_ok=True)
    (RESULTS / "last.md").write_text("\n".join(text), encoding="utf-8")
    results = {"made with": provenance(), "iteration_us": iterations, "staggered_us": staggered,
               "scene_s": scenes, "writhe_us": writhes, "compilation_s": compiling}  # fmt: skip
    (RESULTS / "last.json").write_text(json.dumps(results, indent=1).replace("NaN", "null") + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
