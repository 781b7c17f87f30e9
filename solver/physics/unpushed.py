"""A small push for a straight rod that its ends press, where nothing in the scene says to which side it buckles.

No real rod is straight enough to be pressed shorter instead. So it is given a load as small as its own want of
straightness might be: 1e-2 EJ/L^3 per length, which bends it by 1e-4 of its length between pins, and a quarter of
that between clamps, about its softer axis. See docs/decisions/0038.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import hypot

import numpy as np

from solver.kernels.rotation import rotation_of
from solver.measures.buckling import STRAIGHT, Across
from solver.physics.axial import axial_stiffness, distances, has_to_stretch
from solver.physics.elasticity import Stretch
from solver.scene.curve import constant_vector
from solver.scene.layout import nodes_at_rest
from solver.scene.loads import DistributedLoad
from solver.scene.scene import Scene

SMALL = 1e-2
"""In EJ/L^3."""


@dataclass(frozen=True)
class Push(DistributedLoad):
    """A load that nobody gave, the same all along the rod."""

    @property
    def size(self) -> float:
        """Of its force, N/m."""
        return hypot(*(float(component(np.zeros(1))[0]) for component in self.force))


def push_for(scene: Scene) -> Push | None:
    """The push that a scene of a motion needs; None if none. (By the box method such a rod has no start.)"""
    if scene.at_rest or scene.numerics.method == "box" or not has_to_stretch(scene):
        return None
    across, apart, length = Across.of(scene), distances(scene), float(scene.rod.length)
    if across is None or across.p != STRAIGHT or apart is None:
        return None
    ends = np.array([0.0, length])
    laws = [float(np.mean(law.EA(ends))) for law in scene.rod.laws if isinstance(law, Stretch)]
    pressed = (apart.min() / length - 1.0) * (axial_stiffness(scene) or min(laws))
    along = (np.full(2, value) for value in (0.0, 0.0, pressed))
    if np.linalg.eigvalsh(across.straight(ends, *along))[0] >= 0.0:
        return None
    _, quaternion, _ = nodes_at_rest(scene.initial, ends)
    EJ = [float(np.mean(profile(ends))) for profile in scene.rod.stiffness[:2]]
    aside = rotation_of(quaternion[0])[:, 1 - int(np.argmin(EJ))]  # bent about the softer axis it goes along the other
    return Push(force=constant_vector((SMALL * min(EJ) / length**3 * aside).tolist()))


def pushed(scene: Scene) -> Scene:
    """The scene with the push that it needs, if any."""
    push = push_for(scene)
    return replace(scene, distributed=(*scene.distributed, push)) if push else scene
