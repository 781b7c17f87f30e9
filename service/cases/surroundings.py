"""What acts on the rod of a case: loads, the fluid, and the rod itself where it touches."""

from __future__ import annotations

from math import radians
from typing import Annotated, Any, Literal, Self

from pydantic import Field, model_validator

from service.cases.errors import refusal
from service.cases.quantities import (
    Column,
    Finite,
    FrameName,
    Interpolation,
    NotNegative,
    Positive,
    ProfileTriple,
    Schedule,
    ScheduleTriple,
    Spec,
    Triple,
    check_table,
    curve,
    curves,
)
from service.meaning import means
from solver import Contact, Curve, DistributedLoad, Fluid, PointLoad, Shear
from solver.physics.loads.solids import Floor, Obstacle

MOST_LOADS = 100
MOST_OBSTACLES = 20
NOTHING: Triple = (0.0, 0.0, 0.0)
NEEDED = ("k1", "k2", "aperture_deg", "cutoff")
"""Constants of eq. (6) that are given all, or none."""
DAMPING = {"k3": 0.0, "k4": 1.0}
"""Those that may be left out."""


class DistributedSpec(Spec):
    """Force and moment per length along s, in the lab or the material frame, times `schedule`(t)."""

    force: Annotated[ProfileTriple, means("three profiles", "N/m")] = NOTHING
    moment: Annotated[ProfileTriple, means("three profiles", "N m/m")] = NOTHING
    frame: Annotated[FrameName, means("axes of the components of force and moment")] = "lab"
    schedule: Annotated[Schedule, means("factor of both in time", "1")] = 1.0

    def build(self) -> DistributedLoad:
        """The solver's load."""
        return DistributedLoad(curves(self.force), curves(self.moment), self.frame, curve(self.schedule))


class PointSpec(Spec):
    """Force and moment as functions of time at one arclength; at s = 0 or L they add to the end."""

    s: Annotated[NotNegative, means("arclength, at most that of the rod's end", "m")]
    force: Annotated[ScheduleTriple, means("three schedules", "N")] = NOTHING
    moment: Annotated[ScheduleTriple, means("three schedules", "N m")] = NOTHING
    frame: Annotated[
        FrameName,
        means("axes of the components of force and moment; `lab` for a force at an end that is free along lab axes"),
    ] = "lab"

    def build(self) -> PointLoad:
        """The solver's load."""
        return PointLoad(self.s, curves(self.force), curves(self.moment), self.frame)


class FloorSpec(Spec):
    """An elastic floor with friction, below a plane through the lab point `height` times the unit normal."""

    stiffness: Annotated[Positive, means("k: force per length k d at the depth d of the centreline", "N/m²")]
    height: Annotated[Finite, means("of the plane along its normal", "m")] = 0.0
    normal: Annotated[Triple, means("vector, lab, out of the floor, of any length > 0")] = (0.0, 0.0, 1.0)
    friction: Annotated[NotNegative, means("µ: friction µ k d against the motion along the plane", "1")] = 0.0
    slip: Annotated[Positive, means("speed below which friction fades smoothly", "m/s")] = 1e-3

    @model_validator(mode="after")
    def _check(self) -> Self:
        if not any(self.normal):
            raise refusal("normal", self.normal, "must not be zero")
        return self

    def build(self) -> Floor:
        """The solver's load."""
        return Floor(self.stiffness, self.height, self.normal, self.friction, self.slip)


class ObstacleSpec(Spec):
    """An elastic obstacle with friction: all that is nearer than `radius` to the segment from `start` to `end`."""

    start: Annotated[Triple, means("point, lab", "m")]
    end: Annotated[
        Triple | None, means("point, lab; without it the obstacle is a ball about `start`", "m")
    ] = None
    radius: Annotated[Positive, means("distance at which the rod's centreline feels it", "m")]
    stiffness: Annotated[Positive, means("k: force per length k d at the depth d of the centreline", "N/m²")]
    friction: Annotated[NotNegative, means("µ: friction µ k d against the motion along the surface", "1")] = 0.0
    slip: Annotated[Positive, means("speed below which friction fades smoothly", "m/s")] = 1e-3

    def build(self) -> Obstacle:
        """The solver's load."""
        end = self.start if self.end is None else self.end
        return Obstacle(self.start, end, self.radius, self.stiffness, self.friction, self.slip)


class LoadsSpec(Spec):
    """Weight, distributed and point loads, viscous damping."""

    gravity: Annotated[Triple, means("vector, lab", "m/s²")] = NOTHING
    distributed: Annotated[
        tuple[DistributedSpec, ...],
        Field(max_length=MOST_LOADS),
        means("loads along the rod: a list of objects with `force`, `moment`, `frame`, `schedule`"),
    ] = ()
    point: Annotated[
        tuple[PointSpec, ...],
        Field(max_length=MOST_LOADS),
        means("loads at one place: a list of objects with `s`, `force`, `moment`, `frame`"),
    ] = ()
    floor: Annotated[FloorSpec | None, means("an elastic floor")] = None
    obstacles: Annotated[
        tuple[ObstacleSpec, ...],
        Field(max_length=MOST_OBSTACLES),
        means("bars and balls in the way: a list of objects with `start`, `end`, `radius`, `stiffness`, `friction`"),
    ] = ()
    damping: Annotated[
        NotNegative, means("c: force −c ρ_c A v and moment −c I ω per length; twice ζ ω of a mode", "1/s")
    ] = 0.0


    def others(self) -> tuple[object, ...]:
        """The solver's loads of all other kinds."""
        solid = () if self.floor is None else (self.floor,)
        return tuple(spec.build() for spec in (*solid, *self.obstacles))


class ShearSpec(Spec):
    """What the current is multiplied by at each height: a function through the points, constant beyond them."""

    height: Annotated[Column, means("along the normal from the lab's origin, increasing strictly", "m")]
    factor: Annotated[Column, means("of the current there", "1")]
    interpolation: Annotated[Interpolation, means("of the factor between the points")]
    normal: Annotated[Triple, means("vector, lab, along which heights count, of any length > 0")] = (0.0, 0.0, 1.0)

    @model_validator(mode="after")
    def _check(self) -> Self:
        check_table("height", self.height, self.factor, "factor")
        if not any(self.normal):
            raise refusal("normal", self.normal, "must not be zero")
        return self

    def build(self) -> Shear:
        """The solver's shear."""
        return Shear(Curve.table(self.height, self.factor, self.interpolation), self.normal)


class FluidSpec(Spec):
    """Morison's fluid, still or with a current.

    u is the velocity of the rod relative to it, u_n its part across the rod, u_3 along.
    """

    density: Annotated[Positive, means("ρ_w; with gravity it also bears the rod up", "kg/m³")]
    added_mass: Annotated[
        NotNegative, means("Ca: inertia force Ca ρ_w A a_n, of the acceleration across the rod", "1")
    ] = 0.0
    drag_normal: Annotated[NotNegative, means("Cdn: force ½ ρ_w D Cdn |u_n| u_n", "1")] = 0.0
    drag_tangential: Annotated[NotNegative, means("Cdt: force ½ ρ_w π D Cdt |u_3| u_3", "1")] = 0.0
    viscosity: Annotated[
        NotNegative, means("μ: force ζ_n u_n + ζ_t u_3 of slow flow past a thin rod, moment π μ D² ω3", "Pa s")
    ] = 0.0
    current: Annotated[Triple, means("vector, lab", "m/s")] = NOTHING
    shear: Annotated[ShearSpec | None, means("factor of the current by height; without it 1 everywhere")] = None
    schedule: Annotated[Schedule, means("factor of the current in time", "1")] = 1.0

    def build(self) -> Fluid:
        """The solver's fluid."""
        shear = self.shear.build() if self.shear else None
        return Fluid(self.density, self.added_mass, self.drag_normal, self.drag_tangential, self.current, shear,
                     curve(self.schedule), self.viscosity)  # fmt: skip


class ContactSpec(Spec):
    """Self-contact: `{}`, whose law follows from the rod and its ends, or eq. (6) of Goyal, Perkins & Lee (2003)."""

    k1: Annotated[NotNegative | None, means("stiffness", "m^(1+k2)/s²")] = None
    k2: Annotated[NotNegative | None, means("how steeply the force grows", "1")] = None
    k3: Annotated[
        NotNegative | None,
        means("damping (k3/d) ḋ |ḋ|^k4; it opposes the motion. 0 in eq. (6) where it is not given",
              "m^(1−k4) s^(k4−1)"),
    ] = None  # fmt: skip
    k4: Annotated[NotNegative | None, means("its power; 1 in eq. (6) where it is not given", "1")] = None
    aperture_deg: Annotated[
        Annotated[float, Field(gt=0, le=180, allow_inf_nan=False)] | None,
        means("full angle of the aperture: two points act on each other only if each is in the other's", "degrees"),
    ] = None
    cutoff: Annotated[
        Positive | None, means("largest distance that is felt; the force fades over its outer 30 %", "m")
    ] = None
    skip: Annotated[
        Positive | None,
        means("points nearer than this *along* the rod do not act on each other; 4 D without constants", "m"),
    ] = None
    spacing: Annotated[
        Positive | None,
        means("distance of the contact points along the rod, independent of `numerics.intervals`; 0.4 D without "
              "constants", "m"),
    ] = None  # fmt: skip
    sum: Annotated[
        Literal["density", "grid_points"],
        means("of eq. (6). `density`: the force does not depend on the spacing; `grid_points`: the sum as printed in "
              "the paper, which does"),
    ] = "density"  # fmt: skip

    @model_validator(mode="before")
    @classmethod
    def _fill_in(cls, raw: Any) -> Any:
        """Eq. (6) without damping, unless told."""
        if isinstance(raw, dict) and any(raw.get(name) is not None for name in NEEDED):
            return {**raw, **{name: value for name, value in DAMPING.items() if raw.get(name) is None}}
        return raw

    @model_validator(mode="after")
    def _check(self) -> Self:
        constants = [name for name in (*NEEDED, *DAMPING) if getattr(self, name) is not None]
        if constants:
            for name in (*NEEDED, "skip", "spacing"):
                if getattr(self, name) is None:
                    raise refusal(name, None, f"is required beside {constants[0]}: all constants of eq. (6), or none")
        elif self.sum != "density":
            raise refusal("sum", self.sum, "must be density where no constants of eq. (6) are given")
        return self

    def build(self) -> Contact:
        """The solver's contact law."""
        aperture = None if self.aperture_deg is None else radians(self.aperture_deg)
        return Contact(
            self.k1, self.k2, self.k3, self.k4, aperture, self.cutoff, self.skip, self.spacing, self.sum
        )
