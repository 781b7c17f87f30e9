"""What lets a cheaper method be chosen is asked of each part of a scene, and nothing is forgotten."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np
import pytest

from solver import Contact, Curve, DistributedLoad, End, Fluid, Initial, Numerics, PointLoad, Scene, UserLoad
from solver.arrays import Array
from solver.methods.registry import discretized
from solver.methods.space.one_axis.axis import axis_of
from solver.scene.curve import constant_vector
from tests.solver.scenes import ROD

PLANE = Scene(ROD, Initial.straight(), End.clamp(), End.free(), 1.0, 1.0,
              numerics=Numerics(method="staggered", intervals=4))  # fmt: skip
NONE = Curve.constant(0.0)
BENT = (Curve.constant(0.1), Curve.constant(0.1), NONE)
"""In either plane of a straight rod."""
ASIDE = constant_vector((1.0, 1.0, 0.0))


class Mine(UserLoad):
    """A load of which nothing is known."""

    def force(self, t: float, s: Array, r: Array, V: Array) -> Array:
        return np.zeros((len(s), 3))


def pushed(end: End) -> End:
    """An end with a value of 0.1 in place of 0 for all conditions."""
    def push(components: Any) -> Any:
        return tuple((replace(component[0], curve=Curve.constant(0.1)),) for component in components)

    return replace(end, translation=push(end.translation), rotation=push(end.rotation))


BREAKS: dict[str, Any] = {
    "rod": replace(ROD, kappa0=BENT),
    "initial": Initial.straight(velocity=(1.0, 1.0, 0.0)),
    "start": pushed(End.clamp()),
    "end": pushed(End.free()),
    "gravity": (1.0, 1.0, 0.0),
    "distributed": (DistributedLoad(force=ASIDE),),
    "points": (PointLoad(0.5, force=ASIDE),),
    "fluid": Fluid(1000.0, current=(1.0, 1.0, 0.0)),
    "contact": Contact(1e-7, 3.0, 0.0, 1.0, 1.0, 0.1, 0.3, 0.05),
    "loads": (Mine(),),
}
"""By the part of a scene: what does not keep the motion about any axis."""
WITHOUT_DIRECTION = {"t_end", "output_interval", "damping", "numerics", "topology", "analysis"}


def test_every_part_of_a_scene_is_asked_or_has_no_direction() -> None:
    assert {field.name for field in fields(Scene)} == BREAKS.keys() | WITHOUT_DIRECTION


@pytest.mark.parametrize("part", BREAKS)
def test_a_part_that_does_not_keep_the_motion_about_an_axis_has_the_rod_turn_in_space(part: str) -> None:
    assert axis_of(PLANE) is not None
    broken = replace(PLANE, **{part: BREAKS[part]})
    assert axis_of(broken) is None
    assert type(discretized(broken)).__name__ == "StaggeredMethod"


def test_a_part_that_does_not_answer_does_not_keep_it() -> None:
    @dataclass(frozen=True)
    class Later(Scene):
        """A scene with a part that nobody has thought of yet."""

        bed: object = None

    parts = {field.name: getattr(PLANE, field.name) for field in fields(Scene)}
    assert axis_of(Later(**parts)) is not None
    assert axis_of(Later(**parts, bed=object())) is None
    assert axis_of(Later(**parts, bed=(1.0, 2.0))) is None
