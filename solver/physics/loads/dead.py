"""Given loads that are the same however the rod turns: forces along lab axes, moments along material ones."""

from __future__ import annotations

from typing import Any

import numpy as np

from solver.kernels.kernel import inner
from solver.kernels.vectors import vector
from solver.physics.loads import given
from solver.physics.loads.load import Point, Samples, Source, as_given
from solver.scene.scene import Scene

account = as_given


class Record(given.Record):
    """`force` (lab) and `moment` (material)."""


def of(scene: Scene, samples: Samples) -> Source:
    """Those of a scene, but for what is given at its ends."""
    return given.GivenLoads(scene, samples, Record, following=False)


def about(record: Record, axis: Any) -> Record:
    """In the plane of an axis."""
    return Record(record.present, record.force @ axis.lab, np.ascontiguousarray(record.moment[..., axis.index]))


@inner
def force(load: Record, i: int, j: int, at: Point) -> Any:
    """As given."""
    return vector(load.force[i], j), vector(load.moment[i], j)
