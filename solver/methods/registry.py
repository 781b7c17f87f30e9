"""Which methods there are, and which one a scene asks for. A new one is a line here."""

from __future__ import annotations

from solver.methods.box import BoxMethod
from solver.methods.method import Method
from solver.methods.one_axis import OneAxisMethod
from solver.methods.staggered import StaggeredMethod
from solver.scene.numerics import Numerics
from solver.scene.scene import Scene

METHODS: dict[str, tuple[type[Method], ...]] = {"box": (BoxMethod,), "staggered": (OneAxisMethod, StaggeredMethod)}
"""By `numerics.method` the classes that solve for it: the first that takes a scene gives its solution for the least."""


def tolerated_increment(numerics: Numerics) -> float:
    """The largest error of a step relative to its motion: as given, or the method's own."""
    return numerics.increment_tolerance or METHODS[numerics.method][-1].increment_tolerance


def discretized(scene: Scene) -> Method:
    """The method that a scene asks for. Raises LookupError where none of its classes takes the scene."""
    for kind in METHODS[scene.numerics.method]:
        method = kind.of(scene)
        if method is not None:
            return method
    raise LookupError(f"no {scene.numerics.method} method for this scene")
