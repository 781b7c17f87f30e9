"""Bends and windings that no rod has: tighter than it is thick, or more than the finest mesh can show."""

from __future__ import annotations

from collections.abc import Iterator
from math import pi

import numpy as np

from service.cases.case import CaseSpec
from service.cases.errors import FieldError
from service.cases.extents import moments
from solver import Scene

HALF_A_TURN = pi
"""Rotation (rad) from node to node beyond which a run ends, as its mesh is too coarse."""
PLACES = 2001


def bends_of(spec: CaseSpec, scene: Scene) -> list[FieldError]:
    """What bends or winds the rod too far."""
    return [*_natural(scene), *_finest(spec, scene), *_moments(scene)]


def _natural(scene: Scene) -> Iterator[FieldError]:
    """A rod whose shape without stress is folded into itself."""
    s = np.linspace(0.0, scene.rod.length, PLACES)
    bend, diameter = np.hypot(*(kappa(s) + 0.0 * s for kappa in scene.rod.kappa0[:2])), scene.rod.diameter(s) + 0.0 * s
    worst = int(np.argmax(bend * diameter))
    if bend[worst] * diameter[worst] > 1.0:
        rule = (f"bends the rod to a radius of {1.0 / bend[worst]:.3g} m at s = {s[worst]:.3g} m, which is less than "
                f"its diameter, {diameter[worst]:.3g} m: is it in rad/m?")  # fmt: skip
        yield FieldError("/rod/kappa0", float(bend[worst]), rule)


def _finest(spec: CaseSpec, scene: Scene) -> Iterator[FieldError]:
    """A rod that, free of stress, winds by more than half a turn from node to node, however fine its mesh is."""
    intervals = spec.numerics.intervals or scene.numerics.most_intervals
    s = np.linspace(0.0, scene.rod.length, PLACES)
    kappa = float(np.max(np.linalg.norm([kappa(s) + 0.0 * s for kappa in scene.rod.kappa0], axis=0)))
    wound = kappa * scene.rod.length / intervals
    if wound > HALF_A_TURN:
        rule = (f"winds the rod by {wound / (2 * pi):.3g} turns from one node to the next, of {intervals} intervals; "
                "half a turn is the most that a mesh can show")  # fmt: skip
        yield FieldError("/rod/kappa0", kappa, rule)


def _moments(scene: Scene) -> Iterator[FieldError]:
    """A moment that would bend or twist the rod to a radius below its diameter, wherever it acts."""
    s = np.linspace(0.0, scene.rod.length, PLACES)
    stiffness = float(np.max([profile(s) + 0.0 * s for profile in scene.rod.stiffness]))
    diameter = float(np.min(scene.rod.diameter(s)))
    where, moment = max(moments(scene).items(), key=lambda one: one[1])
    if moment * diameter > stiffness:
        rule = (f"has a moment that would bend or twist the rod by {moment / stiffness:.3g} rad/m, to a radius that "
                f"is less than its diameter, {diameter:.3g} m: is it in N m?")  # fmt: skip
        yield FieldError(where, moment, rule)
