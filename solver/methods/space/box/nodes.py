"""The physics at a node: frames, inertia, moments and loads at the current iterate, with their tangents.

What not every scene has is added in loops of its own: within the others it slows down scenes without it, too. How a
load's tangents become derivatives by the unknowns V and omega is said in `_take_tangents`, and nowhere else.
"""

from __future__ import annotations

from typing import Any, NamedTuple, no_type_check

from solver.arrays import Array
from solver.kernels.dispatch import variant
from solver.kernels.handed import Reference
from solver.kernels.kernel import inner, kernel
from solver.kernels.lanes import abreast
from solver.kernels.rotation import cosine_and_sinc, dot, entries, jacobian_series, product, right_jacobian, unit
from solver.kernels.vectors import add_matrix, add_vector, matrix, subtract_product, tangent_by_rotation, vector
from solver.methods.space.box.fields import KAPPA, OMEGA, Nodes, State, V
from solver.physics.elasticity import moment, tangent
from solver.physics.loads.load import Point, Tangents, add_forces, add_tangents, point, take_force, take_tangents
from solver.physics.loads.registry import Loads
from solver.physics.section import Section


@abreast("past: 6, Y: 6, start: 4 -> r: 3, quaternion: 4, R: 3x3, J: 3x3")
@no_type_check
def _place(past, Y, start, c0, rate):
    """Position and orientation of a node, its R and J; `rate`: 1 / c0."""
    moved = past + Y / c0
    theta = moved[3], moved[4], moved[5]
    square = dot(*theta, *theta)
    cosine, sinc = cosine_and_sinc(square)
    first, second = jacobian_series(square)
    turned = product(*start, cosine, *(sinc * theta))
    turned = unit(*turned)
    J = right_jacobian(*theta, first, second)
    return (moved[0], moved[1], moved[2]), turned, entries(*turned), rate * J


@kernel
def place_nodes(old: State, new: State, past: Array, c0: float, nodes: Nodes) -> None:
    """Write positions and orientations of `new` and the nodes' R and J."""
    _place(past, new.Y, old.quaternion, c0, 1.0 / c0, new.r, new.quaternion, nodes.R, nodes.J)


@inner
def balance_rotation(new: State, section: Section, past: Array, c0: float, nodes: Nodes) -> None:
    """Write q and W = I omega_t + omega x I omega, but for loads, with their tangents by kappa and by omega."""
    for j in range(len(past)):
        W, D = nodes.W[j], nodes.W_w[j]
        I0, I1, I2 = section.inertia[j, 0], section.inertia[j, 1], section.inertia[j, 2]
        w0, w1, w2 = new.Y[j, OMEGA], new.Y[j, OMEGA + 1], new.Y[j, OMEGA + 2]
        for i in range(3):
            W[i] = section.inertia[j, i] * (c0 * new.Y[j, OMEGA + i] + past[j, 9 + i])
            D[i, i] = section.inertia[j, i] * c0
        kappa = new.Y[j, KAPPA], new.Y[j, KAPPA + 1], new.Y[j, KAPPA + 2]
        nodes.q[j, 0], nodes.q[j, 1], nodes.q[j, 2] = moment(section.elastic, j, kappa)
        K = tangent(section.elastic, j, kappa)
        for k in range(3):
            nodes.K[j, 0, k], nodes.K[j, 1, k], nodes.K[j, 2, k] = K[0][k], K[1][k], K[2][k]
        W[0] += (I2 - I1) * w1 * w2
        W[1] += (I0 - I2) * w2 * w0
        W[2] += (I1 - I0) * w0 * w1
        D[0, 1], D[0, 2] = (I2 - I1) * w2, (I2 - I1) * w1
        D[1, 0], D[1, 2] = (I0 - I2) * w2, (I0 - I2) * w0
        D[2, 0], D[2, 1] = (I1 - I0) * w1, (I1 - I0) * w0


@kernel
def moments(reference: Reference, Y: Array, q: Array) -> None:
    """Write the moments q (n, 3) of unknowns Y (n, 12)."""
    elastic = reference.section.elastic
    for j in range(len(q)):
        q[j, 0], q[j, 1], q[j, 2] = moment(elastic, j, (Y[j, KAPPA], Y[j, KAPPA + 1], Y[j, KAPPA + 2]))


@inner
def balance_translation(new: State, section: Section, past: Array, c0: float, nodes: Nodes) -> None:
    """Write P = rho_c A dV/dt with its tangents by V and omega, but for loads."""
    for j in range(len(past)):
        mass = section.mass[j]
        P, P_V, P_w = nodes.P[j], nodes.P_V[j], nodes.P_w[j]
        for i in range(3):
            P[i] = mass * (c0 * new.Y[j, V + i] + past[j, 6 + i])
            for k in range(3):
                P_V[i, k] = 0.0
                P_w[i, k] = 0.0
            P_V[i, i] = mass * c0


@inner
def load_nodes(new: State, loads: Loads, past: Array, c0: float, nodes: Nodes) -> None:
    """Let the loads act on P and W, with their tangents."""
    motion = Motion(new.r, new.Y, past, nodes.R, c0)
    add_forces(loads, 0, motion, nodes)
    add_tangents(loads, 0, motion, Unknowns(nodes.P_V, nodes.P_w, nodes.W_w, nodes.J, c0))


class Motion(NamedTuple):
    """How the nodes move at an iterate: places (n, 3), unknowns `Y` (n, 12), `past` and c0 of their rates, R."""

    r: Array
    Y: Array
    past: Array
    R: Array
    c0: float


class Unknowns(NamedTuple):
    """The tangents of P by V and omega, and of W by omega; J = d psi / d omega; c0 = d(dV/dt) / dV = dV / dr."""

    P_V: Array
    P_w: Array
    W_w: Array
    J: Array
    c0: float


@variant(point, Motion)
@inner
def _point(motion: Motion, j: int) -> Point:
    Y, past, c0, R = motion.Y, motion.past, motion.c0, matrix(motion.R, j)
    velocity = (Y[j, V], Y[j, V + 1], Y[j, V + 2])
    acceleration = (c0 * Y[j, V] + past[j, 6], c0 * Y[j, V + 1] + past[j, 7], c0 * Y[j, V + 2] + past[j, 8])
    omega = (Y[j, OMEGA], Y[j, OMEGA + 1], Y[j, OMEGA + 2])
    return Point(vector(motion.r, j), velocity, acceleration, (R[0][2], R[1][2], R[2][2]), R, omega)


@variant(take_force, Nodes)
@inner
def _take_force(nodes: Nodes, j: int, at: Point, lab: Any, material: Any) -> None:
    add_vector(-1.0, lab, nodes.P[j])
    add_vector(-1.0, material, nodes.W[j])


@variant(take_tangents, Unknowns)
@inner
def _take_tangents(unknowns: Unknowns, j: int, at: Point, tangents: Tangents) -> None:
    """P_V = M c0 + C + K / c0 and P_w = E J, each with the sign of a load."""
    add_matrix(-unknowns.c0, tangents.M, unknowns.P_V[j])
    add_matrix(-1.0, tangents.C, unknowns.P_V[j])
    add_matrix(-1.0 / unknowns.c0, tangents.K, unknowns.P_V[j])
    subtract_product(tangents.E, unknowns.J[j], unknowns.P_w[j])
    subtract_product(tangent_by_rotation(tangents.by_T, at.R), unknowns.J[j], unknowns.P_w[j])
    subtract_product(tangents.moment_E, unknowns.J[j], unknowns.W_w[j])
    add_matrix(-1.0, tangents.moment_omega, unknowns.W_w[j])
