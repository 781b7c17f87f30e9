"""Error bars: how many of a verified run's values lie within 3 times their estimated error of the truth.

The truth is a verified run with intervals and steps a quarter as long; of the elastica come to rest also the closed
form; of the hanging cable come to rest the equilibrium that statics finds on a mesh eight times as fine. A value counts
only where it has an error to speak of: above 1e-8 of the largest of its kind, a hundred times the tolerance of the
iterations.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from service.cases.build import build_scene
from service.cases.library import apply_settings, load_case, parse_case
from solver import Frame, Scene, simulate
from solver.arrays import Array
from solver.measures.frame import OUTPUTS
from solver.run.artificial_viscosity import with_viscosity
from solver.run.refined import Refined
from solver.run.trial import grade_of, longest_step, step_tolerance, strides_of
from solver.run.verify import VerifiedFrame, refine
from validation.elastica import TABLE
from validation.row import Row, at_most, relative

ROUNDING = 1e-8
WITHIN = 3.0
MISSED = 0.05
"""The part of the values that may lie farther off."""
NAMES = tuple(output.name for output in OUTPUTS if output.verified)
ALONG_ROD = {output.name for output in OUTPUTS if output.along_rod}
ENERGIES = tuple(name for name in NAMES if name.startswith(("energy_", "work_", "dissipation")))


TO_CONTACT = {"t_end": 25.0, "output.interval": 0.5}
SCENES: dict[str, tuple[str, dict[str, Any]]] = {
    "elastica, N=25": ("elastica", {"numerics.intervals": 25}),
    "elastica at rest, N=25": ("static-elastica", {"numerics.intervals": 25, "t_end": 5.0}),
    "greenhill, N=25": ("greenhill", {"numerics.intervals": 25}),
    "cantilever-vibration, N=25": ("cantilever-vibration", {"numerics.intervals": 25, "t_end": 5.0}),
    "hanging-cable, N=25, its first second": ("hanging-cable", {
        "numerics.intervals": 25, "t_end": 1.0, "output.interval": 0.1}),
    "goyal-2003, N=50": ("goyal-2003", {"numerics.intervals": 50, **TO_CONTACT}),
    "goyal-2003, tolerance 1e-3": ("goyal-2003", {"numerics.tolerance": 1e-3, **TO_CONTACT}),
}  # fmt: skip

HUNG = ("hanging-cable", {"numerics.intervals": 25, "t_end": 75.0, "output.interval": 75.0})
OF_EQUILIBRIA = ("r", "orientation", "f", "kappa", "q", "energy_bending", "energy_torsion", "energy_potential")


def scene(case: str, settings: dict[str, Any]) -> Scene:
    """A shipped case, verified."""
    changes = {"numerics.method": "staggered", "numerics.verify": True, **settings}
    return build_scene(parse_case(apply_settings(load_case(case), changes)))


def verified(run: Refined, scene: Scene) -> Scene:
    """A scene whose verified run has the two finest meshes of a run to a tolerance, and steps and viscosity like
    these."""
    steps, intervals, rod = run._together.finest.steps, len(run.s) - 1, scene.rod
    tolerance = scene.numerics.tolerance or 1.0
    numerics = replace(
        scene.numerics, tolerance=None, verify=True, intervals=intervals // 2,
        dt_max=longest_step(steps, scene.output_interval), strides=strides_of(tolerance, steps),
        increment_tolerance=step_tolerance(steps, tolerance),
    )  # fmt: skip
    grade = grade_of(steps)
    if grade is not None:
        rod = with_viscosity(rod, intervals, grade)
    return replace(scene, rod=rod, numerics=numerics)


def run(scene: Scene) -> tuple[Scene, list[VerifiedFrame]]:
    """The frames of a verified run, and its scene with the intervals and steps that it had."""
    begun = simulate(scene)
    frames = [frame for frame in begun if isinstance(frame, VerifiedFrame)]
    return verified(begun, scene) if isinstance(begun, Refined) else scene, frames


def true(scene: Scene) -> list[VerifiedFrame]:
    """The frames with a quarter of the spacing and steps."""
    return run(refine(refine(scene)))[1]


def equilibrium(case: str, intervals: int) -> Frame:
    """The equilibrium of a shipped case by statics."""
    changes = {"analysis": "static", "numerics": {"intervals": intervals}, "t_end": 1.0, "output.interval": 1.0}
    *_, last = simulate(build_scene(parse_case(apply_settings(load_case(case), changes))))
    return last


def series(frames: Sequence[Any], name: str, intervals: int) -> Array:
    """A variable of all frames, fields at `intervals` + 1 nodes."""
    values = np.array([getattr(frame, name) for frame in frames], dtype=float)
    return values[:, :: (values.shape[1] - 1) // intervals] if name in ALONG_ROD else values


def misses(
    frames: list[VerifiedFrame], truth: Sequence[Frame], names: Sequence[str] = NAMES
) -> dict[str, tuple[int, int]]:
    """By variable: how many values lie farther from the truth than 3 times the estimate, and of how many."""
    intervals = min(len(frames[0].r), len(truth[0].r)) - 1
    energy = float(np.nanmax([np.abs(series(truth, name, intervals)).max() for name in ENERGIES]))  # works NaN at rest
    by_variable = {}
    for name in names:
        values, exact = series(frames, name, intervals), series(truth, name, intervals)
        estimate = series([frame.error for frame in frames], name, intervals)
        if name == "orientation":
            exact = exact * np.sign(np.sum(values * exact, axis=-1, keepdims=True))
        least = 1.0 if name in ("Wr", "Lk", "Tw") else 0.0
        scale = energy if name in ENERGIES else max(float(np.abs(exact).max()), least)
        error = np.abs(values - exact)
        counts = np.maximum(error, estimate) > ROUNDING * scale
        by_variable[name] = (int(np.sum(counts & ~(error <= WITHIN * estimate))), int(np.sum(counts)))
    return by_variable


def missed(by_variable: dict[str, tuple[int, int]]) -> float:
    """The part of all values that lie farther off."""
    far, all_ = np.sum(list(by_variable.values()), axis=0)
    return float(far / all_)


def gain(scene: Scene, frames: list[VerifiedFrame], truth: list[VerifiedFrame]) -> float:
    """The error of r of the finer run alone, over that of the extrapolated solution."""
    intervals = scene.numerics.intervals
    fine = refine(replace(scene, numerics=replace(scene.numerics, verify=False)))
    exact = series(truth, "r", intervals)
    alone, extrapolated = (np.abs(series(list(x), "r", intervals) - exact).max() for x in (simulate(fine), frames))
    return float(alone / extrapolated)


def elastica_rows(label: str, last: VerifiedFrame) -> list[Row]:
    """The tip at rest against the closed form, alpha = 5: within 3 times its error bar."""
    across, along, _ = TABLE[5.0]
    table = []
    for axis, exact, name in ((0, across, "across"), (2, 1.0 - along, "along")):
        bar = WITHIN * float(last.error.r[-1, axis]) / exact + 1e-6 / exact  # the table has six digits
        table.append(relative(f"error bars, {label}: tip {name} at rest", float(last.r[-1, axis]), exact, bar))
    return table


def outside(label: str, scene: Scene, by_variable: dict[str, tuple[int, int]]) -> Row:
    """The row of a scene; which variables lie outside is printed."""
    far = {name: f"{part / all_:.3f}" for name, (part, all_) in by_variable.items() if part}
    counts = sum(all_ for _, all_ in by_variable.values())
    print(f"      {label}: {scene.numerics.intervals} intervals, {counts} values; parts outside {far}")
    return at_most(f"error bars, {label}: part outside", missed(by_variable), MISSED)


def hung() -> Row:
    """The hanging cable at rest against its equilibrium."""
    case, settings = HUNG
    chosen, frames = run(scene(case, settings))
    exact = equilibrium(case, 8 * chosen.numerics.intervals)
    return outside(f"{case} at rest, N=25", chosen, misses(frames[-1:], [exact], OF_EQUILIBRIA))


def rows() -> list[Row]:
    """At least 95 % of the values within 3 times their error bars, in each scene."""
    table = [hung()]
    for label, (case, settings) in SCENES.items():
        chosen, frames = run(scene(case, settings))
        truth = true(chosen)
        table.append(outside(label, chosen, misses(frames, truth)))
        if case.endswith("elastica"):
            table += elastica_rows(label, frames[-1])
        if case == "elastica":
            print(f"      Richardson's gain in r over the finer run alone: {gain(chosen, frames, truth):.0f}")
    return table
