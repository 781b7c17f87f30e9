"""Straight rods at rest, and what presses them: what the tests of statics share."""

from __future__ import annotations

from dataclasses import replace

from solver import (
    FIXED,
    FREE,
    Curve,
    DistributedLoad,
    End,
    Fluid,
    Initial,
    Numerics,
    PointLoad,
    Scene,
    constant_vector,
)
from tests.solver.scenes import (
    LENGTH,
    ROD,
)

N = 16
ZERO = Curve.constant(0.0)


def static(**changes: object) -> Scene:
    """A straight cantilever at rest, changed."""
    scene = Scene(rod=ROD, initial=Initial.straight(), start=End.clamp(), end=End.free(), t_end=1.0,
                  output_interval=1.0, numerics=Numerics("staggered", intervals=N), analysis="static")  # fmt: skip
    return replace(scene, **changes)  # type: ignore[arg-type]


def ramp(value: float, until: float = 1.0) -> Curve:
    return Curve.table([0.0, until], [0.0, value])


DENSITIES = constant_vector((0.01, 0.02, 0.03))
PRESSED = {
    "weight": {"gravity": (1.0, 2.0, 3.0)},
    "lab": {"distributed": (DistributedLoad(DENSITIES, DENSITIES),)},
    "following": {"distributed": (DistributedLoad(DENSITIES, DENSITIES, frame="material"),)},
    "current": {"fluid": Fluid(1000.0, 1.0, 1.2, 0.1, (0.1, 0.2, 0.05))},
    "tip, lab": {"points": (PointLoad(LENGTH, DENSITIES, DENSITIES),)},
    "tip, following": {"points": (PointLoad(LENGTH, DENSITIES, DENSITIES, "material"),)},
    "beside the middles of segments": {"points": (PointLoad(0.37 * LENGTH, DENSITIES, DENSITIES),
                                                  PointLoad(0.61 * LENGTH, DENSITIES, DENSITIES, "material"))},
    "free start": {"start": End.free(), "end": End.clamp(), "points": (PointLoad(0.0, DENSITIES, DENSITIES, "material"),
                                                                       PointLoad(0.0, DENSITIES, DENSITIES))},
    "pin and clamp": {"start": End.pin(), "end": End.clamp()},
    "hinge and slider": {"start": End((FIXED, FREE, FIXED), (FIXED, FREE, FIXED), "lab"), "end": End.slider()},
}  # fmt: skip
