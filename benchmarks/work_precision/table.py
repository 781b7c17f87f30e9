"""The tables: all points, work at equal error, agreement of the methods."""

from __future__ import annotations

from collections.abc import Iterable
from math import inf, nan

from benchmarks.work_precision.measure import AS_IT_COMES, BOX, METHODS, PYELASTICA, STAGGERED, STATICS, Point

OURS = (BOX, STAGGERED, STATICS)
AIM = {PYELASTICA: 100.0}
"""Times less CPU than a peer at equal error; than any other, less."""


def panels(points: Iterable[Point]) -> dict[tuple[str, str], list[Point]]:
    """The points of each scene and quantity; a run that was not made counts for all quantities of its scene."""
    points = list(points)
    keys = dict.fromkeys((p.scene, p.quantity) for p in points if not p.missing)
    return {key: [p for p in points if p.scene == key[0] and p.quantity in (key[1], "")] for key in keys}


def work(points: list[Point], solver: str, error: float) -> float:
    """The least CPU time (s) with which a solver was measured to reach an error; infinite if it was not."""
    return min((p.cpu for p in points if p.solver == solver and p.error <= error), default=inf)


def results(points: Iterable[Point]) -> list[str]:
    """Every point, or why there is none."""
    lines = ["## Every run", "", "| scene | quantity | solver | resolution | CPU s | error |",
             "| --- | --- | --- | --- | ---: | ---: |"]  # fmt: skip
    for p in points:
        measured = p.missing + " |" if p.missing else f"{p.cpu:.3g} | {p.error:.2e}"
        lines.append(f"| {p.scene} | {p.quantity} | {p.solver} | {p.resolution} | {measured} |")
    return [*lines, ""]


def at_equal_error(points: Iterable[Point]) -> list[str]:
    """CPU of each peer's best run over that of hockle's cheapest run with no larger error."""
    lines = ["## Times less CPU than the peers", "",
             "CPU time from the scene to its frames, the construction of simulators and models included, for all. "
             "Against hockle's cheapest run whose error is no larger than the peer's; least and largest over its runs.",
             "", "| scene | quantity | peer | its smallest error | its CPU s | hockle | least | largest | aim |",
             "| --- | --- | --- | ---: | ---: | --- | ---: | ---: | ---: |"]  # fmt: skip
    for (scene, quantity), all_points in panels(points).items():
        for peer in dict.fromkeys(p.solver for p in all_points if p.solver not in METHODS):
            theirs = [p for p in all_points if p.solver == peer and not p.missing]
            if not theirs:
                lines.append(f"| {scene} | {quantity} | {peer} | no run in the bound | | | | | |")
                continue
            ratios = [p.cpu / min(work(all_points, m, p.error) for m in OURS) for p in theirs]
            best = min(theirs, key=lambda p: p.error)
            method = min(OURS, key=lambda m: work(all_points, m, best.error))
            ours = f"{method}, {work(all_points, method, best.error):.3g} s"
            aim = AIM.get(peer.removesuffix(AS_IT_COMES), 1.0)
            lines.append(f"| {scene} | {quantity} | {peer} | {best.error:.1e} | {best.cpu:.3g} | {ours} | "
                         f"{min(ratios):.3g} | {max(ratios):.3g} | {aim:g} |")  # fmt: skip
    return [*lines, ""]


def summary(points: Iterable[Point]) -> list[str]:
    """Scenes by solvers: CPU to the best error that both box and staggered reach; the cheapest, against the next."""
    lines = ["## CPU s to an error that both methods reach", "",
             "| scene | quantity | error | " + " | ".join(METHODS) + " | better |",
             "| --- | --- | ---: |" + " ---: |" * len(METHODS) + " --- |"]  # fmt: skip
    for (scene, quantity), all_points in panels(points).items():
        best = [min((p.error for p in all_points if p.solver == m and not p.missing), default=nan)
                for m in (BOX, STAGGERED)]  # fmt: skip
        error = max(best)
        costs = {method: work(all_points, method, error) for method in METHODS}
        first, second = sorted(OURS, key=lambda m: costs[m])[:2]
        shown = " | ".join("not reached" if c == inf else f"{c:.3g}" for c in costs.values())
        factor = costs[second] / costs[first]
        lines.append(f"| {scene} | {quantity} | {error:.1e} | {shown} | {first}, {factor:.2g} times |")
    return [*lines, ""]


def agreement(points: Iterable[Point]) -> list[str]:
    """The finest values of both methods, what the last refinement changed of them, and whether these bars meet."""
    lines = ["## Agreement of the methods", "",
             "Error bar: what the last refinement changed.", "",
             "| scene | quantity | box | staggered | difference | within the bars |",
             "| --- | --- | ---: | ---: | ---: | --- |"]  # fmt: skip
    for (scene, quantity), all_points in panels(points).items():
        values, bars = [], []
        for method in (BOX, STAGGERED):
            found = [p.value for p in all_points if p.solver == method and not p.missing]
            values.append(found[-1] if found else nan)
            bars.append(abs(found[-1] - found[-2]) if len(found) > 1 else nan)
        gap = abs(values[0] - values[1])
        shown = " | ".join(f"{v:.8g} ± {b:.1e}" for v, b in zip(values, bars, strict=True))
        lines.append(f"| {scene} | {quantity} | {shown} | {gap:.1e} | {'yes' if gap <= sum(bars) else 'no'} |")
    return [*lines, ""]
