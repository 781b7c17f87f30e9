"""The section properties of a rod, sampled along it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from solver.arrays import Array
from solver.scene.rod import Rod


class Section(NamedTuple):
    """Section properties at n arclengths: stiffness (n, 3), mass (n,), inertia (n, 3), diameter (n,), kappa0 (n, 3)."""

    stiffness: Array
    mass: Array
    inertia: Array
    diameter: Array
    kappa0: Array


def sample(rod: Rod, s: Array) -> Section:
    """The rod's section properties at arclengths s (n,)."""

    def columns(profiles: tuple) -> Array:  # type: ignore[type-arg]
        return np.ascontiguousarray(np.stack([p(s) for p in profiles], axis=1))

    return Section(columns(rod.stiffness), np.array(rod.mass(s)), columns(rod.inertia),
                   np.array(rod.diameter(s)), columns(rod.kappa0))  # fmt: skip
