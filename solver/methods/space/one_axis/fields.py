"""What lies at the nodes of a chain that turns about one axis, in space."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from solver.arrays import Array
from solver.kernels.handed import Reference
from solver.kernels.kernel import inlined, inner, kernel
from solver.kernels.rotation import multiply
from solver.methods.space.one_axis.axis import Axis, Plane
from solver.methods.space.one_axis.chain import State
from solver.methods.space.one_axis.motion import joint_moment


class InSpace(NamedTuple):
    """How plane and axis lie in space: z of the directions of `lab` and of `material` (3,), see `Axis`; the `origin`
    (3,) of the plane; the `axis` (3,), material; and quaternions (4,) of the orientations at phi = 0, `begin`, and at
    phi = pi, `half`."""

    lab: Plane
    material: Plane
    origin: Array
    axis: Array
    begin: Array
    half: Array

    @classmethod
    def of(cls, axis: Axis, origin: Array) -> InSpace:
        """For an axis, where the plane's z = 0 is."""
        own, half_turn, half = np.eye(3)[axis.index], np.zeros(4), np.zeros(4)
        half_turn[1:] = own
        multiply(axis.quaternion, half_turn, half)
        return cls(axis.lab, axis.material, origin, own, axis.quaternion, half)


class Shown(NamedTuple):
    """v, omega, f, kappa, q and r (N + 1, 3) of the nodes, and their `orientation` (N + 1, 4): see `Fields`."""

    v: Array
    omega: Array
    f: Array
    kappa: Array
    q: Array
    r: Array
    orientation: Array

    @classmethod
    def empty(cls, nodes: int) -> Shown:
        """Zeros for so many nodes."""
        v, omega, f, kappa, q, r = np.zeros((6, nodes, 3))
        return cls(v, omega, f, kappa, q, r, np.zeros((nodes, 4)))


@inlined
def _at_node(x: Array, i: int) -> float:
    """At node i what (N + 2,) belongs to orientations: their mean, and that of the end at an end."""
    if i == 0:
        return float(x[0])
    return float(x[i + 1] if i == len(x) - 2 else 0.5 * (x[i] + x[i + 1]))


@kernel
def place_nodes(reference: Reference, state: State, centres: Plane, r: Plane, V: Plane) -> None:
    """Write places and velocities (N + 1,) of the nodes, from those of the segments' `centres` (3, N)."""
    chain = reference.chain
    r[0], V[0] = state.base[0], state.base[1]
    for j in range(len(chain.mass)):
        phi, swing = chain.swing * state.phi[j + 1], chain.swing * state.omega[j + 1]
        arm = 0.5 * chain.h * complex(np.cos(phi), np.sin(phi))
        r[j + 1], V[j + 1] = centres[0, j] + arm, centres[1, j] + complex(-swing * arm.imag, swing * arm.real)


@inner
def _set_out(z: complex, directions: Plane, i: int, out: Array) -> None:
    """Write the vector (3,) of node i whose components along directions of the plane are those of z."""
    for k in range(3):
        out[i, k] = z.real * directions[k].real + z.imag * directions[k].imag


@kernel
def show(reference: Reference, state: State, r: Plane, V: Plane, offset: Array, space: InSpace, shown: Shown) -> None:
    """Write what the nodes, whose places and velocities are known, show. `offset` (N + 1,): by what the curvature
    differs from the centreline's."""
    chain = reference.chain
    for i in range(len(r)):
        phi, omega, q = _at_node(state.phi, i), _at_node(state.omega, i), joint_moment(chain, state.phi, state.omega, i)
        swing, half = chain.swing * phi, 0.5 * phi
        back, cosine, sine = complex(np.cos(swing), -np.sin(swing)), np.cos(half), np.sin(half)
        kappa = (state.phi[i + 1] - state.phi[i]) / chain.span[i] - offset[i]
        _set_out(V[i] * back, space.material, i, shown.v)
        _set_out(state.F[i] * back, space.material, i, shown.f)
        _set_out(r[i], space.lab, i, shown.r)
        for k in range(3):
            shown.r[i, k] += space.origin[k]
            shown.omega[i, k], shown.kappa[i, k] = omega * space.axis[k], kappa * space.axis[k]
            shown.q[i, k] = q * space.axis[k]
        for k in range(4):
            shown.orientation[i, k] = cosine * space.begin[k] + sine * space.half[k]
