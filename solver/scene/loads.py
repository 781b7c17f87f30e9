"""Given loads, as a scene gives them."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

from solver.scene.curve import Curve, Vector, constant_vector
from solver.scene.rod import Profiles
from solver.scene.view import View, at_all_times

Frame_ = Literal["material", "lab"]
ZERO: Vector = constant_vector((0.0, 0.0, 0.0))


@dataclass(frozen=True)
class DistributedLoad:
    """Force (N/m) and moment (N m/m) per length along s, times `schedule`(t)."""

    force: Profiles = ZERO
    moment: Profiles = ZERO
    frame: Frame_ = "lab"
    schedule: Curve = field(default_factory=lambda: Curve.constant(1.0))

    def keeps(self, view: View) -> bool:
        """Whether force and moment act along the motion about an axis."""
        force, moment = view.along(self.force), view.along(self.moment)
        return view.moved_by(force, self.frame) and view.turned_by(moment, self.frame)


@dataclass(frozen=True)
class PointLoad:
    """Force (N) and moment (N m) as functions of time at arclength `s`; at s = 0 or L it adds to the end."""

    s: float
    force: Vector = ZERO
    moment: Vector = ZERO
    frame: Frame_ = "lab"

    @property
    def pulls(self) -> bool:
        """Whether it has a force."""
        return not all(component.is_zero for component in self.force)

    def keeps(self, view: View) -> bool:
        """Whether force and moment act along the motion about an axis, at all times."""
        force, moment = at_all_times(self.force), at_all_times(self.moment)
        return view.moved_by(force, self.frame) and view.turned_by(moment, self.frame)


def have_moments(*loads: DistributedLoad | PointLoad) -> bool:
    """Whether any of some loads has a moment."""
    parts = [part for load in loads for part in load.moment]
    return not all(isinstance(part, Curve) and part.is_zero for part in parts)
