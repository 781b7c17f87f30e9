"""Which methods there are, and which one a scene asks for."""

from __future__ import annotations

from solver.methods.box import BoxMethod
from solver.methods.method import Method
from solver.methods.one_axis import OneAxisMethod
from solver.methods.space.one_axis.axis import axis_of
from solver.methods.staggered import StaggeredMethod
from solver.scene.numerics import Numerics
from solver.scene.scene import Scene

METHODS: dict[str, type[BoxMethod] | type[StaggeredMethod]] = {"box": BoxMethod, "staggered": StaggeredMethod}


def tolerated_increment(numerics: Numerics) -> float:
    """The largest error of a step relative to its motion: as given, or the method's own."""
    return numerics.increment_tolerance or METHODS[numerics.method].increment_tolerance


def discretized(scene: Scene) -> Method:
    """The method that a scene asks for; where it turns about one axis only, the same solution for less."""
    if scene.numerics.method == "staggered":
        axis = axis_of(scene)
        if axis is not None:
            return OneAxisMethod(scene, axis)
    return METHODS[scene.numerics.method](scene)
