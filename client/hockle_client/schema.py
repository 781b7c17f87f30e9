"""What a case may hold. It is plain data: these types tell editors and type checkers what goes where.

Written by `make client` from the service's schema of cases: change that one.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal, Union

from typing_extensions import NotRequired, TypedDict


class Centreline(TypedDict):
    """A smooth curve through `points` (lab frame), as long as the rod to 0.1 %."""

    a1: NotRequired[Union[Sequence[float], None]]
    """lab direction of the first principal axis at s = 0, made normal to the rod there; not along it. None:
    e1, or e2 where the rod begins along e1
    """

    twist: NotRequired[Union[float, ProfileTable]]
    """profile: turn of the section about the rod, beside parallel transport along it; in rad; default 0.0"""

    velocity: NotRequired[Sequence[float]]
    """lab, of the whole rod; in m/s; default [0.0, 0.0, 0.0]"""

    angular_velocity: NotRequired[Sequence[float]]
    """lab, about the centre of mass of the rod alone; in rad/s; default [0.0, 0.0, 0.0]"""

    shape: Literal["centreline"]
    """which of the two shapes it is"""

    points: Sequence[Sequence[float]]
    """a smooth curve goes through them, as long as the rod to 0.1 %; in m"""


class ContactSpec(TypedDict):
    """Self-contact: `{}`, whose law follows from the rod and its ends, or eq. (6) of Goyal, Perkins & Lee
    (2003).
    """

    k1: NotRequired[Union[float, None]]
    """stiffness; in m^(1+k2)/s²"""

    k2: NotRequired[Union[float, None]]
    """how steeply the force grows; a plain number"""

    k3: NotRequired[Union[float, None]]
    """damping (k3/d) ḋ |ḋ|^k4; it opposes the motion. 0 in eq. (6) where it is not given; in m^(1−k4) s^(k4−1)"""

    k4: NotRequired[Union[float, None]]
    """its power; 1 in eq. (6) where it is not given; a plain number"""

    aperture_deg: NotRequired[Union[float, None]]
    """full angle of the aperture: two points act on each other only if each is in the other's; in degrees"""

    cutoff: NotRequired[Union[float, None]]
    """largest distance that is felt; the force fades over its outer 30 %; in m"""

    skip: NotRequired[Union[float, None]]
    """points nearer than this *along* the rod do not act on each other; 4 D without constants; in m"""

    spacing: NotRequired[Union[float, None]]
    """distance of the contact points along the rod, independent of `numerics.intervals`; 0.4 D without
    constants; in m
    """

    sum: NotRequired[Literal["density", "grid_points"]]
    """of eq. (6). `density`: the force does not depend on the spacing; `grid_points`: the sum as printed in
    the paper, which does; default "density"
    """


class DistributedSpec(TypedDict):
    """Force and moment per length along s, in the lab or the material frame, times `schedule`(t)."""

    force: NotRequired[Sequence[Union[float, ProfileTable]]]
    """three profiles; in N/m; default [0.0, 0.0, 0.0]"""

    moment: NotRequired[Sequence[Union[float, ProfileTable]]]
    """three profiles; in N m/m; default [0.0, 0.0, 0.0]"""

    frame: NotRequired[Literal["material", "lab"]]
    """axes of the components of force and moment; default "lab"
    """

    schedule: NotRequired[Union[float, ScheduleTable]]
    """factor of both in time; a plain number; default 1.0"""


class EndObject(TypedDict):
    """An end: a preset, what differs from it, and switches at later times."""

    x1: NotRequired[Union[Union[float, ScheduleTable], None]]
    """position: displacement along the axis since t = 0 or the switch; it is followed by its change; in m"""

    x2: NotRequired[Union[Union[float, ScheduleTable], None]]
    """position: displacement along the axis since t = 0 or the switch; it is followed by its change; in m"""

    x3: NotRequired[Union[Union[float, ScheduleTable], None]]
    """position: displacement along the axis since t = 0 or the switch; it is followed by its change; in m"""

    f1: NotRequired[Union[Union[float, ScheduleTable], None]]
    """load: internal force; in N"""

    f2: NotRequired[Union[Union[float, ScheduleTable], None]]
    """load: internal force; in N"""

    f3: NotRequired[Union[Union[float, ScheduleTable], None]]
    """load: internal force; in N"""

    theta1: NotRequired[Union[Union[float, ScheduleTable], None]]
    """position: rotation about the axis since t = 0 or the switch; it is followed by its change; in rad"""

    theta2: NotRequired[Union[Union[float, ScheduleTable], None]]
    """position: rotation about the axis since t = 0 or the switch; it is followed by its change; in rad"""

    theta3: NotRequired[Union[Union[float, ScheduleTable], None]]
    """position: rotation about the axis since t = 0 or the switch; it is followed by its change; in rad"""

    q1: NotRequired[Union[Union[float, ScheduleTable], None]]
    """load: internal moment; in N m"""

    q2: NotRequired[Union[Union[float, ScheduleTable], None]]
    """load: internal moment; in N m"""

    q3: NotRequired[Union[Union[float, ScheduleTable], None]]
    """load: internal moment; in N m"""

    preset: NotRequired[Union[Literal["clamp", "pin", "slider", "free"], None]]
    """what holds for components that are not named; without it all six must be"""

    frame: NotRequired[Literal["material", "lab"]]
    """axes of the translation: a1, a2, a3 or e1, e2, e3; rotation is always material; default "material"
    """

    v1: NotRequired[Union[Union[float, ScheduleTable], None]]
    """rate: velocity along the axis; in m/s"""

    v2: NotRequired[Union[Union[float, ScheduleTable], None]]
    """rate: velocity along the axis; in m/s"""

    v3: NotRequired[Union[Union[float, ScheduleTable], None]]
    """rate: velocity along the axis; in m/s"""

    omega1: NotRequired[Union[Union[float, ScheduleTable], None]]
    """rate: angular velocity about the axis; in rad/s"""

    omega2: NotRequired[Union[Union[float, ScheduleTable], None]]
    """rate: angular velocity about the axis; in rad/s"""

    omega3: NotRequired[Union[Union[float, ScheduleTable], None]]
    """rate: angular velocity about the axis; in rad/s"""

    mass: NotRequired[float]
    """m of a body at the end, a point: where it is loaded it pulls with m (g − dv/dt) besides. For `staggered`
    and static analyses; in kg; default 0.0
    """

    switches: NotRequired[Sequence[Switch]]
    """new conditions from later times on, in order; default []"""


class EndsSpec(TypedDict):
    """The two ends: `start` at s = 0 and `end` at s = L."""

    start: Union[Literal["clamp", "pin", "slider", "free"], EndObject]
    """at s = 0: `clamp`, `pin`, `slider`, `free`, or an object with what holds"""

    end: Union[Literal["clamp", "pin", "slider", "free"], EndObject]
    """at s = L, likewise"""


class FloorSpec(TypedDict):
    """An elastic floor with friction, below a plane through the lab point `height` times the unit normal."""

    stiffness: float
    """k: force per length k d at the depth d of the centreline; in N/m²"""

    height: NotRequired[float]
    """of the plane along its normal; in m; default 0.0"""

    normal: NotRequired[Sequence[float]]
    """vector, lab, out of the floor, of any length > 0; default [0.0, 0.0, 1.0]"""

    friction: NotRequired[float]
    """µ: friction µ k d against the motion along the plane; a plain number; default 0.0"""

    slip: NotRequired[float]
    """speed below which friction fades smoothly; in m/s; default 0.001"""


class FluidSpec(TypedDict):
    """Morison's fluid, still or with a current.  u is the velocity of the rod relative to it, u_n its part
    across the rod, u_3 along.
    """

    density: float
    """ρ_w; with gravity it also bears the rod up; in kg/m³"""

    added_mass: NotRequired[float]
    """Ca: inertia force Ca ρ_w A a_n, of the acceleration across the rod; a plain number; default 0.0"""

    drag_normal: NotRequired[float]
    """Cdn: force ½ ρ_w D Cdn |u_n| u_n; a plain number; default 0.0"""

    drag_tangential: NotRequired[float]
    """Cdt: force ½ ρ_w π D Cdt |u_3| u_3; a plain number; default 0.0"""

    viscosity: NotRequired[float]
    """μ: force ζ_n u_n + ζ_t u_3 of slow flow past a thin rod, moment π μ D² ω3; in Pa s; default 0.0"""

    current: NotRequired[Sequence[float]]
    """vector, lab; in m/s; default [0.0, 0.0, 0.0]"""

    shear: NotRequired[Union[ShearSpec, None]]
    """factor of the current by height; without it 1 everywhere"""

    schedule: NotRequired[Union[float, ScheduleTable]]
    """factor of the current in time; a plain number; default 1.0"""


class LoadsSpec(TypedDict):
    """Weight, distributed and point loads, viscous damping."""

    gravity: NotRequired[Sequence[float]]
    """vector, lab; in m/s²; default [0.0, 0.0, 0.0]"""

    distributed: NotRequired[Sequence[DistributedSpec]]
    """loads along the rod: a list of objects with `force`, `moment`, `frame`, `schedule`; default []"""

    point: NotRequired[Sequence[PointSpec]]
    """loads at one place: a list of objects with `s`, `force`, `moment`, `frame`; default []"""

    floor: NotRequired[Union[FloorSpec, None]]
    """an elastic floor"""

    obstacles: NotRequired[Sequence[ObstacleSpec]]
    """bars and balls in the way: a list of objects with `start`, `end`, `radius`, `stiffness`, `friction`;
    default []
    """

    damping: NotRequired[float]
    """c: force −c ρ_c A v and moment −c I ω per length; twice ζ ω of a mode; in 1/s; default 0.0"""


class NumericsSpec(TypedDict):
    """How the equations are solved: see `solver.Numerics`. Either by `intervals` and `dt_max`, or to a
    `tolerance`.
    """

    method: NotRequired[Literal["box", "staggered"]]
    """`box`: the paper's, generalized-alpha; `staggered`: rigid segments and Radau IIA of order 5, more
    accurate at long steps (`rho_inf` and `linear_solver` say nothing to it). With a tolerance, a rod that
    can stretch or resists its own bending, or a body at an end `staggered`, and no other; default "box"
    """

    linear_solver: NotRequired[Literal["block_elimination", "shooting", "banded"]]
    """`shooting`: the paper's, which loses its digits on thin rods at short steps; default "block_elimination"
    """

    intervals: NotRequired[Union[int, None]]
    """along the rod, instead of a tolerance; 200 where another resolution is given. With `static` the fewest
    from there to half as many again that have a node at each point load
    """

    dt_max: NotRequired[Union[float, None]]
    """the largest step, instead of a tolerance; 0.05 where another resolution is given. Steps are shortened
    where the motion or Newton's iteration asks for it; in s
    """

    rho_inf: NotRequired[float]
    """numerical damping of fast motion: 1 is none, 0 the most; default 0.5"""

    rho_inf_space: NotRequired[float]
    """the same along s; 1 is the box scheme. Below 1 only for comparison: slower, needs long steps, and not
    with `shooting`; default 1.0
    """

    increment_tolerance: NotRequired[Union[float, None]]
    """largest error of a step relative to its motion; where none is given box 0.1, staggered 0.01"""

    tolerance: NotRequired[Union[float, None]]
    """relative error of r, curvature and energies, and that of Tw and Wr in turns, at which refining ends: a
    target. 0.001 where nothing else is given but `verify` and `method` `staggered`. Not beside `intervals`,
    `dt_max` or `increment_tolerance`
    """

    verify: NotRequired[bool]
    """also runs with intervals and steps half as long: stores the extrapolated solution, and the estimated
    error of each variable. A tolerance does so by itself; default false
    """


class ObstacleSpec(TypedDict):
    """An elastic obstacle with friction: all that is nearer than `radius` to the segment from `start` to
    `end`.
    """

    start: Sequence[float]
    """point, lab; in m"""

    end: NotRequired[Union[Sequence[float], None]]
    """point, lab; without it the obstacle is a ball about `start`; in m"""

    radius: float
    """distance at which the rod's centreline feels it; in m"""

    stiffness: float
    """k: force per length k d at the depth d of the centreline; in N/m²"""

    friction: NotRequired[float]
    """µ: friction µ k d against the motion along the surface; a plain number; default 0.0"""

    slip: NotRequired[float]
    """speed below which friction fades smoothly; in m/s; default 0.001"""


class OutputSpec(TypedDict):
    """What is stored, and how often."""

    interval: float
    """time between frames, the last of which is at `t_end`. Steps end exactly on frames; with a tolerance on
    every fifth at least, and the frames between lie on the steps' own polynomials; in s
    """

    fields: NotRequired[Sequence[Literal["v", "omega", "f", "kappa", "q", "r", "orientation", "strain"]]]
    """which variables along the rod are stored"""

    topology: NotRequired[bool]
    """whether writhe and linking number are computed, which takes a time that grows with the square of
    `intervals` where strands are near each other; default true
    """


class PointSpec(TypedDict):
    """Force and moment as functions of time at one arclength; at s = 0 or L they add to the end."""

    s: float
    """arclength, at most that of the rod's end; in m"""

    force: NotRequired[Sequence[Union[float, ScheduleTable]]]
    """three schedules; in N; default [0.0, 0.0, 0.0]"""

    moment: NotRequired[Sequence[Union[float, ScheduleTable]]]
    """three schedules; in N m; default [0.0, 0.0, 0.0]"""

    frame: NotRequired[Literal["material", "lab"]]
    """axes of the components of force and moment; `lab` for a force at an end that is free along lab axes;
    default "lab"
    """


class ProfileTable(TypedDict):
    """A function of arclength s (m) through the points (s, value), constant beyond them."""

    s: Sequence[float]
    """arclengths, increasing strictly; in m"""

    value: Sequence[float]

    interpolation: Literal["linear", "smoothstep", "pchip", "cubic"]


class RodSpec(TypedDict):
    """A rod of solid circular section, or with section properties given directly. It stretches where that is
    asked for.  A property given directly takes the place of the modulus or density that it would follow
    from.
    """

    length: float
    """L, along the centreline; in m"""

    diameter: Union[float, ProfileTable]
    """profile; what fluid and contact see: of a tape its width in a flow, its thickness in contact; in m"""

    youngs_modulus: NotRequired[Union[float, None]]
    """E; this or `bending_stiffness`, not both; in Pa"""

    shear_modulus: NotRequired[Union[float, None]]
    """G; this or `torsional_stiffness`, not both; in Pa"""

    density: NotRequired[Union[float, None]]
    """of a solid section, whose mass and inertia it gives where they are not given themselves; in kg/m³"""

    bending_stiffness: NotRequired[Union[Union[Union[float, ProfileTable], Sequence[Union[float, ProfileTable]]], None]]
    """EJ: one profile, or two, EJ1 about a1 and EJ2 about a2; in N m²"""

    torsional_stiffness: NotRequired[Union[Union[float, ProfileTable], None]]
    """GJ: profile; in N m²"""

    coupling: NotRequired[Sequence[Union[float, ProfileTable]]]
    """K23, K13, K12: three profiles, what couples torsion with bending about a2 and about a1, and these two;
    in N m²; default [0.0, 0.0, 0.0]
    """

    sticking_stiffness: NotRequired[Union[Union[float, ProfileTable], None]]
    """EJ: profile, by which bending is stiffer until layers slip; beside `slip_curvature`; in N m²"""

    slip_curvature: NotRequired[Union[Union[float, ProfileTable], None]]
    """profile, the curvature about which layers that stick come to slip; in 1/m"""

    locking_stiffness: NotRequired[Union[Union[float, ProfileTable], None]]
    """EJ: profile, by which bending is stiffer beyond `locking_curvature`; of bend restrictors; in N m²"""

    locking_curvature: NotRequired[Union[Union[float, ProfileTable], None]]
    """profile, the inverse of the radius at which bending locks; in 1/m"""

    axial_stiffness: NotRequired[Union[Union[float, ProfileTable], None]]
    """EA: profile; without it the rod cannot stretch. For `staggered` and static analyses; in N"""

    twist_stretch_coupling: NotRequired[Union[float, ProfileTable]]
    """g: profile, what couples torsion with stretch; beside `axial_stiffness`, and smaller than √(EA GJ).
    Where it is negative, as DNA's, a pull winds the rod up; in N m; default 0.0
    """

    retardation_time: NotRequired[Union[Union[float, ProfileTable], None]]
    """profile, by which the material resists its own bending and twisting. For `staggered`; in s"""

    mass_per_length: NotRequired[Union[Union[float, ProfileTable], None]]
    """profile; in kg/m"""

    inertia_per_length: NotRequired[Union[Sequence[Union[float, ProfileTable]], None]]
    """three profiles, about a1, a2, a3; without it that of a solid section; in kg m"""

    kappa0: NotRequired[Union[Sequence[Union[float, ProfileTable]], Literal["initial"]]]
    """curvature and twist that are free of stress: three profiles, or `"initial"` for those of the initial
    shape; in rad/m; default [0.0, 0.0, 0.0]
    """


class ScheduleTable(TypedDict):
    """A function of time t (s) through the points (t, value), constant before and after them."""

    t: Sequence[float]
    """times, increasing strictly; in s"""

    value: Sequence[float]

    interpolation: Literal["linear", "smoothstep", "pchip", "cubic"]


class ShearSpec(TypedDict):
    """What the current is multiplied by at each height: a function through the points, constant beyond them."""

    height: Sequence[float]
    """along the normal from the lab's origin, increasing strictly; in m"""

    factor: Sequence[float]
    """of the current there; a plain number"""

    interpolation: Literal["linear", "smoothstep", "pchip", "cubic"]
    """of the factor between the points"""

    normal: NotRequired[Sequence[float]]
    """vector, lab, along which heights count, of any length > 0; default [0.0, 0.0, 1.0]"""


class Stop(TypedDict):
    """Bring the component's rate smoothly to zero and hold it there."""

    stop_within: float
    """how long it takes; in s"""


class Straight(TypedDict):
    """A straight rod from `origin` along `direction`, both in the lab frame."""

    a1: NotRequired[Union[Sequence[float], None]]
    """lab direction of the first principal axis at s = 0, made normal to the rod there; not along it. None:
    e1, or e2 where the rod begins along e1
    """

    twist: NotRequired[Union[float, ProfileTable]]
    """profile: turn of the section about the rod, beside parallel transport along it; in rad; default 0.0"""

    velocity: NotRequired[Sequence[float]]
    """lab, of the whole rod; in m/s; default [0.0, 0.0, 0.0]"""

    angular_velocity: NotRequired[Sequence[float]]
    """lab, about the centre of mass of the rod alone; in rad/s; default [0.0, 0.0, 0.0]"""

    shape: Literal["straight"]
    """which of the two shapes it is"""

    origin: NotRequired[Sequence[float]]
    """where s = 0 is; in m; default [0.0, 0.0, 0.0]"""

    direction: NotRequired[Sequence[float]]
    """along the rod, of any length > 0; default [0.0, 0.0, 1.0]"""


class Switch(TypedDict):
    """New conditions from a time on: a preset, and what differs from it; a rate may be a stop."""

    x1: NotRequired[Union[Union[float, ScheduleTable], None]]
    """position: displacement along the axis since t = 0 or the switch; it is followed by its change; in m"""

    x2: NotRequired[Union[Union[float, ScheduleTable], None]]
    """position: displacement along the axis since t = 0 or the switch; it is followed by its change; in m"""

    x3: NotRequired[Union[Union[float, ScheduleTable], None]]
    """position: displacement along the axis since t = 0 or the switch; it is followed by its change; in m"""

    f1: NotRequired[Union[Union[float, ScheduleTable], None]]
    """load: internal force; in N"""

    f2: NotRequired[Union[Union[float, ScheduleTable], None]]
    """load: internal force; in N"""

    f3: NotRequired[Union[Union[float, ScheduleTable], None]]
    """load: internal force; in N"""

    theta1: NotRequired[Union[Union[float, ScheduleTable], None]]
    """position: rotation about the axis since t = 0 or the switch; it is followed by its change; in rad"""

    theta2: NotRequired[Union[Union[float, ScheduleTable], None]]
    """position: rotation about the axis since t = 0 or the switch; it is followed by its change; in rad"""

    theta3: NotRequired[Union[Union[float, ScheduleTable], None]]
    """position: rotation about the axis since t = 0 or the switch; it is followed by its change; in rad"""

    q1: NotRequired[Union[Union[float, ScheduleTable], None]]
    """load: internal moment; in N m"""

    q2: NotRequired[Union[Union[float, ScheduleTable], None]]
    """load: internal moment; in N m"""

    q3: NotRequired[Union[Union[float, ScheduleTable], None]]
    """load: internal moment; in N m"""

    at: float
    """the time from which on the new conditions hold; in s"""

    preset: NotRequired[Union[Literal["clamp", "pin", "slider", "free"], None]]
    """what holds from then on for components that are not named: `free` lets the end go"""

    v1: NotRequired[Union[Union[Union[float, ScheduleTable], Stop], None]]
    """rate: velocity along the axis, or a stop; in m/s"""

    v2: NotRequired[Union[Union[Union[float, ScheduleTable], Stop], None]]
    """rate: velocity along the axis, or a stop; in m/s"""

    v3: NotRequired[Union[Union[Union[float, ScheduleTable], Stop], None]]
    """rate: velocity along the axis, or a stop; in m/s"""

    omega1: NotRequired[Union[Union[Union[float, ScheduleTable], Stop], None]]
    """rate: angular velocity about the axis, or a stop; in rad/s"""

    omega2: NotRequired[Union[Union[Union[float, ScheduleTable], Stop], None]]
    """rate: angular velocity about the axis, or a stop; in rad/s"""

    omega3: NotRequired[Union[Union[Union[float, ScheduleTable], Stop], None]]
    """rate: angular velocity about the axis, or a stop; in rad/s"""


class CaseSpec(TypedDict):
    """One case. All quantities in SI units; s is the arclength from the start, t the time."""

    schema_version: int
    """of these fields and their meaning"""

    analysis: NotRequired[Literal["dynamic", "static"]]
    """`static`: equilibria instead of motion; default "dynamic"
    """

    name: NotRequired[str]
    """small letters, digits and hyphens, at most 80; names the output file; default "unnamed"
    """

    title: NotRequired[str]
    """for people: at most 200 characters; default ""
    """

    description: NotRequired[str]
    """for people: at most 5000 characters; default ""
    """

    rod: RodSpec
    """length and section"""

    initial: Union[Straight, Centreline]
    """shape and motion at t = 0"""

    ends: EndsSpec
    """`start` at s = 0 and `end` at s = L"""

    fluid: NotRequired[Union[FluidSpec, None]]
    """water around the rod"""

    loads: NotRequired[LoadsSpec]
    """weight, given loads, damping"""

    contact: NotRequired[Union[ContactSpec, None]]
    """self-contact; without it the rod passes through itself"""

    numerics: NotRequired[NumericsSpec]
    """how the equations are solved; to a tolerance, where nothing is said; default {}"""

    t_end: float
    """how long to simulate; in s"""

    output: OutputSpec
    """what is stored, and how often"""


Setting = Literal[
    "analysis",
    "contact",
    "contact.aperture_deg",
    "contact.cutoff",
    "contact.k1",
    "contact.k2",
    "contact.k3",
    "contact.k4",
    "contact.skip",
    "contact.spacing",
    "contact.sum",
    "description",
    "ends",
    "ends.end",
    "ends.end.f1",
    "ends.end.f1.interpolation",
    "ends.end.f1.t",
    "ends.end.f1.value",
    "ends.end.f2",
    "ends.end.f2.interpolation",
    "ends.end.f2.t",
    "ends.end.f2.value",
    "ends.end.f3",
    "ends.end.f3.interpolation",
    "ends.end.f3.t",
    "ends.end.f3.value",
    "ends.end.frame",
    "ends.end.mass",
    "ends.end.omega1",
    "ends.end.omega1.interpolation",
    "ends.end.omega1.t",
    "ends.end.omega1.value",
    "ends.end.omega2",
    "ends.end.omega2.interpolation",
    "ends.end.omega2.t",
    "ends.end.omega2.value",
    "ends.end.omega3",
    "ends.end.omega3.interpolation",
    "ends.end.omega3.t",
    "ends.end.omega3.value",
    "ends.end.preset",
    "ends.end.q1",
    "ends.end.q1.interpolation",
    "ends.end.q1.t",
    "ends.end.q1.value",
    "ends.end.q2",
    "ends.end.q2.interpolation",
    "ends.end.q2.t",
    "ends.end.q2.value",
    "ends.end.q3",
    "ends.end.q3.interpolation",
    "ends.end.q3.t",
    "ends.end.q3.value",
    "ends.end.switches",
    "ends.end.theta1",
    "ends.end.theta1.interpolation",
    "ends.end.theta1.t",
    "ends.end.theta1.value",
    "ends.end.theta2",
    "ends.end.theta2.interpolation",
    "ends.end.theta2.t",
    "ends.end.theta2.value",
    "ends.end.theta3",
    "ends.end.theta3.interpolation",
    "ends.end.theta3.t",
    "ends.end.theta3.value",
    "ends.end.v1",
    "ends.end.v1.interpolation",
    "ends.end.v1.t",
    "ends.end.v1.value",
    "ends.end.v2",
    "ends.end.v2.interpolation",
    "ends.end.v2.t",
    "ends.end.v2.value",
    "ends.end.v3",
    "ends.end.v3.interpolation",
    "ends.end.v3.t",
    "ends.end.v3.value",
    "ends.end.x1",
    "ends.end.x1.interpolation",
    "ends.end.x1.t",
    "ends.end.x1.value",
    "ends.end.x2",
    "ends.end.x2.interpolation",
    "ends.end.x2.t",
    "ends.end.x2.value",
    "ends.end.x3",
    "ends.end.x3.interpolation",
    "ends.end.x3.t",
    "ends.end.x3.value",
    "ends.start",
    "ends.start.f1",
    "ends.start.f1.interpolation",
    "ends.start.f1.t",
    "ends.start.f1.value",
    "ends.start.f2",
    "ends.start.f2.interpolation",
    "ends.start.f2.t",
    "ends.start.f2.value",
    "ends.start.f3",
    "ends.start.f3.interpolation",
    "ends.start.f3.t",
    "ends.start.f3.value",
    "ends.start.frame",
    "ends.start.mass",
    "ends.start.omega1",
    "ends.start.omega1.interpolation",
    "ends.start.omega1.t",
    "ends.start.omega1.value",
    "ends.start.omega2",
    "ends.start.omega2.interpolation",
    "ends.start.omega2.t",
    "ends.start.omega2.value",
    "ends.start.omega3",
    "ends.start.omega3.interpolation",
    "ends.start.omega3.t",
    "ends.start.omega3.value",
    "ends.start.preset",
    "ends.start.q1",
    "ends.start.q1.interpolation",
    "ends.start.q1.t",
    "ends.start.q1.value",
    "ends.start.q2",
    "ends.start.q2.interpolation",
    "ends.start.q2.t",
    "ends.start.q2.value",
    "ends.start.q3",
    "ends.start.q3.interpolation",
    "ends.start.q3.t",
    "ends.start.q3.value",
    "ends.start.switches",
    "ends.start.theta1",
    "ends.start.theta1.interpolation",
    "ends.start.theta1.t",
    "ends.start.theta1.value",
    "ends.start.theta2",
    "ends.start.theta2.interpolation",
    "ends.start.theta2.t",
    "ends.start.theta2.value",
    "ends.start.theta3",
    "ends.start.theta3.interpolation",
    "ends.start.theta3.t",
    "ends.start.theta3.value",
    "ends.start.v1",
    "ends.start.v1.interpolation",
    "ends.start.v1.t",
    "ends.start.v1.value",
    "ends.start.v2",
    "ends.start.v2.interpolation",
    "ends.start.v2.t",
    "ends.start.v2.value",
    "ends.start.v3",
    "ends.start.v3.interpolation",
    "ends.start.v3.t",
    "ends.start.v3.value",
    "ends.start.x1",
    "ends.start.x1.interpolation",
    "ends.start.x1.t",
    "ends.start.x1.value",
    "ends.start.x2",
    "ends.start.x2.interpolation",
    "ends.start.x2.t",
    "ends.start.x2.value",
    "ends.start.x3",
    "ends.start.x3.interpolation",
    "ends.start.x3.t",
    "ends.start.x3.value",
    "fluid",
    "fluid.added_mass",
    "fluid.current",
    "fluid.density",
    "fluid.drag_normal",
    "fluid.drag_tangential",
    "fluid.schedule",
    "fluid.schedule.interpolation",
    "fluid.schedule.t",
    "fluid.schedule.value",
    "fluid.shear",
    "fluid.shear.factor",
    "fluid.shear.height",
    "fluid.shear.interpolation",
    "fluid.shear.normal",
    "fluid.viscosity",
    "initial",
    "initial.a1",
    "initial.angular_velocity",
    "initial.direction",
    "initial.origin",
    "initial.points",
    "initial.shape",
    "initial.twist",
    "initial.twist.interpolation",
    "initial.twist.s",
    "initial.twist.value",
    "initial.velocity",
    "loads",
    "loads.damping",
    "loads.distributed",
    "loads.floor",
    "loads.floor.friction",
    "loads.floor.height",
    "loads.floor.normal",
    "loads.floor.slip",
    "loads.floor.stiffness",
    "loads.gravity",
    "loads.obstacles",
    "loads.point",
    "name",
    "numerics",
    "numerics.dt_max",
    "numerics.increment_tolerance",
    "numerics.intervals",
    "numerics.linear_solver",
    "numerics.method",
    "numerics.rho_inf",
    "numerics.rho_inf_space",
    "numerics.tolerance",
    "numerics.verify",
    "output",
    "output.fields",
    "output.interval",
    "output.topology",
    "rod",
    "rod.axial_stiffness",
    "rod.axial_stiffness.interpolation",
    "rod.axial_stiffness.s",
    "rod.axial_stiffness.value",
    "rod.bending_stiffness",
    "rod.bending_stiffness.interpolation",
    "rod.bending_stiffness.s",
    "rod.bending_stiffness.value",
    "rod.coupling",
    "rod.density",
    "rod.diameter",
    "rod.diameter.interpolation",
    "rod.diameter.s",
    "rod.diameter.value",
    "rod.inertia_per_length",
    "rod.kappa0",
    "rod.length",
    "rod.locking_curvature",
    "rod.locking_curvature.interpolation",
    "rod.locking_curvature.s",
    "rod.locking_curvature.value",
    "rod.locking_stiffness",
    "rod.locking_stiffness.interpolation",
    "rod.locking_stiffness.s",
    "rod.locking_stiffness.value",
    "rod.mass_per_length",
    "rod.mass_per_length.interpolation",
    "rod.mass_per_length.s",
    "rod.mass_per_length.value",
    "rod.retardation_time",
    "rod.retardation_time.interpolation",
    "rod.retardation_time.s",
    "rod.retardation_time.value",
    "rod.shear_modulus",
    "rod.slip_curvature",
    "rod.slip_curvature.interpolation",
    "rod.slip_curvature.s",
    "rod.slip_curvature.value",
    "rod.sticking_stiffness",
    "rod.sticking_stiffness.interpolation",
    "rod.sticking_stiffness.s",
    "rod.sticking_stiffness.value",
    "rod.torsional_stiffness",
    "rod.torsional_stiffness.interpolation",
    "rod.torsional_stiffness.s",
    "rod.torsional_stiffness.value",
    "rod.twist_stretch_coupling",
    "rod.twist_stretch_coupling.interpolation",
    "rod.twist_stretch_coupling.s",
    "rod.twist_stretch_coupling.value",
    "rod.youngs_modulus",
    "schema_version",
    "t_end",
    "title",
]
"""The dotted keys of a case without those that count entries, as loads.point.0.s."""
