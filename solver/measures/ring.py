"""Rings that ends hold, all but closed: what closes their centreline in the definition of its writhe.

Rays along the tangents at the ends of a ring with a gap would cross each other in it: Wr would not be that of the
ring, and jump by 2 where they pass each other. Ends that hold their places and tangents allow another continuation, the
straight line across the gap: as neither it nor its angles with the tangents change, Tw + Wr still changes only by what
the ends turn about their tangents (White, Am. J. Math. 91 (1969) 693).
"""

from __future__ import annotations

import numpy as np

from solver.kernels.rotation import rotate
from solver.scene.layout import nodes_at_rest
from solver.scene.scene import Scene

CLOSED, NEAR = 1e-6, 0.1
"""Narrowest gap, in rod lengths: a mesh says of a smaller one neither how wide it is nor which way it leads, and the
curve is closed as it is; and the widest."""
AHEAD = 0.8
"""Least cosine of the angles by which the line across it turns from the tangents at the ends."""


def is_ring(scene: Scene) -> bool:
    """Whether the ends of a scene's rod are held so, at all times."""
    if not all(end.holds_place() and end.holds_tangent() for end in (scene.start, scene.end)):
        return False
    r, orientation, _ = nodes_at_rest(scene.initial, np.linspace(0.0, scene.rod.length, 3))
    gap, tangents = r[0] - r[-1], rotate(orientation[[0, -1]], np.tile([0.0, 0.0, 1.0], (2, 1)))
    width = float(np.linalg.norm(gap))
    return CLOSED < width / scene.rod.length <= NEAR and bool((tangents @ gap > AHEAD * width).all())
