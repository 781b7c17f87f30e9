"""The rod at t = 0: centreline, frames and curvature at the nodes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from solver.arrays import Array
from solver.kernels.kernel import kernel
from solver.kernels.rotation import quaternion_of
from solver.scene.initial import Initial

if TYPE_CHECKING:
    from scipy.interpolate import CubicSpline

ALONG = 1e-6
"""Sine of the angle below which a direction counts as along the rod."""
SAMPLES = 2048
"""Intervals in which a shape is looked at, at the least: the curvature of a helix of 15 turns is right to 1e-7 then,
but to 1e-3 at the very ends, where a spline is right to a lower order."""


def sampled(intervals: int) -> int:
    """In how many intervals a shape is looked at for a mesh of `intervals`: in as many for one that is twice as fine,
    so that a rod which is free of stress on one of them is on the other too."""
    while intervals < SAMPLES:
        intervals *= 2
    return intervals


def nodes_at_rest(initial: Initial, s: Array) -> tuple[Array, Array, Array]:
    """Positions (n, 3), orientations (n, 4) and curvature-twist (n, 3) at the nodes `s` (n,) at t = 0.

    The frame follows the centreline by parallel transport, turned by `twist`; see `sampled`.
    """
    straight = initial.direction is not None and not np.any(initial.twist(s))
    every = 1 if straight else sampled(len(s) - 1) // (len(s) - 1)
    refined = np.linspace(s[0], s[-1], every * (len(s) - 1) + 1)
    path = initial.centreline(refined)
    tangent, bend = _derivatives(initial, refined, path)
    first = _transport(tangent, _first_axis(initial, tangent[0]))
    R = np.stack([first, np.cross(tangent, first), tangent], axis=2)
    angle = np.asarray(initial.twist(refined), dtype=float)
    if angle.any():
        R = R @ _about_third_axis(angle)
    kappa = np.einsum("nij,ni->nj", R, np.cross(tangent, bend))
    kappa[:, 2] = _spline(refined, angle)(refined, 1) if angle.any() else 0.0
    return path[::every].copy(), quaternion_of(R[::every]), kappa[::every].copy()


def _derivatives(initial: Initial, s: Array, path: Array) -> tuple[Array, Array]:
    """The unit tangents (n, 3) of a centreline at `s` (n,), and their derivatives by s.

    At its knots the first derivative of a cubic spline is right to order 4, the second to order 2.
    """
    if initial.direction is not None:
        return np.tile(initial.direction, (len(s), 1)), np.zeros((len(s), 3))
    tangent = np.asarray(_spline(s, path)(s, 1))
    tangent /= np.linalg.norm(tangent, axis=1)[:, None]
    return tangent, np.asarray(_spline(s, tangent)(s, 1))


def _spline(s: Array, values: Array) -> CubicSpline:
    """Through values at `s`; loaded here, because scipy.interpolate takes a fifth of a second to load."""
    from scipy.interpolate import CubicSpline

    return CubicSpline(s, values)


def _about_third_axis(angle: Array) -> Array:
    """Rotations (n, 3, 3) by `angle` (n,), rad, about a3."""
    R = np.zeros((len(angle), 3, 3))
    R[:, 0, 0] = R[:, 1, 1] = np.cos(angle)
    R[:, 1, 0] = np.sin(angle)
    R[:, 0, 1] = -R[:, 1, 0]
    R[:, 2, 2] = 1.0
    return R


def _first_axis(initial: Initial, tangent: Array) -> Array:
    """The lab direction of a1 at s = 0, not yet normal to the tangent there."""
    if initial.a1 is not None:
        return np.array(initial.a1, dtype=float)
    e1, e2, _ = np.eye(3)
    return e2 if np.linalg.norm(np.cross(e1, tangent)) < ALONG else e1


def _transport(tangent: Array, first: Array) -> Array:
    """Parallel transport of `first`, made normal to tangent[0], along unit tangents (n, 3)."""
    normal = first - np.dot(first, tangent[0]) * tangent[0]
    if np.linalg.norm(normal) < ALONG * np.linalg.norm(first):
        raise ValueError(f"a1 must not be parallel to the tangent at s = 0, got {first.tolist()}")
    carried = np.empty_like(tangent)
    carried[0] = normal / np.linalg.norm(normal)
    _carry(tangent, carried)
    return carried


@kernel
def _carry(tangent: Array, carried: Array) -> None:
    """Turn carried[0] with the shortest rotations from each tangent to the next: x - (x . b) (a + b) / (1 + a . b)."""
    for i in range(1, len(tangent)):
        a, b, x = tangent[i - 1], tangent[i], carried[i - 1]
        along = x[0] * b[0] + x[1] * b[1] + x[2] * b[2]
        share = along / (1.0 + a[0] * b[0] + a[1] * b[1] + a[2] * b[2])
        square = 0.0
        for k in range(3):
            carried[i, k] = x[k] - share * (a[k] + b[k])
            square += carried[i, k] ** 2
        for k in range(3):
            carried[i, k] /= np.sqrt(square)
