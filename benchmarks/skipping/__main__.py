"""`python -m benchmarks.skipping`: CPU time of scenes that lack a feature, over that of a build without it; kept."""

from __future__ import annotations

import json
import os
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from pathlib import Path

from benchmarks.skipping.builds import WITHOUT, Build, build
from benchmarks.skipping.scenes import ONE_AXIS, SCENES
from validation.provenance import provenance

RESULTS = Path(__file__).parents[1] / "results"
BOTH = ("box", "staggered")
LACKING: dict[str, tuple[tuple[str, ...], tuple[str, ...], float]] = {
    "contact": (tuple(SCENES), BOTH, 1.02), "fluid": (tuple(SCENES)[2:], BOTH, 1.02),
    "loads": (tuple(SCENES)[2:], BOTH, 1.02), "turning in space": (tuple(ONE_AXIS), BOTH[1:], 0.7),
}  # fmt: skip
"""By feature the scenes that do not need it, the methods, and the largest ratio that is aimed at."""
REPEATS = 25
HOW = """\
A feature is left out by making its tests false in a copy of the sources, which the compiler then drops. Both builds
run in turn, and the least CPU time of either counts; frames, energies and the smallest gap are included. Turning in
space is what the whole build leaves out by itself, where a scene turns about one axis: there the other build does more,
and a ratio below 1 is what is saved."""


def ratio(whole: Build, without: Build, scene: str, method: str) -> tuple[float, float]:
    """CPU time (s) of a run by the whole build, and its ratio to that of the build without the feature."""
    times = [(whole.cpu(scene, method), without.cpu(scene, method)) for _ in range(REPEATS + 1)][1:]
    with_it, without_it = (min(series) for series in zip(*times, strict=True))
    return with_it, with_it / without_it


def warm(builds: list[Build]) -> None:
    """Have each build compile its kernels, as many at once as there are cores."""
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        list(pool.map(lambda build: [build.cpu(next(iter(SCENES)), method) for method in BOTH], builds))


def main() -> None:
    """Measure, print and keep."""
    rows = []
    lines = ["| feature | scene | method | CPU s | ratio | aim |", "| --- | --- | --- | ---: | ---: | ---: |"]
    print("\n".join(lines), flush=True)
    with ExitStack() as cleanup:
        builds = {without: cleanup.enter_context(build(without)) for without in WITHOUT}
        warm(list(builds.values()))
        for feature, (scenes, methods, aim) in LACKING.items():
            for scene in scenes:
                for method in methods:
                    cpu, measured = ratio(builds[""], builds[feature], scene, method)
                    rows.append({"feature": feature, "scene": scene, "method": method, "cpu_s": cpu, "ratio": measured,
                                 "aim": aim})
                    lines.append(f"| {feature} | {scene} | {method} | {cpu:.3f} | {measured:.3f} | {aim} |")
                    print(lines[-1], flush=True)
    origin = [f"- {line}" for line in provenance()]
    text = "\n".join(["# What is not needed", "", *origin, "", HOW, "", *lines, ""])
    (RESULTS / "skipping.md").write_text(text, encoding="utf-8")
    results = {"made with": provenance(), "rows": rows}
    (RESULTS / "skipping.json").write_text(json.dumps(results, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
