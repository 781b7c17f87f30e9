"""How finely a scene is resolved, and the same scene resolved more finely."""

from __future__ import annotations

from dataclasses import replace

from solver.methods.registry import METHODS, tolerated_increment
from solver.scene.scene import Scene


def with_intervals(scene: Scene, intervals: int) -> Scene:
    """The scene with so many intervals."""
    return replace(scene, numerics=replace(scene.numerics, intervals=intervals))


def halve_steps(scene: Scene) -> Scene:
    """The scene with steps half as long: dt_max, and by what their error makes of them."""
    numerics = scene.numerics
    tolerated = tolerated_increment(numerics) * 0.5 ** METHODS[numerics.method][-1].increment_order
    halved = replace(numerics, dt_max=0.5 * numerics.dt_max, increment_tolerance=tolerated)
    return replace(scene, numerics=halved)


def refine(scene: Scene) -> Scene:
    """The scene with intervals and steps half as long."""
    return halve_steps(with_intervals(scene, 2 * scene.numerics.intervals))
