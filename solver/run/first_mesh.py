"""The mesh that a run to a tolerance begins with: fine enough for its shape, its twist and its loads."""

from __future__ import annotations

from collections.abc import Sequence
from math import ceil, log2

import numpy as np

from solver.arrays import Array
from solver.kernels.rotation import rotate
from solver.physics.ends import ABOUT_A3, DrivenEnd
from solver.run.hidden import Creases, Hidden, hidden_in
from solver.run.trial import FIRST_INTERVALS, intervals_of
from solver.scene.fluid import Shear
from solver.scene.layout import nodes_at_rest
from solver.scene.scene import Scene

LARGEST_TURN, LARGEST_TURN_PRESSED, LARGEST_TWIST_AT_REST = 1.2, 0.6, 2.4
"""Rotation (rad) within an interval that the first mesh has at the most; where strands press on each other; and about
its axis where nothing moves: a twist that is the same all along needs no mesh."""
LARGEST_WITHIN, FINEST_FOR_TURNS = 2.4, 1024
"""Rotation (rad) of the shape, or of its natural one, within any one interval at the most: a joint counts a turn of
2 pi as none; and how fine the first mesh becomes for it."""
LARGEST_CORNER, FINEST_FOR_SHAPES = 0.5, 128
"""By what angle (rad) the shape may turn more within an interval than in the mean, in a static analysis; and how fine
the first mesh becomes for it, and for what is hidden, at the most."""
LARGEST_MISS, FINEST_FOR_LAYERS = 0.25, 512
"""What part of a current's drag the middles of intervals may miss; and how fine the first mesh becomes for it."""
LAYERS = 8192
"""Places at which a current is looked at."""
ON_NODE = 1e-6
"""Part of an interval by which a load may be beside a node."""
LARGEST_HIDDEN = 1e-3
"""How far (rod lengths) what cancels within an interval of the second mesh may move the rod."""
LOOKED_AT = 4097
"""Nodes at which the initial shape is looked at."""
TIMES = 101
"""Times at which the ends are looked at."""


def first_mesh(scene: Scene, pressed: bool) -> int:
    """How many times to double `first_intervals`, see `plan`. `pressed`: whether strands press on each other."""
    largest = LARGEST_TURN_PRESSED if pressed and not scene.at_rest else LARGEST_TURN
    s = np.linspace(0.0, scene.rod.length, LOOKED_AT)
    places, quaternion, kappa = nodes_at_rest(scene.initial, s)
    turned = _turned(s, kappa), _turned(s, np.stack([profile(s) for profile in scene.rod.kappa0], axis=1))
    bent = float(turned[0][-1])
    twist = twisted(scene) / (LARGEST_TWIST_AT_REST if scene.at_rest else largest)
    tangents = rotate(quaternion, np.tile([0.0, 0.0, 1.0], (LOOKED_AT, 1)))
    # longer intervals may not feel the load
    scales = [load.scale(tangents) for load in scene.loads if hasattr(load, "scale")]
    intervals = bent / largest, twist, *(float(scene.rod.length) / scale for scale in scales)
    mesh = max(ceil(log2(max(intervals) / first_intervals(scene) + 1e-9)), 0)
    hidden = hidden_in(scene, s, kappa)
    while _misses(scene, places, turned, hidden, intervals_of(mesh)):
        mesh += 1
    return mesh


def _turned(s: Array, kappa: Array) -> Array:
    """By what angle (rad) a shape with a curvature-twist (n, 3) has turned until each of `s` (n,)."""
    return np.append(0.0, np.cumsum(np.linalg.norm(kappa, axis=1)[1:] * np.diff(s)))


def _most_within(turned: Array, intervals: int) -> float:
    """The largest angle (rad) within an interval, wherever that begins; `turned`: until each of `LOOKED_AT` nodes."""
    s = np.linspace(0.0, 1.0, LOOKED_AT)
    return float(np.max(np.interp(s + 1.0 / intervals, s, turned) - turned))


def _misses(scene: Scene, places: Array, turned: Sequence[Array], hidden: Sequence[Hidden | Creases],
            intervals: int) -> bool:  # fmt: skip
    """Whether a mesh misses a layer of the current, what cancels within an interval of the next one, a loop of the
    initial or the natural shape (see `_turned`), or a corner of the initial one in a static analysis."""
    shear, length = scene.fluid.shear if scene.fluid else None, float(scene.rod.length)
    if intervals < FINEST_FOR_TURNS and max(_most_within(shape, intervals) for shape in turned) > LARGEST_WITHIN:
        return True
    if shear is not None and intervals < FINEST_FOR_LAYERS and _flows_between(shear, places, intervals):
        return True
    if intervals >= FINEST_FOR_SHAPES:
        return False
    if any(part.moves(0.5 * length / intervals, length) > LARGEST_HIDDEN for part in hidden):
        return True
    return scene.at_rest and _cornered(turned[0], intervals)


def _cornered(turned: Array, intervals: int) -> bool:
    """Whether somewhere the initial shape turns by so much more within an interval than in the mean that meshes as
    coarse as this do not show it alike, and finer ones may."""
    return bool(_most_within(turned, intervals) - turned[-1] / intervals > LARGEST_CORNER)


def _flows_between(shear: Shear, places: Array, intervals: int) -> bool:
    """Whether the middles of intervals miss a layer in which water flows: what drags at the initial shape, from its
    start to any of them, is off by more than LARGEST_MISS of all. `places`: of `LOOKED_AT` nodes."""
    s, fine = np.linspace(0.0, 1.0, LOOKED_AT), (np.arange(LAYERS) + 0.5) / LAYERS
    drag = np.interp(fine, s, places @ shear.up)
    drag = np.abs(shear.factor(drag)) * shear.factor(drag) / LAYERS
    middle = drag.reshape(intervals, -1)[:, LAYERS // intervals // 2] * LAYERS / intervals
    whole = drag.reshape(intervals, -1).sum(axis=1)
    return bool(np.abs(np.cumsum(whole - middle)).max() > LARGEST_MISS * np.abs(drag).sum())


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


def twisted(scene: Scene) -> float:
    """The largest rotation (rad) of one end about itself relative to the other that the scene asks for."""
    ends = DrivenEnd(scene.start), DrivenEnd(scene.end)
    times = np.linspace(0.0, scene.t_end, TIMES).tolist()
    turned = [[end.prescribed(ABOUT_A3, t) or 0.0 for end in ends] for t in times]
    return max(abs(start - end) for start, end in turned)
