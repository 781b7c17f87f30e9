"""`python -m benchmarks.skipping`: CPU time of scenes that lack a feature, over that of a build without it; kept."""

from __future__ import annotations

from contextlib import ExitStack
from pathlib import Path

from benchmarks.skipping.builds import WITHOUT, Build, build
from benchmarks.skipping.scenes import SCENES
from validation.provenance import provenance

RESULTS = Path(__file__).parents[1] / "results" / "skipping.md"
LACKING = {"contact": tuple(SCENES), "fluid": tuple(SCENES)[2:], "loads": tuple(SCENES)[2:]}
"""The scenes that do not need a feature."""
AIM = 1.02
REPEATS = 25
HOW = """\
A feature is left out by making its tests false in a copy of the sources, which the compiler then drops. Both builds
run in turn, and the least CPU time of either counts; frames, energies and the smallest gap are included."""


def ratio(whole: Build, without: Build, scene: str, method: str) -> tuple[float, float]:
    """CPU time (s) of a run by the whole build, and its ratio to that of the build without the feature."""
    times = [(whole.cpu(scene, method), without.cpu(scene, method)) for _ in range(REPEATS + 1)][1:]
    mine, other = (min(series) for series in zip(*times, strict=True))
    return mine, mine / other


def main() -> None:
    """Measure, print and keep."""
    lines = ["| feature | scene | method | CPU s | ratio | aim |", "| --- | --- | --- | ---: | ---: | ---: |"]
    print("\n".join(lines), flush=True)
    with ExitStack() as cleanup:
        builds = {without: cleanup.enter_context(build(without)) for without in WITHOUT}
        for feature, scenes in LACKING.items():
            for scene in scenes:
                for method in ("box", "staggered"):
                    cpu, found = ratio(builds[""], builds[feature], scene, method)
                    lines.append(f"| {feature} | {scene} | {method} | {cpu:.3f} | {found:.3f} | {AIM} |")
                    print(lines[-1], flush=True)
    told = [f"- {line}" for line in provenance()]
    RESULTS.write_text("\n".join(["# What is not needed", "", *told, "", HOW, "", *lines, ""]), encoding="utf-8")


if __name__ == "__main__":
    main()
