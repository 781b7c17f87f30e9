"""Resolutions of hockle's methods, from coarse to fine."""

from __future__ import annotations

from collections.abc import Callable

from benchmarks.work_precision.measure import BOX, DEFAULT, PAPER, STAGGERED, Measured, Run, Skipped
from solver import Numerics, RunFailed


def box(intervals: int, dt: float, rho_inf: float = 1.0, tolerance: float = 1e9) -> Numerics:
    """The box method in steps of dt (s), or as long as the tolerance lets them be."""
    return Numerics("box", intervals=intervals, dt_max=dt, rho_inf=rho_inf, increment_tolerance=tolerance)


def paper(numerics: Numerics) -> Numerics:
    """The box method as the paper solves it, by shooting."""
    return Numerics("box", "shooting", numerics.intervals, numerics.dt_max, numerics.rho_inf,
                    increment_tolerance=numerics.increment_tolerance)  # fmt: skip


def staggered(intervals: int, dt: float, tolerance: float) -> Numerics:
    """The staggered method under error control, in steps of dt (s) at most."""
    return Numerics("staggered", intervals=intervals, dt_max=dt, increment_tolerance=tolerance)


TOLERANCES = (1e-2, 1e-3, 1e-4, 1e-5)
"""Of the default mode."""


def hockle_runs(scene: str, boxes: list[Numerics], staggereds: list[Numerics],
                go: Callable[[Numerics], dict[str, Measured]]) -> list[Run]:  # fmt: skip
    """Runs of the three methods, of which the paper's takes the meshes and the steps of the box's, and of the default
    mode."""
    defaults = [Numerics("staggered", tolerance=tolerance) for tolerance in TOLERANCES]
    ladders = {BOX: boxes, STAGGERED: staggereds, DEFAULT: defaults, PAPER: [paper(numerics) for numerics in boxes]}
    return [Run(scene, solver, label(numerics), lambda numerics=numerics: or_outcome(go, numerics))  # type: ignore[misc]
            for solver, ladder in ladders.items() for numerics in ladder]  # fmt: skip


def label(numerics: Numerics) -> str:
    """The mesh, and what governs the steps; or the tolerance."""
    if numerics.tolerance:
        return f"tolerance {numerics.tolerance:.0e}"
    steps = f"dt {numerics.dt_max:.3g}"
    if numerics.increment_tolerance < 1e6:
        steps += f", tol {numerics.increment_tolerance:.0e}"
    return f"N {numerics.intervals}, {steps}"


def or_outcome(go: Callable[[Numerics], dict[str, Measured]], numerics: Numerics) -> dict[str, Measured]:
    """What was measured; raises `Skipped` with the outcome of a run that failed."""
    try:
        return go(numerics)
    except RunFailed as failure:
        raise Skipped(f"{failure.outcome.value} at {failure.t:.3g} s") from failure
