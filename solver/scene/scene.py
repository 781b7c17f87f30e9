"""Everything that a simulation is told: plain data, checked when it is made. SI units throughout.

Material frame: a3 is the centreline's tangent, a1 and a2 the principal axes of the section.
Lab frame: e1, e2, e3. An end condition or a load says in which frame its components are.
"""

from __future__ import annotations

from dataclasses import dataclass, field, fields
from typing import Literal

import numpy as np

from solver.scene.checks import require_finite
from solver.scene.contact import Contact
from solver.scene.ends import End
from solver.scene.fluid import Fluid
from solver.scene.initial import Initial
from solver.scene.loads import DistributedLoad, PointLoad
from solver.scene.numerics import Numerics
from solver.scene.rod import Rod
from solver.scene.view import View, answer

MOST_AT_REST = 1000
"""Intervals that a static analysis with contact may have: it counts directions of falling energy among all rotations
together, in arrays of 9 numbers for each two intervals."""


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
    loads: tuple[object, ...] = ()
    """Other loads: `UserLoad`s, and what is `Given` by a module of `physics.loads`."""
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
        require_finite("gravity", self.gravity)
        if self.at_rest:
            self._check_statics()
        if self.contact is not None and self.numerics.intervals < 3:
            raise ValueError(f"intervals must be >= 3 with contact, got {self.numerics.intervals}")
        for load in self.points:
            if not 0 <= load.s <= self.rod.length:
                raise ValueError(f"s of a point load must be in [0, {self.rod.length}] m, got {load.s}")
            if not self.at_rest:
                check_frame(load, {0.0: self.start, self.rod.length: self.end}.get(load.s))

    def keeps(self, view: View) -> bool:
        """Whether all of the scene keeps the motion about an axis."""
        parts = [getattr(self, part.name) for part in fields(self) if part.name != "gravity"]
        return view.moved_by(self.gravity) and all(answer(part, view) for part in parts)

    def _check_statics(self) -> None:
        finest = self.numerics.intervals * (2 if self.numerics.verify else 1)
        if self.contact is not None and finest > MOST_AT_REST:
            rule = f"intervals must be <= {MOST_AT_REST} in a static analysis with contact, half of that with verify"
            raise ValueError(f"{rule}, got {self.numerics.intervals}")
        if any((*self.initial.velocity, *self.initial.angular_velocity)):
            raise ValueError("velocity and angular_velocity must be 0 in a static analysis")

    @property
    def damping_rate(self) -> float:
        """How fast (1/s) a motion across the rod is damped, in the mean along it: c, and by a viscous fluid."""
        if self.fluid is None or self.fluid.viscosity == 0.0:
            return self.damping
        length = float(self.rod.length)
        s = np.linspace(0.0, length, 101)
        drag = self.fluid.creeping_drag(self.rod.diameter(s) + 0.0 * s, length)[:, 0]
        return self.damping + float(drag.mean() / np.mean(self.rod.mass(s)))

    @property
    def at_rest(self) -> bool:
        """Whether it asks for equilibria, not for motion."""
        return self.analysis == "static"

    @property
    def outputs(self) -> list[float]:
        """The times (s) of the frames, but for that of t = 0."""
        count = round(self.t_end / self.output_interval)
        times = [min(k * self.output_interval, self.t_end) for k in range(1, count + 1)]
        if times[-1] < self.t_end * (1 - 1e-12):
            times.append(self.t_end)
        return times


def check_frame(load: PointLoad, end: End | None) -> None:
    """A force that follows the rod cannot be added to a condition on the components of f along lab axes."""
    if end is None or (load.frame, end.frame) != ("material", "lab"):
        return
    loaded = any(condition.kind == "load" for component in end.translation for condition in component)
    if loaded and not all(curve.is_zero for curve in load.force):
        raise ValueError('frame of a force at an end that is free along lab axes must be "lab", got "material"')
