"""Weight less buoyancy: (rho_c A - rho_w A) g per length."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from solver.kernels.kernel import inner
from solver.kernels.vectors import dot, vector
from solver.physics.loads.load import Point, Samples, Source
from solver.scene.fluid import NO_FLUID
from solver.scene.scene import Scene


class Record(NamedTuple):
    """`weight` (n, 3): N/m, lab."""

    present: bool
    weight: Any


def of(scene: Scene, samples: Samples) -> Source:
    """The weight of a scene's rod in its fluid."""
    mass = samples.section.mass - (scene.fluid or NO_FLUID).density * samples.section.area
    return Source(Record(any(scene.gravity), np.outer(mass, np.array(scene.gravity, dtype=float))))


def about(record: Record, axis: Any) -> Record:
    """In the plane of an axis."""
    return record._replace(weight=record.weight @ axis.lab)


@inner
def force(load: Record, i: int, j: int, at: Point) -> Any:
    """B = (rho_c A - rho_w A) g."""
    return vector(load.weight, j), None


@inner
def energy(load: Record, i: int, j: int, at: Point) -> float:
    """- weight . r."""
    return -float(dot(vector(load.weight, j), at.r))
