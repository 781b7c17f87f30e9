"""All runs of some scenes, each in one thread, as many at a time as there are cores."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from math import isfinite
from multiprocessing import cpu_count, get_context

from benchmarks.work_precision.measure import Point, Run, Skipped, cheapest
from benchmarks.work_precision.scenes import elastica, goyal, helix, release, thread, vibration
from solver import warm

SCENES = {"elastica": elastica, "vibration": vibration, "release": release, "helix": helix, "goyal": goyal,
          "thread": thread}  # fmt: skip


@cache
def runs_of(scene: str) -> list[Run]:
    """A scene's runs, in a process that has compiled hockle's kernels."""
    for method in ("box", "staggered"):
        warm(method)
    return SCENES[scene].runs()


def points_of(place: tuple[str, int]) -> list[Point]:
    """What a run (its scene, and which of the scene's) was measured to be, a point a quantity."""
    scene, index = place
    run = runs_of(scene)[index]
    try:
        measured = cheapest(run.go)
    except Skipped as reason:
        return [Point(run.scene, "", run.solver, run.resolution, missing=str(reason))]
    if not all(isfinite(m.error) for m in measured.values()):
        return [Point(run.scene, "", run.solver, run.resolution, missing="diverged")]
    return [Point(run.scene, quantity, run.solver, run.resolution, m.cpu, m.error, m.value)
            for quantity, m in measured.items()]  # fmt: skip


def measure(scenes: list[str]) -> Iterator[tuple[str, list[Point]]]:
    """Each scene and its points, told as they are measured."""
    with get_context("spawn").Pool(cpu_count()) as pool:
        for scene in scenes:
            places = [(scene, i) for i in range(len(SCENES[scene].runs()))]
            points = []
            for measured_points in pool.imap(points_of, places):
                for p in measured_points:
                    points.append(p)
                    measured = p.missing or f"{p.cpu:.3g} s, error {p.error:.2e}"
                    print(f"{p.scene}, {p.quantity}, {p.solver}, {p.resolution}: {measured}", flush=True)
            yield scene, points
