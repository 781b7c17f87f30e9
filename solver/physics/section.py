"""The section properties of a rod, sampled along it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from solver.arrays import Array
from solver.physics.elasticity import Elasticity, elasticity_of
from solver.scene.rod import Rod


class Section(NamedTuple):
    """Section properties at n arclengths: `elastic`, mass (n,), inertia (n, 3), diameter (n,)."""

    elastic: Elasticity
    mass: Array
    inertia: Array
    diameter: Array


def sample(rod: Rod, s: Array) -> Section:
    """The rod's section properties at arclengths s (n,)."""

    inertia = np.ascontiguousarray(np.stack([profile(s) for profile in rod.inertia], axis=1))
    return Section(elasticity_of(rod, s), np.array(rod.mass(s)), inertia, np.array(rod.diameter(s)))
