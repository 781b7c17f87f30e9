"""The same scene, resolved more finely."""

from __future__ import annotations

from dataclasses import replace

from solver.methods.registry import METHODS, tolerated_increment
from solver.scene.scene import Scene


def refine(scene: Scene) -> Scene:
    """The scene with intervals and steps half as long: dt_max, and by what their error makes of them."""
    numerics = scene.numerics
    tolerated = tolerated_increment(numerics) * 0.5 ** METHODS[numerics.method][-1].increment_order
    finer = replace(numerics, intervals=2 * numerics.intervals, dt_max=0.5 * numerics.dt_max,
                    increment_tolerance=tolerated)  # fmt: skip
    return replace(scene, numerics=finer)
