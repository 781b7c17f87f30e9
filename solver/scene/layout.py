"""The rod at t = 0: centreline, frames and curvature at the nodes."""

from __future__ import annotations

import numpy as np

from solver.arrays import Array
from solver.kernels.kernel import kernel
from solver.kernels.rotation import quaternion_of
from solver.kernels.vectors import vector_product
from solver.scene.curve import Curve, Vector
from solver.scene.initial import Initial

ALONG = 1e-6
"""Sine of the angle below which a direction counts as along the rod."""
SAMPLES = 1024
"""Intervals in which a shape is looked at, at the least: the curvature of a helix of 15 turns is right to 1e-8 then,
and to 1e-6 at its ends."""
SLOPES = np.array([[-147.0, 360.0, -450.0, 400.0, -225.0, 72.0, -10.0],
                   [-10.0, -77.0, 150.0, -100.0, 50.0, -15.0, 2.0],
                   [2.0, -24.0, -35.0, 80.0, -30.0, 8.0, -1.0],
                   [-1.0, 9.0, -45.0, 0.0, 45.0, -9.0, 1.0]]) / 60.0  # fmt: skip
"""Row i: the weights of seven values one apart by which the derivative at the i-th of them is right to order 6."""
REACH = 3
"""On how many neighbours to each side a derivative rests."""


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
    h = float(refined[1] - refined[0])
    tangent, bend = _derivatives(initial, h, path)
    first = _transport(tangent, _first_axis(initial, tangent[0]))[::every]
    tangent, bend = tangent[::every], bend[::every]
    R = np.stack([first, across(tangent, first), tangent], axis=2)
    angle = np.asarray(initial.twist(refined), dtype=float)
    if angle.any():
        R = R @ _about_third_axis(angle[::every])
    kappa = np.einsum("nij,ni->nj", R, across(tangent, bend))
    kappa[:, 2] = derivative(h, angle)[::every] if angle.any() else 0.0
    return path[::every].copy(), quaternion_of(R), kappa


def curvature_of(initial: Initial, length: float, intervals: int) -> Vector:
    """Curvature and twist of a shape along the rod, as a mesh of `intervals` sees it."""
    s = np.linspace(0.0, length, sampled(intervals) + 1)
    bend1, bend2, twist = (Curve.table(s, column, "cubic") for column in nodes_at_rest(initial, s)[2].T)
    return bend1, bend2, twist


def across(a: Array, b: Array) -> Array:
    """a x b of vectors (n, 3): `np.cross` takes far longer for few."""
    return np.stack(vector_product.py_func(a.T, b.T), axis=1)  # type: ignore[attr-defined]


def _derivatives(initial: Initial, h: float, path: Array) -> tuple[Array, Array]:
    """The unit tangents (n, 3) of a centreline through places `h` apart, and their derivatives by s."""
    if initial.direction is not None:
        return np.tile(initial.direction, (len(path), 1)), np.zeros((len(path), 3))
    tangent = derivative(h, path)
    tangent /= np.sqrt(np.einsum("ni,ni->n", tangent, tangent))[:, None]
    return tangent, derivative(h, tangent)


def derivative(h: float, values: Array) -> Array:
    """By s, of values (n >= 7, ...) that are `h` apart: `SLOPES` in the middle, at an end and on its neighbours."""
    count, slope = SLOPES.shape[1], np.empty_like(values)
    slope[:REACH] = np.tensordot(SLOPES[:REACH], values[:count], 1)
    slope[-REACH:] = np.tensordot(-SLOPES[REACH - 1 :: -1, ::-1], values[-count:], 1)
    inner = slope[REACH:-REACH]
    inner[:] = 0.0
    for away, weight in enumerate(SLOPES[REACH, REACH + 1 :], start=1):
        inner += weight * (values[REACH + away : len(values) - REACH + away] - values[REACH - away : -REACH - away])
    return np.asarray(slope / h)


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
