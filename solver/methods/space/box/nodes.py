"""The physics at a node: frames, inertia, moments and loads at the current iterate, with their tangents.

What not every scene has is added in loops of its own: within the others it slows down scenes without it, too.
"""

from __future__ import annotations

from solver.arrays import Array
from solver.kernels.kernel import kernel
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
from solver.methods.space.box.fields import KAPPA, OMEGA, Nodes, State, V
from solver.physics.loads.applied import Loads
from solver.physics.loads.fluid import add_added_mass, add_drag
from solver.physics.section import Section


@kernel
def rotation_tangent(R: Array, x: Array, J: Array, out: Array) -> None:
    """Write d(R x)/d omega = -R [x] J into `out` (3, 3), for a material vector x held fixed."""
    for i in range(3):
        a = x[1] * R[i, 2] - x[2] * R[i, 1]
        b = x[2] * R[i, 0] - x[0] * R[i, 2]
        c = x[0] * R[i, 1] - x[1] * R[i, 0]
        for k in range(3):
            out[i, k] = a * J[0, k] + b * J[1, k] + c * J[2, k]


@kernel
def place_nodes(old: State, new: State, past: Array, c0: float, nodes: Nodes) -> None:
    """Write positions and orientations of `new` and the nodes' R, J, T with its tangent.

    Eight abreast (see `lanes`), in rows from 0: r; 3: theta, cos, sinc, |theta|^2; 9: what J is of; 11: quaternion;
    15: R; 24: J; 33: dT; and in the end T from 6.
    """
    n, scale, rows = len(past), 1.0 / c0, scratch((42, LANES))
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
            # T = R a3, T_w = R [J1, -J0, 0]
            rows[33, m], rows[34, m], rows[35, m] = R00 * J10 - R01 * J00, R00 * J11 - R01 * J01, R00 * J12 - R01 * J02
            rows[36, m], rows[37, m], rows[38, m] = R10 * J10 - R11 * J00, R10 * J11 - R11 * J01, R10 * J12 - R11 * J02
            rows[39, m], rows[40, m], rows[41, m] = R20 * J10 - R21 * J00, R20 * J11 - R21 * J01, R20 * J12 - R21 * J02
            rows[6, m], rows[7, m], rows[8, m] = R02, R12, R22
        scatter(rows, 0, 3, first, new.r)
        scatter(rows, 6, 3, first, nodes.T)
        scatter(rows, 11, 4, first, new.quaternion)
        scatter(rows, 15, 9, first, nodes.R.reshape(n, 9))
        scatter(rows, 24, 9, first, nodes.J.reshape(n, 9))
        scatter(rows, 33, 9, first, nodes.T_w.reshape(n, 9))


@kernel
def balance_rotation(new: State, section: Section, loads: Loads, past: Array, c0: float, nodes: Nodes) -> None:
    """Write q = K (kappa - kappa0) and W = I omega_t + omega x I omega + c I omega - Q with its tangent by omega."""
    for j in range(len(past)):
        W, D = nodes.W[j], nodes.W_w[j]
        I0, I1, I2 = section.inertia[j, 0], section.inertia[j, 1], section.inertia[j, 2]
        w0, w1, w2 = new.Y[j, OMEGA], new.Y[j, OMEGA + 1], new.Y[j, OMEGA + 2]
        for i in range(3):
            nodes.q[j, i] = section.stiffness[j, i] * (new.Y[j, KAPPA + i] - section.kappa0[j, i])
            rate = c0 * new.Y[j, OMEGA + i] + past[j, 9 + i] + loads.damping * new.Y[j, OMEGA + i]
            W[i] = section.inertia[j, i] * rate - loads.material[j, 3 + i]
            D[i, i] = section.inertia[j, i] * (c0 + loads.damping)
        W[0] += (I2 - I1) * w1 * w2
        W[1] += (I0 - I2) * w2 * w0
        W[2] += (I1 - I0) * w0 * w1
        D[0, 1], D[0, 2] = (I2 - I1) * w2, (I2 - I1) * w1
        D[1, 0], D[1, 2] = (I0 - I2) * w2, (I0 - I2) * w0
        D[2, 0], D[2, 1] = (I1 - I0) * w1, (I1 - I0) * w0
    if loads.turns:
        for j in range(len(past)):
            _subtract_lab_moment(nodes.R[j], nodes.J[j], loads.lab[j, 3:], nodes.W[j], nodes.W_w[j])


@kernel
def _subtract_lab_moment(R: Array, J: Array, moment: Array, W: Array, W_w: Array) -> None:
    """Subtract R^t moment from W and its tangent from W_w: d(R^t m) = (R^t m) x d psi."""
    for i in range(3):
        a, c = (i + 1) % 3, (i + 2) % 3
        at_a = R[0, a] * moment[0] + R[1, a] * moment[1] + R[2, a] * moment[2]
        at_c = R[0, c] * moment[0] + R[1, c] * moment[1] + R[2, c] * moment[2]
        W[i] -= R[0, i] * moment[0] + R[1, i] * moment[1] + R[2, i] * moment[2]
        for k in range(3):
            W_w[i, k] -= at_a * J[c, k] - at_c * J[a, k]


@kernel
def balance_translation(new: State, section: Section, loads: Loads, past: Array, c0: float, nodes: Nodes) -> None:
    """Write P = rho_c A (dV/dt + c V) - B with its tangents by V and omega."""
    for j in range(len(past)):
        mass = section.mass[j]
        P, P_V, P_w = nodes.P[j], nodes.P_V[j], nodes.P_w[j]
        for i in range(3):
            velocity = new.Y[j, V + i]
            P[i] = mass * (c0 * velocity + past[j, 6 + i] + loads.damping * velocity) - loads.lab[j, i]
            for k in range(3):
                P_V[i, k] = 0.0
                P_w[i, k] = 0.0
            P_V[i, i] = mass * (c0 + loads.damping)
    if loads.follows:
        _subtract_material_force(loads.material, nodes)
    if loads.wet:
        _add_fluid(new, loads, past, c0, nodes)


@kernel
def _subtract_material_force(force: Array, nodes: Nodes) -> None:
    """Subtract R force, `force` (n, >= 3), from P, and its tangent from P_w."""
    b = scratch(3)
    for j in range(len(nodes.P)):
        R, P = nodes.R[j], nodes.P[j]
        for i in range(3):
            b[i] = -force[j, i]
        rotation_tangent(R, b, nodes.J[j], nodes.P_w[j])
        for i in range(3):
            P[i] += R[i, 0] * b[0] + R[i, 1] * b[1] + R[i, 2] * b[2]


@kernel
def _add_fluid(new: State, loads: Loads, past: Array, c0: float, nodes: Nodes) -> None:
    """Add the fluid's force with its tangents."""
    acceleration, u = scratch(3), scratch(3)
    for j in range(len(past)):
        for i in range(3):
            acceleration[i] = c0 * new.Y[j, V + i] + past[j, 6 + i]
            u[i] = new.Y[j, V + i] - loads.current[i]
        T, T_w, P, P_V, P_w = nodes.T[j], nodes.T_w[j], nodes.P[j], nodes.P_V[j], nodes.P_w[j]
        add_added_mass(loads.added_mass[j], c0, acceleration, T, T_w, P, P_V, P_w)
        add_drag(loads.drag_normal[j], loads.drag_tangential[j], u, T, T_w, P, P_V, P_w)
