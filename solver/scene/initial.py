"""The rod at t = 0, as a scene gives it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from solver.arrays import Array
from solver.kernels.rotation import rotate
from solver.scene.checks import require_finite, unit_vector
from solver.scene.curve import Curve
from solver.scene.rod import Profile
from solver.scene.view import NONE, View

CLOSED, SMOOTH = 1e-9, 0.99
"""How near, in its lengths, a curve's ends are that is closed; and the least cosine of the angle between their tangents
for it to go on smoothly."""


@dataclass(frozen=True)
class Initial:
    """The rod at t = 0.

    `centreline` maps arclengths s (n,) to lab positions (n, 3) in m with |r_s| = 1; `a1` is the lab
    direction (made normal to the tangent) of the first principal axis at s = 0, where none is given
    e1, or e2 where the rod begins along e1; along s the frame
    follows by parallel transport, turned about the tangent by `twist` (rad). `velocity` (m/s) and
    `angular_velocity` (rad/s, about the centre of mass) are a rigid motion in the lab frame.
    `direction` is the unit tangent of a rod that is straight, None of any other.
    """

    centreline: Callable[[Array], Array]
    a1: tuple[float, float, float] | None = None
    twist: Profile = field(default_factory=lambda: Curve.constant(0.0))
    velocity: tuple[float, float, float] = (0.0, 0.0, 0.0)
    angular_velocity: tuple[float, float, float] = (0.0, 0.0, 0.0)
    direction: tuple[float, float, float] | None = None

    def __post_init__(self) -> None:
        for name in ("a1", "velocity", "angular_velocity"):
            if getattr(self, name) is not None:
                require_finite(f"initial {name}", getattr(self, name))

    def keeps(self, view: View) -> bool:
        """Whether the rod lies, and is thrown, along the motion about an axis."""
        still = rotate(view.quaternion, np.tile(np.eye(3)[view.index], (len(view.s), 1)))
        bends = np.abs(view.kappa[:, ~view.turns]).max() * view.s[2]
        if np.abs(still - still[0]).max() > NONE or bends > NONE:
            return False
        return view.moved_by(self.velocity) and view.turned_by(self.angular_velocity)

    @classmethod
    def straight(
        cls,
        origin: tuple[float, float, float] = (0.0, 0.0, 0.0),
        direction: tuple[float, float, float] = (0.0, 0.0, 1.0),
        **others: object,
    ) -> Initial:
        """A straight rod from `origin` along `direction` (of any length > 0)."""
        start, along = np.array(origin, dtype=float), unit_vector("direction", direction)
        unit = (float(along[0]), float(along[1]), float(along[2]))
        return cls(centreline=lambda s: start + np.outer(s, along), direction=unit, **others)  # type: ignore[arg-type]

    @classmethod
    def through(cls, points: Array, length: float, **others: object) -> Initial:
        """A smooth centreline through lab points (n >= 4, 3), re-parametrised by arclength.

        Raises ValueError if its length differs from `length` by more than 0.1 %; a smaller
        difference is taken up by scaling about the first point.
        """
        return cls(centreline=arclength_spline(points, length), **others)  # type: ignore[arg-type]


def arclength_spline(points: Array, length: float) -> Callable[[Array], Array]:
    """The C2 curve through `points` (n >= 4, 3) as a function of arclength in [0, length]. One that ends where it
    begins, in the same direction, goes on there as within: a ring by its points is one.

    Raises ValueError if the curve's own length differs from `length` by more than 0.1 %.
    """
    from scipy.interpolate import CubicSpline

    path = np.asarray(points, dtype=float)
    if path.ndim != 2 or path.shape[0] < 4 or path.shape[1] != 3 or not np.isfinite(path).all():
        raise ValueError(f"a centreline needs at least 4 finite points of 3 coordinates, got shape {path.shape}")
    parameter = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(path, axis=0), axis=1))])
    if not (np.diff(parameter) > 0).all():
        raise ValueError("successive points of a centreline must differ")
    raw = CubicSpline(parameter, path)
    if np.linalg.norm(path[-1] - path[0]) <= CLOSED * parameter[-1]:
        begin, end = (tangent / np.linalg.norm(tangent) for tangent in raw(parameter[[0, -1]], 1))
        if begin @ end > SMOOTH:
            raw = CubicSpline(parameter, np.vstack([path[:-1], path[:1]]), bc_type="periodic")
    fine = np.linspace(0.0, parameter[-1], 40 * len(path) + 1)
    speed = np.linalg.norm(raw(fine, 1), axis=1)
    arclength = CubicSpline(fine, speed).antiderivative()(fine)
    if abs(arclength[-1] / length - 1.0) > 1e-3:
        raise ValueError(
            f"the centreline is {arclength[-1]:.6g} m long, the rod {length:.6g} m: they must agree to 0.1 %"
        )
    by_arclength = CubicSpline(arclength * (length / arclength[-1]), fine)

    def centreline(s: Array) -> Array:
        return np.asarray(path[0] + (raw(by_arclength(s)) - path[0]) * (length / arclength[-1]), dtype=float)

    return centreline
