"""How the ends of a rod are moved: what the estimate of a run's cost asks of that."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from solver import Scene
from solver.arrays import Array
from solver.kernels.rotation import rotate
from solver.physics.ends import travel
from solver.scene.ends import Component, End
from solver.scene.layout import nodes_at_rest

TIMES = 201
"""Times that are looked at."""
FARTHER = 1e-6
"""Part of their distance by which ends that come apart pull the rod taut."""
BACK = 0.01
"""Part of its largest speed that an end has on its way back, if it moves to and fro."""
THIRD = 5
"""The component that turns an end about itself."""


@dataclass(frozen=True)
class Driven:
    """How both ends are moved. `turned`: the largest rotation (rad) of one about itself relative to the other, where
    both are prescribed; `apart`: whether they come farther from each other than they are at first; `moved`: whether
    one changes its place or leans; `to_and_fro`: whether one comes back; `acceleration`: the largest (m/s^2) of an end,
    or of the rod's length where it leans."""

    turned: float
    apart: bool
    moved: bool
    to_and_fro: bool
    acceleration: float

    @classmethod
    def of(cls, scene: Scene) -> Driven:
        """As a scene has it."""
        times = np.linspace(0.0, scene.t_end, TIMES)
        start, end = (_travels(e, times) for e in (scene.start, scene.end))
        speeds = np.concatenate([np.hstack([known[:, :3], known[:, 3:THIRD] * scene.rod.length])
                                 for known in map(np.nan_to_num, (start, end))], axis=1)  # fmt: skip
        speeds = np.diff(speeds, axis=0) / times[1]
        fastest = np.abs(speeds).max(axis=0)
        turned = np.nan_to_num(np.abs(end[:, THIRD] - start[:, THIRD]))
        return cls(
            turned=float(turned.max()), apart=_come_apart(scene, start[:, :3], end[:, :3]),
            moved=bool(fastest.any()),
            to_and_fro=bool(((speeds > BACK * fastest).any(axis=0) & (speeds < -BACK * fastest).any(axis=0)).any()),
            acceleration=float(np.abs(np.diff(speeds, axis=0, prepend=0.0)).max() / times[1]),
        )  # fmt: skip


def _travels(end: End, times: Array) -> Array:
    """Displacements (m) and rotations (rad) since t = 0 (times, 6); NaN for what is not prescribed all along."""
    return np.array([_travel(component, times) for component in (*end.translation, *end.rotation)]).T


def _travel(component: Component, times: Array) -> Array:
    if any(condition.kind not in ("rate", "position") for condition in component):
        return np.full(len(times), np.nan)
    total, ends = np.zeros(len(times)), [*(condition.since for condition in component[1:]), np.inf]
    for condition, until in zip(component, ends, strict=True):
        if not (condition.curve.is_zero or (condition.kind == "position" and condition.curve.is_constant)):
            total += [travel(condition, min(t, until)) if t > condition.since else 0.0 for t in times]
    return total


def _come_apart(scene: Scene, start: Array, end: Array) -> bool:
    """Whether the ends come farther apart, along the axes that they have at t = 0."""
    r, quaternion, _ = nodes_at_rest(scene.initial, np.array([0.0, scene.rod.length]))
    chords = r[1] - r[0] + _in_lab(scene.end, end, quaternion[1]) - _in_lab(scene.start, start, quaternion[0])
    distances = np.linalg.norm(chords, axis=1)
    return bool(np.nanmax(distances, initial=0.0) > distances[0] * (1.0 + FARTHER))


def _in_lab(end: End, moved: Array, quaternion: Array) -> Array:
    return moved if end.frame == "lab" else rotate(np.tile(quaternion, (len(moved), 1)), np.ascontiguousarray(moved))
