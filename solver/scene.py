"""Everything that a simulation is told: plain data, checked when it is made. SI units throughout.

Material frame: a3 is the centreline's tangent, a1 and a2 the principal axes of the section.
Lab frame: e1, e2, e3. An end condition or a load says in which frame its components are.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import pairwise
from numbers import Integral
from typing import Literal

import numpy as np

from solver.curve import Curve, Vector, constant_vector
from solver.rod import Array, Profile, Profiles, Rod

Frame_ = Literal["material", "lab"]
ZERO: Vector = constant_vector((0.0, 0.0, 0.0))


def _require_finite(name: str, vector: tuple[float, float, float]) -> None:
    if not np.isfinite(vector).all():
        raise ValueError(f"{name} must be finite, got {vector}")


@dataclass(frozen=True)
class Initial:
    """The rod at t = 0.

    `centreline` maps arclengths s (n,) to lab positions (n, 3) in m with |r_s| = 1; `a1` is the lab
    direction (made normal to the tangent) of the first principal axis at s = 0; along s the frame
    follows by parallel transport, turned about the tangent by `twist` (rad). `velocity` (m/s) and
    `angular_velocity` (rad/s, about the centre of mass) are a rigid motion in the lab frame.
    """

    centreline: Callable[[Array], Array]
    a1: tuple[float, float, float] = (1.0, 0.0, 0.0)
    twist: Profile = field(default_factory=lambda: Curve.constant(0.0))
    velocity: tuple[float, float, float] = (0.0, 0.0, 0.0)
    angular_velocity: tuple[float, float, float] = (0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        for name in ("a1", "velocity", "angular_velocity"):
            _require_finite(f"initial {name}", getattr(self, name))

    @classmethod
    def straight(
        cls,
        origin: tuple[float, float, float] = (0.0, 0.0, 0.0),
        direction: tuple[float, float, float] = (0.0, 0.0, 1.0),
        **others: object,
    ) -> Initial:
        """A straight rod from `origin` along `direction` (of any length > 0)."""
        start, along = np.array(origin, dtype=float), np.array(direction, dtype=float)
        norm = float(np.linalg.norm(along))
        if not norm > 0:
            raise ValueError(f"direction must not be zero, got {direction}")
        return cls(centreline=lambda s: start + np.outer(s, along / norm), **others)  # type: ignore[arg-type]

    @classmethod
    def through(cls, points: Array, length: float, **others: object) -> Initial:
        """A smooth centreline through lab points (n >= 4, 3), re-parametrised by arclength.

        Raises ValueError if its length differs from `length` by more than 0.1 %; a smaller
        difference is taken up by scaling about the first point.
        """
        from solver.initial import arclength_spline

        return cls(centreline=arclength_spline(points, length), **others)  # type: ignore[arg-type]


@dataclass(frozen=True)
class Condition:
    """What holds at an end for one component, from time `since` on.

    `kind`:
      "rate"      velocity (m/s) or angular velocity (rad/s) is `curve`(t);
      "position"  displacement (m) along, or rotation (rad) about, the axis since `since` is `curve`(t) less
                  `curve`(since);
      "load"      force (N) or moment (N m) is `curve`(t), the internal f_i or q_i at that end;
      "stop"      the rate that the component has at `since` is brought to zero by a smoothstep
                  within `within` s (> 0), and held at zero.
    """

    kind: Literal["rate", "position", "load", "stop"]
    curve: Curve = field(default_factory=lambda: Curve.constant(0.0))
    since: float = 0.0
    within: float = 0.0

    def __post_init__(self) -> None:
        if self.kind == "stop" and not self.within > 0:
            raise ValueError(f"within must be > 0 s for a stop, got {self.within}")


Component = tuple[Condition, ...]
"""The conditions of one component in order of `since`; the first has since = 0."""

FIXED: Component = (Condition("rate"),)
FREE: Component = (Condition("load"),)


@dataclass(frozen=True)
class End:
    """Six conditions: translation along, and rotation about, three axes.

    `translation[i]` is on v_i or f_i, `rotation[i]` on omega_i or q_i. The components of the
    translation are along a1, a2, a3 (`frame` "material") or e1, e2, e3 ("lab"); those of the
    rotation are always material.
    """

    translation: tuple[Component, Component, Component]
    rotation: tuple[Component, Component, Component]
    frame: Frame_ = "material"

    def __post_init__(self) -> None:
        for name, components in (("translation", self.translation), ("rotation", self.rotation)):
            for i, component in enumerate(components):
                times = [c.since for c in component]
                if not times or times[0] != 0.0 or any(a >= b for a, b in pairwise(times)):
                    raise ValueError(f"{name}[{i}]: since must start at 0 and increase, got {times}")
                if component[0].kind == "stop":
                    raise ValueError(f"{name}[{i}]: a stop needs a condition before it")

    @classmethod
    def clamp(cls) -> End:
        """Held in position and in rotation."""
        return cls((FIXED, FIXED, FIXED), (FIXED, FIXED, FIXED))

    @classmethod
    def pin(cls) -> End:
        """Held in position, free to rotate."""
        return cls((FIXED, FIXED, FIXED), (FREE, FREE, FREE))

    @classmethod
    def slider(cls) -> End:
        """Held in rotation and across, free to slide along a3."""
        return cls((FIXED, FIXED, FREE), (FIXED, FIXED, FIXED))

    @classmethod
    def free(cls) -> End:
        """No force, no moment."""
        return cls((FREE, FREE, FREE), (FREE, FREE, FREE))


@dataclass(frozen=True)
class DistributedLoad:
    """Force (N/m) and moment (N m/m) per length along s, times `schedule`(t)."""

    force: Profiles = ZERO
    moment: Profiles = ZERO
    frame: Frame_ = "lab"
    schedule: Curve = field(default_factory=lambda: Curve.constant(1.0))


@dataclass(frozen=True)
class PointLoad:
    """Force (N) and moment (N m) as functions of time at arclength `s`; at s = 0 or L it adds to the end."""

    s: float
    force: Vector = ZERO
    moment: Vector = ZERO
    frame: Frame_ = "lab"


@dataclass(frozen=True)
class Fluid:
    """Morison's fluid of density rho_w (kg/m^3), still or with a uniform lab current U (m/s).

    Relative velocity u = v - R^T U. Normal added mass `added_mass` rho_w A; normal drag
    0.5 rho_w D `drag_normal` |u_n| u_n; tangential 0.5 rho_w pi D `drag_tangential` |u_3| u_3.
    With gravity it also bears the rod up by rho_w A g.
    """

    density: float
    added_mass: float = 0.0
    drag_normal: float = 0.0
    drag_tangential: float = 0.0
    current: tuple[float, float, float] = (0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        for name in ("density", "added_mass", "drag_normal", "drag_tangential"):
            value = getattr(self, name)
            if not (np.isfinite(value) and value >= 0):
                raise ValueError(f"fluid {name} must be >= 0, got {value}")
        _require_finite("fluid current", self.current)


@dataclass(frozen=True)
class Contact:
    """Self-contact after eq. (6): rho_c A (k1/(d - D/2)^k2 - (k3/d) d_t |d_t|^k4).

    Between points `spacing` (m) apart along the centreline, nearer than `cutoff` (m), more than
    `skip` (m) of arc apart, each within the other's aperture (full angle `aperture`, rad). `sum`
    "density": the force of a pair is weighted by spacing / 1 mm, so that it does not depend on the
    spacing; "grid_points": the sum as printed, which does.
    """

    k1: float
    k2: float
    k3: float
    k4: float
    aperture: float
    cutoff: float
    skip: float
    spacing: float
    sum: Literal["density", "grid_points"] = "density"

    def __post_init__(self) -> None:
        for name in ("k1", "k2", "k3", "k4"):
            value = getattr(self, name)
            if not (np.isfinite(value) and value >= 0):
                raise ValueError(f"contact {name} must be >= 0, got {value}")
        for name in ("cutoff", "skip", "spacing"):
            value = getattr(self, name)
            if not (np.isfinite(value) and value > 0):
                raise ValueError(f"contact {name} must be > 0 m, got {value}")
        if not 0 < self.aperture <= np.pi:
            raise ValueError(f"contact aperture must be in (0, pi] rad, got {self.aperture}")


@dataclass(frozen=True)
class Numerics:
    """How the equations are solved.

    `intervals` of equal length along s; `dt_max` the largest step (s); `rho_inf` the spectral radius
    of generalized-alpha at infinite frequency in time, `rho_inf_space` the same along s (1 is the box
    scheme); `increment_tolerance` bounds each step's error relative to the step's motion (None: the method's own).

    With a `tolerance` (staggered method) pilot runs choose the intervals, at most `most_intervals`, and the steps, so
    that the relative error of r, kappa and the energies is below it. `verify`: the scene also runs with intervals and
    steps half as long, and the frames have the extrapolated solution and an estimate of its error.
    """

    method: Literal["box", "staggered"] = "box"
    linear_solver: Literal["block_elimination", "shooting"] = "block_elimination"
    intervals: int = 200
    dt_max: float = 0.1
    rho_inf: float = 0.5
    rho_inf_space: float = 1.0
    increment_tolerance: float | None = None
    tolerance: float | None = None
    most_intervals: int = 2000
    verify: bool = False

    def __post_init__(self) -> None:
        intervals: object = self.intervals  # whatever it was promised to be
        if isinstance(intervals, bool) or not isinstance(intervals, Integral) or int(intervals) < 2:
            raise ValueError(f"intervals must be a whole number >= 2, got {self.intervals}")
        if not (np.isfinite(self.dt_max) and self.dt_max > 0):
            raise ValueError(f"dt_max must be > 0 s, got {self.dt_max}")
        for name in ("rho_inf", "rho_inf_space"):
            if not 0 <= getattr(self, name) <= 1:
                raise ValueError(f"{name} must be in [0, 1], got {getattr(self, name)}")
        if self.linear_solver == "shooting" and self.rho_inf_space != 1.0:
            raise ValueError(f"rho_inf_space must be 1 with linear_solver shooting, got {self.rho_inf_space}")
        for name in ("increment_tolerance", "tolerance"):
            value = getattr(self, name)
            if value is not None and not value > 0:
                raise ValueError(f"{name} must be > 0, got {value}")
        if self.tolerance is not None and self.method != "staggered":
            raise ValueError(f"method must be staggered with a tolerance, got {self.method}")


@dataclass(frozen=True)
class Scene:
    """One case, ready to be simulated."""

    rod: Rod
    initial: Initial
    start: End
    end: End
    t_end: float
    output_interval: float
    gravity: tuple[float, float, float] = (0.0, 0.0, 0.0)
    distributed: tuple[DistributedLoad, ...] = ()
    points: tuple[PointLoad, ...] = ()
    damping: float = 0.0
    """Viscous damping c (1/s): B = -c rho_c A v, Q = -c I omega."""
    fluid: Fluid | None = None
    contact: Contact | None = None
    numerics: Numerics = field(default_factory=Numerics)
    topology: bool = True
    """Whether the frames carry Wr and Lk."""
    analysis: Literal["dynamic", "static"] = "dynamic"
    """"static": a branch of equilibria, with time as the parameter of loads and ends."""

    def __post_init__(self) -> None:
        if not (np.isfinite(self.t_end) and self.t_end > 0):
            raise ValueError(f"t_end must be > 0 s, got {self.t_end}")
        if not 0 < self.output_interval <= self.t_end:
            raise ValueError(f"output_interval must be in (0, t_end], got {self.output_interval}")
        if not (np.isfinite(self.damping) and self.damping >= 0):
            raise ValueError(f"damping must be >= 0 1/s, got {self.damping}")
        _require_finite("gravity", self.gravity)
        if self.analysis == "static":
            self._check_statics()
        if self.contact is not None and self.numerics.intervals < 3:
            raise ValueError(f"intervals must be >= 3 with contact, got {self.numerics.intervals}")
        for load in self.points:
            if not 0 <= load.s <= self.rod.length:
                raise ValueError(f"s of a point load must be in [0, {self.rod.length}] m, got {load.s}")
            self._check_frame(load)

    def _check_frame(self, load: PointLoad) -> None:
        """A force that follows the rod cannot be added to a condition on the components of f along lab axes."""
        end = {0.0: self.start, self.rod.length: self.end}.get(load.s)
        if end is None or self.analysis == "static" or (load.frame, end.frame) != ("material", "lab"):
            return
        loaded = any(condition.kind == "load" for component in end.translation for condition in component)
        if loaded and not all(curve.is_zero for curve in load.force):
            raise ValueError('frame of a force at an end that is free along lab axes must be "lab", got "material"')

    def _check_statics(self) -> None:
        if self.contact is not None:
            raise ValueError("contact must not be given with a static analysis")
        if any((*self.initial.velocity, *self.initial.angular_velocity)):
            raise ValueError("velocity and angular_velocity must be 0 in a static analysis")
        if self.numerics.tolerance is not None:
            raise ValueError("tolerance must not be given with a static analysis: give intervals")

    @property
    def outputs(self) -> list[float]:
        """The times (s) of the frames, but for that of t = 0."""
        count = round(self.t_end / self.output_interval)
        times = [min(k * self.output_interval, self.t_end) for k in range(1, count + 1)]
        if not times or times[-1] < self.t_end * (1 - 1e-12):
            times.append(self.t_end)
        return times
