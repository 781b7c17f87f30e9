"""A small load for a straight rod that its ends shorten, where nothing in the scene says to which side it buckles.

Such a rod has no other answer than to buckle. The load stands for its want of straightness: 1e-2 EJ/L^3 per length,
which bends it by 1e-4 of its length between pins, and a quarter of that between clamps, about its softer axis.
See docs/decisions/0038.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import hypot

import numpy as np

from solver.kernels.rotation import rotation_of
from solver.measures.buckling import STRAIGHT, Transverse
from solver.physics.axial import LOOKED_AT, axial_stiffness, distances, has_to_stretch
from solver.physics.elasticity import Stretch
from solver.scene.curve import constant_vector
from solver.scene.layout import nodes_at_rest
from solver.scene.loads import DistributedLoad
from solver.scene.rod import Rod
from solver.scene.scene import Scene

SMALL = 1e-2
"""In EJ/L^3."""


@dataclass(frozen=True)
class Seed(DistributedLoad):
    """A load that the scene as given has not, the same all along the rod."""

    @property
    def size(self) -> float:
        """Of its force, N/m."""
        return hypot(*(float(component(np.zeros(1))[0]) for component in self.force))


def seed_of(scene: Scene) -> Seed | None:
    """The seed that a scene needs; None if none. (By the box method such a rod has no start.)"""
    if (scene.numerics.method == "box" and not scene.at_rest) or not has_to_stretch(scene):
        return None
    transverse, apart, length = Transverse.of(scene), distances(scene), float(scene.rod.length)
    if transverse is None or transverse.p != STRAIGHT or apart is None:
        return None
    s = np.linspace(0.0, length, LOOKED_AT)
    force = (apart.min() / length - 1.0) * (axial_stiffness(scene) or _stiffness_of_laws(scene.rod, s))
    tension = np.full(len(s), force)
    if np.linalg.eigvalsh(transverse.straight(s, 0.0 * s, 0.0 * s, tension))[0] >= 0.0:
        return None
    _, quaternion, _ = nodes_at_rest(scene.initial, s)
    EJ = [float(np.mean(profile(s))) for profile in scene.rod.stiffness[:2]]
    across = rotation_of(quaternion[0])[:, 1 - int(np.argmin(EJ))]  # bent about one axis it goes along the other
    return Seed(force=constant_vector((SMALL * min(EJ) / length**3 * across).tolist()))


def seeded(scene: Scene) -> Scene:
    """The scene with the seed that it needs, if any."""
    seed = seed_of(scene)
    return replace(scene, distributed=(*scene.distributed, seed)) if seed else scene


def size_of_seed(scene: Scene) -> float:
    """The force (N/m) of the seed that a scene has; 0 if none."""
    return sum(load.size for load in scene.distributed if isinstance(load, Seed))


def _stiffness_of_laws(rod: Rod, s: np.ndarray) -> float:
    """EA (N), the harmonic mean along the rod of what its laws of stretch give."""
    laws = [law.EA(s) + 0.0 * s for law in rod.laws if isinstance(law, Stretch)]
    return min(float(s[-1]) / float(np.trapezoid(1.0 / EA, s)) for EA in laws)
