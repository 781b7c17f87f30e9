"""Contact in the box method's Newton iteration: forces on the nodes, and the linear solve with their tangents."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from solver.arrays import Array
from solver.kernels.copying import copy
from solver.kernels.kernel import inlined, inner, kernel
from solver.methods.linear.krylov import Krylov, begin, combine, follow, set_out, unsolved
from solver.methods.linear.system import LinearSolver, System, solve
from solver.methods.space.box.fields import Nodes, State, V
from solver.physics.contact.forces import Touch, allowed_fraction, change_forces, press
from solver.physics.contact.members import Members

SOLVED = 1e-6
"""Relative residual at which the solve stops: far below what Newton's quadratic convergence would notice."""


class Coupling(NamedTuple):
    """Scratch of the solve with contact: `krylov`; a right-hand side `force` (N, 12) and its solution `x` (n, 12);
    changes of the nodes' places `moved` (n, 3)."""

    krylov: Krylov
    force: Array
    x: Array
    moved: Array

    @classmethod
    def empty(cls, intervals: int) -> Coupling:
        """Zeros for a rod of `intervals` intervals; 0 where there is no contact."""
        n = intervals + 1
        return cls(Krylov.empty(3 * n), np.zeros((intervals, 12)), np.zeros((n, 12)), np.zeros((n, 3)))


@inlined
def _length(j: int, last: int, h: float) -> float:
    """The length on which a density at node j acts."""
    return 0.5 * h if j == 0 or j == last else h


@kernel
def add_contact(new: State, nodes: Nodes, h: float, touch: Touch) -> None:
    """Subtract the densities of the forces of contact from nodes.P, and keep the tangents."""
    press(touch, new.r.reshape((1, -1, 3)), new.Y.reshape((1, -1, 12)), 0)
    members, last = touch.tangents.members, len(new.Y) - 1
    for m in range(members.counts[1]):
        j = members.nodes[m]
        for k in range(3):
            nodes.P[j, k] -= touch.push[0, j, k] / _length(j, last, h)


@kernel
def _move(x: Array, c0: float, system: System, members: Members, coupling: Coupling) -> None:
    """Write the changes of place of the nodes of `members`, by the scaled unknowns x (n, 12)."""
    for m in range(members.counts[1]):
        j = members.nodes[m]
        for k in range(3):
            coupling.moved[j, k] = system.columns[V + k] * x[j, V + k] / c0


@inner
def _change(c0: float, system: System, touch: Touch, coupling: Coupling, y: Array) -> None:
    """y = S x: the change of the forces that belongs to coupling.x."""
    _move(coupling.x, c0, system, touch.tangents.members, coupling)
    change_forces(touch, c0, coupling.moved, touch.passed, y)


@inner
def _solve_for_forces(linear: LinearSolver, y: Array, h: float, system: System, touch: Touch, sign: float,
                      b_scale: float, coupling: Coupling) -> None:  # fmt: skip
    """coupling.x = K^-1 (b_scale b + sign E y), b the system's residuals."""
    members, force = touch.pairs.members, coupling.force
    last = len(force)
    for j in range(last):
        for k in range(12):
            force[j, k] = b_scale * system.b[j, k]
    for m in range(members.counts[1]):
        node = members.nodes[m]
        density = 1.0 / _length(node, last, h)
        for j in range(max(node - 1, 0), min(node, last - 1) + 1):
            for c in range(3):
                force[j, 6 + c] += sign * 0.5 * h * density * system.rows[6 + c] * y[3 * m + c]
    solve(linear, system, b_scale, force, coupling.x)


@kernel
def solve_with_contact(linear: LinearSolver, c0: float, h: float, system: System, touch: Touch,
                       coupling: Coupling) -> int:  # fmt: skip
    """Solve the factored system with the contact tangents into system.x; returns how many products it took."""
    krylov, size = coupling.krylov, 3 * touch.pairs.members.counts[1]
    used = 0
    _solve_for_forces(linear, krylov.y, h, system, touch, 0.0, 1.0, coupling)
    _change(c0, system, touch, coupling, krylov.y)
    begin(krylov, size)
    while unsolved(krylov, used, size, SOLVED):
        set_out(krylov, used, size)
        _solve_for_forces(linear, krylov.directions[used], h, system, touch, 1.0, 0.0, coupling)
        _change(c0, system, touch, coupling, krylov.z)
        follow(krylov, used, size)
        used += 1
    combine(krylov, used, size)
    _solve_for_forces(linear, krylov.y, h, system, touch, -1.0, 1.0, coupling)
    copy(coupling.x, system.x)
    return used


@inner
def contact_fraction(c0: float, system: System, touch: Touch, coupling: Coupling) -> float:
    """How much of the update system.x may be taken without using up a pair's distance."""
    _move(system.x, c0, system, touch.pairs.members, coupling)
    return float(allowed_fraction(touch, coupling.moved, 0))
