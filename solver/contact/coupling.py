"""Contact in Newton's iteration: forces on the nodes, and the linear solve with its tangents.

The rod's tangent K is almost block diagonal; contact adds E S, where S maps displacements to node forces y and E puts
them into the balances. From K x + E y = b and y = S x follows (1 + S K^-1 E) y = S K^-1 b, a system for the few
nodes in contact, solved by GMRES (Saad & Schultz 1986); each product is one solve with the rod's factors.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from solver.contact.law import Law, pair_force
from solver.contact.points import Points, place_point
from solver.contact.search import Pairs
from solver.kernel import kernel
from solver.methods.box.elimination import solve
from solver.methods.box.fields import OMEGA, Linear, Nodes, State, V
from solver.rod import Array

KRYLOV = 60
"""Largest number of GMRES iterations."""
SOLVED = 1e-6
"""Relative residual at which GMRES stops."""
LARGEST_APPROACH = 0.6
"""Part of a pair's distance that one Newton update may use."""


class Touch(NamedTuple):
    """Everything that contact needs in a step; `present` is False in a scene without contact.

    Scratch: `moved` (M, 9), changes of p, t, w; `basis` (KRYLOV + 1, 3 n); `y`, `z` (3 n,);
    `force` (N, 12) a right-hand side; `x` (n, 12); GMRES's `H` (KRYLOV + 1, KRYLOV), its Givens rotations
    `givens` (KRYLOV, 2) and residual `g` (KRYLOV + 1,).
    """

    present: bool
    law: Law
    points: Points
    pairs: Pairs
    moved: Array
    basis: Array
    y: Array
    z: Array
    force: Array
    x: Array
    H: Array
    givens: Array
    g: Array


@kernel
def add_contact(new: State, nodes: Nodes, h: float, touch: Touch) -> int:
    """Subtract the contact force density from nodes.P, and keep the tangents; returns the number of pressing pairs."""
    points, pairs = touch.points, touch.pairs
    last, pressing = len(new.Y) - 1, 0
    for m in range(pairs.counts[1]):
        place_point(points, pairs.points[m], new.r, nodes.T, new.Y)
    for pair in range(pairs.counts[0]):
        a, b = pairs.first[pair], pairs.second[pair]
        elastic, damping, _ = pair_force(touch.law, points, a, b, pairs.n[pair], pairs.G[pair], pairs.k[pair])
        pairs.force[pair, 0], pairs.force[pair, 1] = elastic, damping
        if elastic != 0.0:
            pressing += 1
            for k in range(3):
                force = (elastic + damping) * pairs.n[pair, k]
                _spread(points, a, -force, last, h, nodes.P[:, k])
                _spread(points, b, force, last, h, nodes.P[:, k])
    return pressing


@kernel
def _spread(points: Points, i: int, force: float, last: int, h: float, density: Array) -> None:
    """Add a force at point i to the densities of its interval's two nodes."""
    j, xi = points.interval[i], points.xi[i]
    density[j] += (1.0 - xi) * force / (0.5 * h if j == 0 else h)
    density[j + 1] += xi * force / (0.5 * h if j + 1 == last else h)


@kernel
def _move_points(x: Array, c0: float, system: Linear, nodes: Nodes, touch: Touch) -> None:
    """Write the changes of p, t, w of the points that take part, for scaled unknowns x (n, 12), into touch.moved."""
    points, columns = touch.points, system.columns
    for m in range(touch.pairs.counts[1]):
        i = touch.pairs.points[m]
        j, xi = points.interval[i], points.xi[i]
        for k in range(9):
            touch.moved[i, k] = 0.0
        for side in range(2):
            node = j + side
            share = xi if side == 1 else 1.0 - xi
            for k in range(3):
                velocity = columns[V + k] * x[node, V + k]
                tangent = 0.0
                for c in range(3):
                    tangent += nodes.T_w[node, k, c] * columns[OMEGA + c] * x[node, OMEGA + c]
                touch.moved[i, k] += points.hermite[i, 2 * side] * velocity / c0
                touch.moved[i, k] += points.hermite[i, 2 * side + 1] * tangent
                touch.moved[i, 3 + k] += share * tangent
                touch.moved[i, 6 + k] += share * velocity


@kernel
def _node_forces(x: Array, c0: float, h: float, system: Linear, nodes: Nodes, touch: Touch, y: Array) -> None:
    """y = S x: the change of P at the nodes that take part (3 per node), for scaled unknowns x (n, 12)."""
    points, pairs, moved = touch.points, touch.pairs, touch.moved
    last = len(x) - 1
    _move_points(x, c0, system, nodes, touch)
    y[: 3 * pairs.counts[2]] = 0.0
    for pair in range(pairs.counts[0]):
        if pairs.force[pair, 0] == 0.0:
            continue
        a, b = pairs.first[pair], pairs.second[pair]
        n, k = pairs.n[pair], pairs.k[pair]
        along = 0.0
        for c in range(3):
            turned = k[0] * moved[a, 3 + c] + k[1] * moved[b, 3 + c]
            along += n[c] * (turned + k[2] * (moved[a, 6 + c] - moved[b, 6 + c]))
        for c in range(3):
            force = n[c] * along
            for e in range(3):
                force += pairs.G[pair, c, e] * (moved[a, e] - moved[b, e])
            for i, sign in ((a, -1.0), (b, 1.0)):
                j, xi = points.interval[i], points.xi[i]
                y[3 * pairs.slot[j] + c] += sign * (1.0 - xi) * force / (0.5 * h if j == 0 else h)
                y[3 * pairs.slot[j + 1] + c] += sign * xi * force / (0.5 * h if j + 1 == last else h)


@kernel
def _solve_for_forces(y: Array, h: float, system: Linear, touch: Touch, sign: float, b_scale: float) -> None:
    """touch.x = K^-1 (b_scale b + sign E y), b the system's residuals."""
    pairs = touch.pairs
    for j in range(len(touch.force)):
        for k in range(12):
            touch.force[j, k] = b_scale * system.b[j, k]
    for m in range(pairs.counts[2]):
        node = pairs.nodes[m]
        for j in range(max(node - 1, 0), min(node, len(touch.force) - 1) + 1):
            for c in range(3):
                touch.force[j, 6 + c] -= sign * 0.5 * h * system.rows[6 + c] * y[3 * m + c]
    solve(system, b_scale, touch.force, touch.x)


@kernel
def solve_with_contact(c0: float, h: float, nodes: Nodes, system: Linear, touch: Touch) -> int:
    """Solve the factored system with the contact tangents into system.x; returns GMRES's iterations."""
    size = 3 * touch.pairs.counts[2]
    Q, H, g = touch.basis, touch.H, touch.g
    _solve_for_forces(touch.y, h, system, touch, 0.0, 1.0)
    _node_forces(touch.x, c0, h, system, nodes, touch, touch.y)
    g[0] = _norm(touch.y, size)
    used = 0
    if g[0] > 0.0:
        for c in range(size):
            Q[0, c] = touch.y[c] / g[0]
        while used < min(KRYLOV, size) and abs(g[used]) > SOLVED * abs(g[0]) + 1e-300:
            _solve_for_forces(Q[used], h, system, touch, 1.0, 0.0)
            _node_forces(touch.x, c0, h, system, nodes, touch, touch.z)
            _arnoldi(Q, H, touch.z, used, size)
            _rotate(H, touch.givens, g, used)
            used += 1
    for m in range(used - 1, -1, -1):
        for k in range(m + 1, used):
            g[m] -= H[m, k] * g[k]
        g[m] /= H[m, m]
    touch.y[:size] = 0.0
    for m in range(used):
        for c in range(size):
            touch.y[c] += g[m] * Q[m, c]
    _solve_for_forces(touch.y, h, system, touch, -1.0, 1.0)
    system.x[:, :] = touch.x
    return used


@kernel
def _arnoldi(Q: Array, H: Array, z: Array, m: int, size: int) -> None:
    """Orthogonalise (1 + S K^-1 E) q_m = q_m + z against the basis: the next basis vector and column m of H."""
    for c in range(size):
        z[c] += Q[m, c]
    for k in range(m + 1):
        overlap = 0.0
        for c in range(size):
            overlap += Q[k, c] * z[c]
        for c in range(size):
            z[c] -= overlap * Q[k, c]
        H[k, m] = overlap
    H[m + 1, m] = _norm(z, size)
    for c in range(size):
        Q[m + 1, c] = z[c] / H[m + 1, m] if H[m + 1, m] > 0.0 else 0.0


@kernel
def _norm(z: Array, size: int) -> float:
    total = 0.0
    for c in range(size):
        total += z[c] * z[c]
    return float(np.sqrt(total))


@kernel
def _rotate(H: Array, givens: Array, g: Array, m: int) -> None:
    """Apply the old Givens rotations to column m of H, and a new one that annihilates H[m + 1, m]."""
    for k in range(m):
        upper = givens[k, 0] * H[k, m] + givens[k, 1] * H[k + 1, m]
        H[k + 1, m] = -givens[k, 1] * H[k, m] + givens[k, 0] * H[k + 1, m]
        H[k, m] = upper
    norm = np.sqrt(H[m, m] ** 2 + H[m + 1, m] ** 2)
    givens[m, 0], givens[m, 1] = H[m, m] / norm, H[m + 1, m] / norm
    H[m, m], H[m + 1, m] = norm, 0.0
    g[m + 1] = -givens[m, 1] * g[m]
    g[m] = givens[m, 0] * g[m]


@kernel
def allowed_fraction(c0: float, system: Linear, nodes: Nodes, touch: Touch) -> float:
    """How much of the update system.x may be taken without using up a pair's distance."""
    _move_points(system.x, c0, system, nodes, touch)
    fraction, pairs = 1.0, touch.pairs
    for pair in range(pairs.counts[0]):
        a, b = pairs.first[pair], pairs.second[pair]
        moved, distance = 0.0, 0.0
        for k in range(3):
            moved += (touch.moved[a, k] - touch.moved[b, k]) ** 2
            distance += (touch.points.p[a, k] - touch.points.p[b, k]) ** 2
        if moved * fraction**2 > LARGEST_APPROACH**2 * distance:
            fraction = LARGEST_APPROACH * np.sqrt(distance / moved)
    return fraction
