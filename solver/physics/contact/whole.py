"""How a rod moves as a whole, which brings no two parts of it nearer to each other.

What a contact search has looked at holds until some point has gone too far, and steps are short where one is fast. A
coil that falls, or a spiral that turns about its pin, goes far and fast as one body: so what counts is how far a point
is from where it would be, had the rod only moved as that body does. Any rigid motion is right for that; the nearest in
the least squares leaves the least. (By loops, not by a library: a run is the same to the bit on every CPU.)
"""

from __future__ import annotations

import numpy as np

from solver.arrays import Array
from solver.kernels.copying import copy
from solver.kernels.kernel import inner, kernel
from solver.kernels.scratch import scratch

ROUNDS = 4
"""Rotations that are fitted one after the other: each leaves about the third power of the angle that was left."""
ROUNDING = 1e-9
"""Part of the largest moment of inertia that a straight rod is taken to have about itself."""


@inner
def _fit(places: Array, velocity: Array, known: Array, body: Array) -> None:
    """Write centre, velocity of the centre and angular velocity of the rigid body (3, 3) that is nearest to the
    `velocity` (n, >= 3), less what is `known` of it (n, 3), at `places` (n, 3)."""
    n, second, spin = len(places), scratch((3, 3)), scratch(3)
    body[:] = 0.0
    for i in range(n):
        for k in range(3):
            body[0, k] += places[i, k] / n
            body[1, k] += (velocity[i, k] - known[i, k]) / n
    for i in range(n):
        x, y, z = places[i, 0] - body[0, 0], places[i, 1] - body[0, 1], places[i, 2] - body[0, 2]
        u, v, w = velocity[i, 0] - known[i, 0], velocity[i, 1] - known[i, 1], velocity[i, 2] - known[i, 2]
        spin[0] += y * w - z * v
        spin[1] += z * u - x * w
        spin[2] += x * v - y * u
        second[0, 0], second[1, 1], second[2, 2] = second[0, 0] + x * x, second[1, 1] + y * y, second[2, 2] + z * z
        second[0, 1], second[0, 2], second[1, 2] = second[0, 1] + x * y, second[0, 2] + x * z, second[1, 2] + y * z
    whole = (second[0, 0] + second[1, 1] + second[2, 2]) * (1.0 + ROUNDING)
    a, b, c = whole - second[0, 0], whole - second[1, 1], whole - second[2, 2]
    d, e, f = -second[0, 1], -second[0, 2], -second[1, 2]
    A, B, C, D, E, F = b * c - f * f, a * c - e * e, a * b - d * d, e * f - d * c, d * f - e * b, d * e - a * f
    determinant = a * A + d * D + e * E
    if determinant > 0.0:
        body[2, 0] = (A * spin[0] + D * spin[1] + E * spin[2]) / determinant
        body[2, 1] = (D * spin[0] + B * spin[1] + F * spin[2]) / determinant
        body[2, 2] = (E * spin[0] + F * spin[1] + C * spin[2]) / determinant


@inner
def _velocities(body: Array, places: Array, moved: Array) -> None:
    """Write those of the body at `places` (n, 3)."""
    for i in range(len(places)):
        x, y, z = places[i, 0] - body[0, 0], places[i, 1] - body[0, 1], places[i, 2] - body[0, 2]
        moved[i, 0] = body[1, 0] + body[2, 1] * z - body[2, 2] * y
        moved[i, 1] = body[1, 1] + body[2, 2] * x - body[2, 0] * z
        moved[i, 2] = body[1, 2] + body[2, 0] * y - body[2, 1] * x


@inner
def _move(body: Array, moved: Array) -> None:
    """Move places (n, 3) by the body's velocity, and turn them about its centre by its angular velocity."""
    angle = np.sqrt(body[2, 0] ** 2 + body[2, 1] ** 2 + body[2, 2] ** 2)
    sine, versine = (np.sin(angle) / angle, (1.0 - np.cos(angle)) / angle**2) if angle > 0.0 else (1.0, 0.5)
    for i in range(len(moved)):
        x, y, z = moved[i, 0] - body[0, 0], moved[i, 1] - body[0, 1], moved[i, 2] - body[0, 2]
        u, v, w = body[2, 1] * z - body[2, 2] * y, body[2, 2] * x - body[2, 0] * z, body[2, 0] * y - body[2, 1] * x
        moved[i, 0] += body[1, 0] + sine * u + versine * (body[2, 1] * w - body[2, 2] * v)
        moved[i, 1] += body[1, 1] + sine * v + versine * (body[2, 2] * u - body[2, 0] * w)
        moved[i, 2] += body[1, 2] + sine * w + versine * (body[2, 0] * v - body[2, 1] * u)


@kernel
def velocity_as_a_whole(r: Array, velocity: Array, nodes: Array, p: Array, points: Array) -> None:
    """Write the velocities at nodes r (n, 3) and points p (M, 3) of the rigid body that is nearest to the nodes'
    `velocity` (n, >= 3) into `nodes` and `points`."""
    body = scratch((3, 3))
    nodes[:] = 0.0
    _fit(r, velocity, nodes, body)
    _velocities(body, r, nodes)
    _velocities(body, p, points)


@kernel
def carry_as_a_whole(before: Array, r: Array, nodes: Array, p: Array, points: Array) -> None:
    """Write where nodes that lay at `before` (n, 3), and points at p (M, 3), would be if the rod had only moved as a
    rigid body, one that brings its nodes nearest to r (n, 3), into `nodes` and `points`."""
    body = scratch((3, 3))
    copy(before, nodes)
    copy(p, points)
    for _ in range(ROUNDS):
        _fit(nodes, r, nodes, body)
        _move(body, nodes)
        _move(body, points)
