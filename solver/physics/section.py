"""The section properties of a rod, at points along it or over its parts."""

from __future__ import annotations

from math import pi
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from solver.arrays import Array
from solver.physics.cells import Cells
from solver.physics.elasticity import Coupling, Elasticity, Stretch, elasticity_of, elasticity_over
from solver.scene.curve import corners_of
from solver.scene.rod import Rod


class Section(NamedTuple):
    """Section properties at n arclengths: `elastic`, mass (n,), inertia (n, 3), diameter (n,), and the `area` (n,) of
    that diameter."""

    elastic: Elasticity
    mass: Array
    inertia: Array
    diameter: Array
    area: Array


class Beside(NamedTuple):
    """The `nodes` (k,) that lie beside a step of the section or of kappa0, where the joint stands for a mean of both
    sides: by how much the node's own kappa0 is larger, `natural` (k, 3) in rad/m, and how much more it bends under a
    moment, `flexibility` (k, 3, 3) in 1/(N m^2)."""

    nodes: NDArray[np.int64]
    natural: Array
    flexibility: Array

    @classmethod
    def steps(cls, rod: Rod, s: Array, K: Array, kappa0: Array | None = None) -> Beside:
        """Those of nodes `s` (n,), whose joints have `K` (n, 3, 3) and a `kappa0` (n, 3), by default the nodes' own.

        The section's are none of a rod whose moment does not follow from K alone.
        """
        natural, flexibility = np.zeros((len(s), 3)), np.zeros((len(s), 3, 3))
        if kappa0 is not None and corners_of(*rod.kappa0):
            natural = np.stack([profile(s) for profile in rod.kappa0], axis=1) - kappa0
        if rod.corners and all(isinstance(law, (Coupling, Stretch)) for law in rod.laws):
            own = elasticity_of(rod, s).K
            stepped = (own != K).any(axis=(1, 2))
            flexibility[stepped] = np.linalg.inv(own[stepped]) - np.linalg.inv(K[stepped])
        nodes = np.flatnonzero(natural.any(axis=1) | flexibility.any(axis=(1, 2)))
        return cls(nodes, natural[nodes], flexibility[nodes])

    def at_nodes(self, kappa: Array, q: Array) -> Array:
        """The curvature (n, 3) of the nodes themselves under moments q (n, 3), from that of their joints."""
        if len(self.nodes) == 0:
            return kappa
        kappa = kappa.copy()
        kappa[self.nodes] += self.natural + np.einsum("kij,kj->ki", self.flexibility, q[self.nodes])
        return kappa


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
