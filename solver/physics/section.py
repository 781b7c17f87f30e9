"""The section properties of a rod, at points along it or over its parts."""

from __future__ import annotations

from math import pi
from typing import NamedTuple

import numpy as np

from solver.arrays import Array
from solver.physics.cells import Cells
from solver.physics.elasticity import Elasticity, elasticity_of, elasticity_over
from solver.scene.rod import Rod


class Section(NamedTuple):
    """Section properties at n arclengths: `elastic`, mass (n,), inertia (n, 3), diameter (n,), and the `area` (n,) of
    that diameter."""

    elastic: Elasticity
    mass: Array
    inertia: Array
    diameter: Array
    area: Array


def sample(rod: Rod, s: Array) -> Section:
    """The rod's section properties at arclengths s (n,)."""
    inertia = np.ascontiguousarray(np.stack([profile(s) for profile in rod.inertia], axis=1))
    diameter = np.array(rod.diameter(s))
    return Section(elasticity_of(rod, s), np.array(rod.mass(s)), inertia, diameter, 0.25 * pi * diameter**2)


def sample_over(rod: Rod, cells: Cells) -> Section:
    """Their means over cells."""
    section = sample(rod, cells.points)
    elastic = elasticity_over(section.elastic, cells)
    return Section(elastic, *(cells.mean(values) for values in section[1:]))
