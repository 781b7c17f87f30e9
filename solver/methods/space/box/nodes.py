"""The physics at a node: frames, inertia, moments and loads at the current iterate, with their tangents.

What not every scene has is added in loops of its own: within the others it slows down scenes without it, too. How a
load's tangents become derivatives by the unknowns V and omega is said in `_take_tangents`, and nowhere else.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from solver.arrays import Array
from solver.kernels.forms import forms_of
from solver.kernels.kernel import inner, kernel
from solver.kernels.lanes import LANES, gather, scatter
from solver.kernels.rotation import (
    any_jacobian,
    cosines_and_sincs,
    entries,
    jacobian_series,
    product,
    right_jacobian,
    unit,
)
from solver.kernels.scratch import scratch
from solver.kernels.vectors import add_matrix, add_product, add_vector, matrix, tangent_by_rotation, vector
from solver.methods.space.box.fields import KAPPA, OMEGA, Nodes, State, V
from solver.physics.elasticity import moment
from solver.physics.loads.load import Point, Tangents, add_forces, add_tangents, point, take_force, take_tangents
from solver.physics.loads.registry import Loads
from solver.physics.section import Section


@kernel
def place_nodes(old: State, new: State, past: Array, c0: float, nodes: Nodes) -> None:
    """Write positions and orientations of `new` and the nodes' R and J.

    Eight abreast (see `lanes`), in rows from 0: r; 3: theta, cos, sinc, |theta|^2; 9: what J is of; 11: quaternion;
    15: R; 24: J.
    """
    n, scale, rows = len(past), 1.0 / c0, scratch((33, LANES))
    for first in range(0, n, LANES):
        gather(past, 6, first, rows, 0)
        gather(new.Y, 6, first, rows, 6)  # V and omega
        for m in range(LANES):
            for k in range(6):
                rows[k, m] += rows[6 + k, m] / c0
        cosines_and_sincs(rows, 3)
        for m in range(LANES):
            rows[9, m], rows[10, m] = jacobian_series(rows[8, m])
        for m in range(LANES):
            if rows[8, m] >= 1.0:
                rows[9, m], rows[10, m] = any_jacobian(rows[8, m])
        gather(old.quaternion, 4, first, rows, 11)
        for m in range(LANES):
            x, y, z, cosine, sinc = rows[3, m], rows[4, m], rows[5, m], rows[6, m], rows[7, m]
            a, b, c, d = product(rows[11, m], rows[12, m], rows[13, m], rows[14, m],
                                 cosine, sinc * x, sinc * y, sinc * z)  # fmt: skip
            a, b, c, d = unit(a, b, c, d)
            rows[11, m], rows[12, m], rows[13, m], rows[14, m] = a, b, c, d
            R00, R01, R02, R10, R11, R12, R20, R21, R22 = entries(a, b, c, d)
            J00, J01, J02, J10, J11, J12, J20, J21, J22 = right_jacobian(x, y, z, rows[9, m], rows[10, m])
            rows[15, m], rows[16, m], rows[17, m] = R00, R01, R02
            rows[18, m], rows[19, m], rows[20, m] = R10, R11, R12
            rows[21, m], rows[22, m], rows[23, m] = R20, R21, R22
            J00, J01, J02, J10, J11, J12 = scale * J00, scale * J01, scale * J02, scale * J10, scale * J11, scale * J12
            rows[24, m], rows[25, m], rows[26, m] = J00, J01, J02
            rows[27, m], rows[28, m], rows[29, m] = J10, J11, J12
            rows[30, m], rows[31, m], rows[32, m] = scale * J20, scale * J21, scale * J22
        scatter(rows, 0, 3, first, new.r)
        scatter(rows, 11, 4, first, new.quaternion)
        scatter(rows, 15, 9, first, nodes.R.reshape(n, 9))
        scatter(rows, 24, 9, first, nodes.J.reshape(n, 9))


@kernel
def balance_rotation(new: State, section: Section, past: Array, c0: float, nodes: Nodes) -> None:
    """Write q = K (kappa - kappa0) and W = I omega_t + omega x I omega with its tangent by omega, but for loads."""
    for j in range(len(past)):
        W, D = nodes.W[j], nodes.W_w[j]
        I0, I1, I2 = section.inertia[j, 0], section.inertia[j, 1], section.inertia[j, 2]
        w0, w1, w2 = new.Y[j, OMEGA], new.Y[j, OMEGA + 1], new.Y[j, OMEGA + 2]
        for i in range(3):
            W[i] = section.inertia[j, i] * (c0 * new.Y[j, OMEGA + i] + past[j, 9 + i])
            D[i, i] = section.inertia[j, i] * c0
        q = moment(section.elastic, j, (new.Y[j, KAPPA], new.Y[j, KAPPA + 1], new.Y[j, KAPPA + 2]))
        nodes.q[j, 0], nodes.q[j, 1], nodes.q[j, 2] = q
        W[0] += (I2 - I1) * w1 * w2
        W[1] += (I0 - I2) * w2 * w0
        W[2] += (I1 - I0) * w0 * w1
        D[0, 1], D[0, 2] = (I2 - I1) * w2, (I2 - I1) * w1
        D[1, 0], D[1, 2] = (I0 - I2) * w2, (I0 - I2) * w0
        D[2, 0], D[2, 1] = (I1 - I0) * w1, (I1 - I0) * w0


@kernel
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


@inner
def _point(motion: Motion, j: int) -> Point:
    Y, past, c0, R = motion.Y, motion.past, motion.c0, matrix(motion.R, j)
    velocity = (Y[j, V], Y[j, V + 1], Y[j, V + 2])
    acceleration = (c0 * Y[j, V] + past[j, 6], c0 * Y[j, V + 1] + past[j, 7], c0 * Y[j, V + 2] + past[j, 8])
    omega = (Y[j, OMEGA], Y[j, OMEGA + 1], Y[j, OMEGA + 2])
    return Point(vector(motion.r, j), velocity, acceleration, (R[0][2], R[1][2], R[2][2]), R, omega)


@inner
def _take_force(nodes: Nodes, j: int, at: Point, lab: Any, material: Any) -> None:
    add_vector(-1.0, lab, nodes.P[j])
    add_vector(-1.0, material, nodes.W[j])


@inner
def _take_tangents(unknowns: Unknowns, j: int, at: Point, tangents: Tangents) -> None:
    """P_V = M c0 + C + K / c0 and P_w = E J, each with the sign of a load."""
    add_matrix(-unknowns.c0, tangents.M, unknowns.P_V[j])
    add_matrix(-1.0, tangents.C, unknowns.P_V[j])
    add_matrix(-1.0 / unknowns.c0, tangents.K, unknowns.P_V[j])
    add_product(-1.0, tangents.E, unknowns.J[j], unknowns.P_w[j])
    add_product(-1.0, tangent_by_rotation(tangents.by_T, at.R), unknowns.J[j], unknowns.P_w[j])
    add_product(-1.0, tangents.moment_E, unknowns.J[j], unknowns.W_w[j])
    add_matrix(-1.0, tangents.moment_omega, unknowns.W_w[j])


forms_of(point)[Motion] = _point
forms_of(take_force)[Nodes] = _take_force
forms_of(take_tangents)[Unknowns] = _take_tangents
