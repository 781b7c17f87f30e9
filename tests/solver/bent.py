"""A smooth scene: a cantilever that a load across its tip, grown from rest, bends far."""

from __future__ import annotations

from solver import Curve, End, Initial, Numerics, PointLoad, Scene
from tests.solver.scenes import EJ, LENGTH, ROD


def bent_cantilever(numerics: Numerics) -> Scene:
    """To 4 s: the load is grown at 3 s, and there is damping."""
    growth, none = Curve.table([0.0, 3.0], [0.0, 3.0 * EJ / LENGTH**2], "smoothstep"), Curve.constant(0.0)
    return Scene(
        rod=ROD, initial=Initial.straight(), start=End.clamp(), end=End.free(), t_end=4.0, output_interval=0.25,
        points=(PointLoad(LENGTH, (growth, none, none)),), damping=4.0, numerics=numerics, topology=False,
    )  # fmt: skip
