"""Given loads that turn with the rod, or against it: forces along material axes, moments along lab ones."""

from __future__ import annotations

from typing import Any

from solver.kernels.kernel import inner
from solver.kernels.vectors import in_lab, in_lab_by_rotation, in_material, in_material_by_rotation, vector
from solver.physics.loads import given
from solver.physics.loads.load import Point, Samples, Source, Tangents, as_given
from solver.scene.scene import Scene

account = as_given


class Record(given.Record):
    """`force` (material) and `moment` (lab)."""


def of(scene: Scene, samples: Samples) -> Source:
    """Those of a scene, but for what is given at its ends."""
    return given.GivenLoads(scene, samples, Record, following=True)


def about(record: Record, axis: Any) -> Record:
    """In the plane of an axis."""
    return Record(record.present, record.force @ axis.material, record.moment @ axis.n)


@inner
def force(load: Record, i: int, j: int, at: Point) -> Any:
    """R force and R^t moment."""
    return in_lab(at.R, vector(load.force[i], j)), in_material(at.R, vector(load.moment[i], j))


@inner
def tangents(load: Record, i: int, j: int, at: Point) -> Tangents:
    """By rotation."""
    E, moment = in_lab_by_rotation(at.R, vector(load.force[i], j)), in_material(at.R, vector(load.moment[i], j))
    return Tangents(None, None, None, None, E, in_material_by_rotation(moment), None)
