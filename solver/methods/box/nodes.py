"""The physics at a node: frames, inertia, moments and loads at the current iterate, with their tangents.

What not every scene has is added in loops of its own: within the others it slows down scenes without it, too.
"""

from __future__ import annotations

from solver.kernel import kernel
from solver.loads.applied import Loads
from solver.loads.fluid import add_added_mass, add_drag
from solver.methods.box.fields import KAPPA, OMEGA, Nodes, State, V
from solver.rod import Array, Section
from solver.rotation import matrix_of, right_jacobian, turn


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
    """Write positions and orientations of `new` and the nodes' R, J, T with its tangent."""
    theta = nodes.scratch[0]
    for j in range(len(past)):
        R, J = nodes.R[j], nodes.J[j]
        for i in range(3):
            new.r[j, i] = past[j, i] + new.Y[j, V + i] / c0
            theta[i] = past[j, 3 + i] + new.Y[j, OMEGA + i] / c0
        turn(old.quaternion[j], theta, new.quaternion[j])
        matrix_of(new.quaternion[j], R)
        right_jacobian(theta, 1.0 / c0, J)
        for i in range(3):
            nodes.T[j, i] = R[i, 2]
            for k in range(3):
                nodes.T_w[j, i, k] = R[i, 0] * J[1, k] - R[i, 1] * J[0, k]


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
    b = nodes.scratch[0]
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
    acceleration, u = nodes.scratch[0], nodes.scratch[1]
    for j in range(len(past)):
        for i in range(3):
            acceleration[i] = c0 * new.Y[j, V + i] + past[j, 6 + i]
            u[i] = new.Y[j, V + i] - loads.current[i]
        T, T_w, P, P_V, P_w = nodes.T[j], nodes.T_w[j], nodes.P[j], nodes.P_V[j], nodes.P_w[j]
        add_added_mass(loads.added_mass[j], c0, acceleration, T, T_w, P, P_V, P_w)
        add_drag(loads.drag_normal[j], loads.drag_tangential[j], u, T, T_w, P, P_V, P_w)
