"""The mesh that a run to a tolerance begins with: fine enough for its shape, its twist and its loads."""

from __future__ import annotations

from collections.abc import Sequence
from math import ceil, log2

import numpy as np

from solver.physics.ends import ABOUT_A3, DrivenEnd
from solver.run.plan import FIRST_INTERVALS
from solver.scene.layout import nodes_at_rest
from solver.scene.scene import Scene

LARGEST_TURN, LARGEST_TURN_PRESSED = 1.2, 0.6
"""Rotation (rad) within an interval that the first mesh has at the most; and where strands press on each other."""
ON_NODE = 1e-6
"""Part of an interval by which a load may be beside a node."""
LOOKED_AT = 513
"""Nodes at which the initial shape is looked at."""
TIMES = 101
"""Times at which the ends are looked at."""


def first_mesh(scene: Scene, pressed: bool) -> int:
    """How many times `first_intervals` are to be doubled, see `plan`. `pressed`: whether strands press on each other.
    """
    largest = LARGEST_TURN_PRESSED if pressed else LARGEST_TURN
    s = np.linspace(0.0, scene.rod.length, LOOKED_AT)
    _, _, kappa = nodes_at_rest(scene.initial, s)
    bent = float(np.sum(np.linalg.norm(kappa, axis=1)[1:] * np.diff(s)))
    intervals = max(bent, twisted(scene)) / largest, *(float(scene.rod.length) / scale for scale in _scales(scene))
    return max(ceil(log2(max(intervals) / first_intervals(scene) + 1e-9)), 0)


def first_intervals(scene: Scene) -> int:
    """Of the coarsest mesh: with a node at each point load, if few enough are.

    On meshes that have it at a node the error falls evenly; elsewhere now more and now less, as the load lies in its
    interval, and the differences tell little.
    """
    return with_nodes_at([load.s / float(scene.rod.length) for load in scene.points], FIRST_INTERVALS)


def with_nodes_at(places: Sequence[float], least: int) -> int:
    """The fewest intervals, from `least` to half as many again, with a node at each point load; else `least`.

    There the curvature has a cusp, as sharp as the rod is taut, and its largest value. `places`: parts of the length.
    """
    for intervals in range(least, least + least // 2 + 1):
        beside = np.array(places) * intervals
        if (np.abs(beside - np.round(beside)) <= ON_NODE).all():
            return intervals
    return least


def _scales(scene: Scene) -> list[float]:
    """Lengths (m) of an interval that would be too long for some load."""
    return [load.scale for load in scene.loads if hasattr(load, "scale")]


def twisted(scene: Scene) -> float:
    """The largest rotation (rad) of one end about itself relative to the other that the scene asks for."""
    ends = DrivenEnd(scene.start), DrivenEnd(scene.end)
    times = np.linspace(0.0, scene.t_end, TIMES).tolist()
    turned = [[end.prescribed(ABOUT_A3, t) or 0.0 for end in ends] for t in times]
    return max(abs(start - end) for start, end in turned)
