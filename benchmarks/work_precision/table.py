"""The tables: all points, work at equal error, agreement of the methods."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from math import inf, nan

from benchmarks.work_precision.measure import AS_IT_COMES, BOX, DEFAULT, METHODS, PYELASTICA, STAGGERED, STATICS, Point

OURS = (BOX, STAGGERED, STATICS, DEFAULT)
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


@dataclass(frozen=True)
class Comparison:
    """A peer in a scene: its best run, hockle's cheapest that is no worse, and times less CPU over its runs."""

    scene: str
    quantity: str
    peer: str
    best: Point
    method: str
    cpu: float
    least: float
    most: float

    @property
    def aim(self) -> float:
        """How many times less CPU is aimed at."""
        return AIM.get(self.peer.removesuffix(AS_IT_COMES), 1.0)


def comparisons(points: Iterable[Point]) -> Iterator[Comparison | tuple[str, str, str]]:
    """Every peer in every scene that it was run in; its names only, where no run of it was within the bound."""
    for (scene, quantity), all_points in panels(points).items():
        for peer in dict.fromkeys(p.solver for p in all_points if p.solver not in METHODS):
            peer_points = [p for p in all_points if p.solver == peer and not p.missing]
            if not peer_points:
                yield scene, quantity, peer
                continue
            ratios = [p.cpu / min(work(all_points, m, p.error) for m in OURS) for p in peer_points]
            best = min(peer_points, key=lambda p: p.error)
            method = min(OURS, key=lambda m: work(all_points, m, best.error))
            cpu = work(all_points, method, best.error)
            yield Comparison(scene, quantity, peer, best, method, cpu, min(ratios), max(ratios))


def at_equal_error(points: Iterable[Point]) -> list[str]:
    """CPU of each peer's best run over that of hockle's cheapest run with no larger error."""
    lines = ["## Times less CPU than the peers", "",
             "CPU time from the scene to its frames, the construction of simulators and models included, for all. "
             "Against hockle's cheapest run whose error is no larger than the peer's; least and largest over its runs.",
             "", "| scene | quantity | peer | its smallest error | its CPU s | hockle | least | largest | aim |",
             "| --- | --- | --- | ---: | ---: | --- | ---: | ---: | ---: |"]  # fmt: skip
    for row in comparisons(points):
        if not isinstance(row, Comparison):
            lines.append(f"| {' | '.join(row)} | no run in the bound | | | | | |")
            continue
        lines.append(f"| {row.scene} | {row.quantity} | {row.peer} | {row.best.error:.1e} | {row.best.cpu:.3g} | "
                     f"{row.method}, {row.cpu:.3g} s | {row.least:.3g} | {row.most:.3g} | {row.aim:g} |")  # fmt: skip
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


@dataclass(frozen=True)
class Agreement:
    """The finest values of box and staggered, and what the last refinement changed of them."""

    scene: str
    quantity: str
    values: list[float]
    bars: list[float]

    @property
    def gap(self) -> float:
        """How far the methods differ."""
        return abs(self.values[0] - self.values[1])

    @property
    def met(self) -> bool:
        """Whether the bars meet."""
        return self.gap <= sum(self.bars)

    @property
    def shown(self) -> list[str]:
        """The values with their bars."""
        return [f"{v:.8g} ± {b:.1e}" for v, b in zip(self.values, self.bars, strict=True)]


def agreements(points: Iterable[Point]) -> Iterator[Agreement]:
    """Both methods in every scene."""
    for (scene, quantity), all_points in panels(points).items():
        values, bars = [], []
        for method in (BOX, STAGGERED):
            series = [p.value for p in all_points if p.solver == method and not p.missing]
            values.append(series[-1] if series else nan)
            bars.append(abs(series[-1] - series[-2]) if len(series) > 1 else nan)
        yield Agreement(scene, quantity, values, bars)


def agreement(points: Iterable[Point]) -> list[str]:
    """The finest values of both methods, what the last refinement changed of them, and whether these bars meet."""
    lines = ["## Agreement of the methods", "",
             "Error bar: what the last refinement changed.", "",
             "| scene | quantity | box | staggered | difference | within the bars |",
             "| --- | --- | ---: | ---: | ---: | --- |"]  # fmt: skip
    for row in agreements(points):
        within = "yes" if row.met else "no"
        lines.append(f"| {row.scene} | {row.quantity} | {' | '.join(row.shown)} | {row.gap:.1e} | {within} |")
    return [*lines, ""]
