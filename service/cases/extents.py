"""How large what a scene is given gets, along the rod and in time."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

from solver import Curve, Scene


def times(scene: Scene) -> Any:
    """The times (s) at which schedules are looked at."""
    return np.linspace(0.0, scene.t_end, 2001)


def largest(vector: Iterable[Curve], scene: Scene) -> float:
    """The largest length of a vector in time."""
    components = [np.asarray(curve(times(scene))) for curve in vector]
    return float(np.max(np.linalg.norm(components, axis=0))) if components else 0.0


def widest(scene: Scene) -> float:
    """The largest diameter (m)."""
    return float(np.max(scene.rod.diameter(np.linspace(0.0, scene.rod.length, 201))))


def forces(scene: Scene) -> dict[str, float]:
    """The largest force (N) at each end and of each point load, by its pointer; 0 at an end that has its place."""
    return _loads(scene, "translation", "force")


def moments(scene: Scene) -> dict[str, float]:
    """The largest moment (N m), likewise."""
    return _loads(scene, "rotation", "moment")


def _loads(scene: Scene, components: str, name: str) -> dict[str, float]:
    ends = {f"/ends/{which}": [c[0].curve for c in getattr(end, components) if c[0].kind == "load"]
            for which, end in (("start", scene.start), ("end", scene.end))}  # fmt: skip
    points = {f"/loads/point/{i}/{name}": getattr(load, name) for i, load in enumerate(scene.points)}
    return {where: largest(vector, scene) for where, vector in (ends | points).items()}
