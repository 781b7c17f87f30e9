"""The arrays of the chain that turns about one axis: as in `segments.chain`, with an angle for a rotation and a
complex number for a vector of the plane (see `Axis`)."""

from __future__ import annotations

from math import atan2
from typing import NamedTuple

import numpy as np

from solver.arrays import Array
from solver.methods.space.one_axis.axis import Axis, Plane
from solver.methods.space.segments import chain as space
from solver.methods.space.segments.chain import STAGES
from solver.physics.elasticity import Elasticity, about


class Chain(NamedTuple):
    """What does not change in a run: of `segments.chain.Chain` what belongs to the axis, and its `swing`.

    Segments (N,): `mass`, `inertia`, `dry_inertia`; joints (N + 1,): `span`, `elastic`.
    """

    h: float
    swing: float
    mass: Array
    inertia: Array
    dry_inertia: Array
    span: Array
    elastic: Elasticity


class State(NamedTuple):
    """The rod at one time: `phi`, `omega` and its rate `alpha` (N + 2,); `base` (3,): position, velocity and
    acceleration of the start; `F` (N + 1,): forces at the nodes."""

    phi: Array
    omega: Array
    alpha: Array
    base: Plane
    F: Plane

    @classmethod
    def empty(cls, intervals: int) -> State:
        """Zeros for N = `intervals`."""
        n = intervals + 2
        return cls(np.zeros(n), np.zeros(n), np.zeros(n), np.zeros(3, complex), np.zeros(n - 1, complex))


class Stages(NamedTuple):
    """The three stages of a step, stage first.

    Unknown: `theta` (3, N + 2), by how much the rotation departs from a steady one; `shift` (3,), displacement of the
    start; `F` (3, N + 1). From these: `theta_t`, `alpha`, `phi`, `omega` and the tangents `T` of the orientations; `r`,
    `V`, `A` (3, N) of the segments' centres; `base` (3, 3) of the start; the moments `q` (3, N + 1).
    """

    theta: Array
    shift: Plane
    F: Plane
    theta_t: Array
    alpha: Array
    phi: Array
    omega: Array
    T: Plane
    r: Plane
    V: Plane
    A: Plane
    base: Plane
    q: Array

    @classmethod
    def empty(cls, intervals: int) -> Stages:
        """Zeros for N = `intervals`."""
        N = intervals
        theta, theta_t, alpha, phi, omega = (np.zeros((STAGES, N + 2)) for _ in range(5))
        r, V, A = (np.zeros((STAGES, N), complex) for _ in range(3))
        F, T = np.zeros((STAGES, N + 1), complex), np.zeros((STAGES, N + 2), complex)
        shift, base = np.zeros(STAGES, complex), np.zeros((STAGES, 3), complex)
        return cls(theta, shift, F, theta_t, alpha, phi, omega, T, r, V, A, base, np.zeros((STAGES, N + 1)))


class Residuals(NamedTuple):
    """What is left of the equations at each stage, vectors as pairs: `rotation` (3, N + 2), `translation` (3, N, 2),
    `ends` (3, 2, 2)."""

    rotation: Array
    translation: Array
    ends: Array

    @classmethod
    def empty(cls, intervals: int) -> Residuals:
        """Zeros for N = `intervals`."""
        return cls(np.zeros((STAGES, intervals + 2)), np.zeros((STAGES, intervals, 2)), np.zeros((STAGES, 2, 2)))


def about_axis(axis: Axis, chain: space.Chain, state: space.State) -> tuple[Chain, State]:
    """What chain and state in space are about the axis."""
    p, reduced = axis.index, State.empty(len(chain.mass))
    a, v, b, u = axis.quaternion[0], axis.quaternion[1:], state.quaternion[:, 0], state.quaternion[:, 1:]
    turned = a * u - np.outer(b, v) - np.cross(v, u)
    halves = map(atan2, turned[:, p], a * b + u @ v)
    reduced.phi[:] = np.unwrap([2.0 * half for half in halves])
    reduced.omega[:] = state.omega[:, p]
    reduced.base[:] = state.base @ axis.lab
    inertia, dry_inertia = (np.ascontiguousarray(a[:, p]) for a in (chain.inertia, chain.dry_inertia))
    return Chain(chain.h, axis.swing, chain.mass, inertia, dry_inertia, chain.span, about(chain.elastic, p)), reduced
