"""What acts on the rod of a case: loads, the fluid, and the rod itself where it touches."""

from __future__ import annotations

from math import radians
from typing import Annotated, Literal

from pydantic import Field

from service.cases.quantities import (
    FrameName,
    NotNegative,
    Positive,
    ProfileTriple,
    Schedule,
    ScheduleTriple,
    Spec,
    Triple,
    curve,
    curves,
)
from solver import Contact, DistributedLoad, Fluid, PointLoad

MOST_LOADS = 100
NOTHING: Triple = (0.0, 0.0, 0.0)


class DistributedSpec(Spec):
    """`force` (N/m) and `moment` (N m/m) along s, in the lab or the material frame, times `schedule`(t)."""

    force: ProfileTriple = NOTHING
    moment: ProfileTriple = NOTHING
    frame: FrameName = "lab"
    schedule: Schedule = 1.0

    def build(self) -> DistributedLoad:
        """The solver's load."""
        return DistributedLoad(curves(self.force), curves(self.moment), self.frame, curve(self.schedule))


class PointSpec(Spec):
    """`force` (N) and `moment` (N m) as functions of time at arclength `s` (m)."""

    s: NotNegative
    force: ScheduleTriple = NOTHING
    moment: ScheduleTriple = NOTHING
    frame: FrameName = "lab"

    def build(self) -> PointLoad:
        """The solver's load."""
        return PointLoad(self.s, curves(self.force), curves(self.moment), self.frame)


class LoadsSpec(Spec):
    """`gravity` (m/s^2, lab frame), distributed and point loads, viscous `damping` (1/s)."""

    gravity: Triple = NOTHING
    distributed: Annotated[tuple[DistributedSpec, ...], Field(max_length=MOST_LOADS)] = ()
    point: Annotated[tuple[PointSpec, ...], Field(max_length=MOST_LOADS)] = ()
    damping: NotNegative = 0.0


class FluidSpec(Spec):
    """Morison's fluid: `density` (kg/m^3), coefficients, and a uniform `current` (m/s, lab frame)."""

    density: Positive
    added_mass: NotNegative = 0.0
    drag_normal: NotNegative = 0.0
    drag_tangential: NotNegative = 0.0
    current: Triple = NOTHING

    def build(self) -> Fluid:
        """The solver's fluid."""
        return Fluid(self.density, self.added_mass, self.drag_normal, self.drag_tangential, self.current)


class ContactSpec(Spec):
    """Self-contact of Goyal, Perkins & Lee (2003), eq. (6), between points `spacing` (m) apart.

    `k1` (m^(1+k2)/s^2), `k2`, `k3`, `k4`: the law's constants. `aperture_deg`: full angle of the aperture
    in degrees, as the paper gives it. Points nearer than `cutoff` (m) and more than `skip` (m) of arc
    apart act on each other. `sum`: "density" (independent of the spacing) or "grid_points" (as printed).
    """

    k1: NotNegative
    k2: NotNegative
    k3: NotNegative = 0.0
    k4: NotNegative = 1.0
    aperture_deg: Annotated[float, Field(gt=0, le=180, allow_inf_nan=False)]
    cutoff: Positive
    skip: Positive
    spacing: Positive
    sum: Literal["density", "grid_points"] = "density"

    def build(self) -> Contact:
        """The solver's contact law."""
        return Contact(
            self.k1, self.k2, self.k3, self.k4,
            radians(self.aperture_deg), self.cutoff, self.skip, self.spacing, self.sum,
        )  # fmt: skip
