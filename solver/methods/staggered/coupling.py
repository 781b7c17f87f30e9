"""Contact in the staggered method's iteration: forces on the nodes at each stage, and the solve with their tangents.

The rod's tangents are frozen, those of contact are the stages' own: an increment of the forces y at all stages goes
through the rod's real and complex systems, and comes back as an increment of motion at all stages.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from solver.contact.forces import Touch, allowed_fraction, change_forces, move_points, press
from solver.contact.krylov import Krylov, begin, combine, extend, unsolved
from solver.kernel import kernel
from solver.methods.staggered.chain import STAGES, Chain, Residuals, Stages
from solver.methods.staggered.segments import Driven, Tangents, share
from solver.methods.staggered.tridiagonal import Factors, node_moves, solve_stages
from solver.rod import Array

SOLVED = 1e-3
"""Relative residual at which GMRES stops. In the thick cable of validation/ 1e-2 took more of Newton's iterations and
more time, 1e-1 three times as much."""


class Coupling(NamedTuple):
    """Scratch of the solve with contact: `krylov`; `rows` residuals of the transformed stages; forces on the nodes
    `mixed` (3, N + 1, 3); places and velocities of the nodes `r`, `V` (3, N + 1, 3), and their changes `moved`,
    `accelerated`."""

    krylov: Krylov
    rows: Residuals
    mixed: Array
    r: Array
    V: Array
    moved: Array
    accelerated: Array

    @classmethod
    def empty(cls, intervals: int) -> Coupling:
        """Zeros for N = `intervals`; 0 where there is no contact."""
        n = intervals + 1
        return cls(Krylov.empty(9 * n), Residuals.empty(intervals), *(np.zeros((3, n, 3)) for _ in range(5)))


@kernel
def place_nodes(chain: Chain, R: Array, omega: Array, base: Array, centres: Array, speeds: Array,
                r: Array, V: Array) -> None:  # fmt: skip
    """Write places and velocities of the nodes (N + 1, 3) from those of the start and of the segments' centres."""
    half = 0.5 * chain.h
    for k in range(3):
        r[0, k], V[0, k] = base[0, k], base[1, k]
    for j in range(len(centres)):
        Q, w = R[j + 1], omega[j + 1]
        for k in range(3):
            r[j + 1, k] = centres[j, k] + half * Q[k, 2]
            V[j + 1, k] = speeds[j, k] + half * (Q[k, 0] * w[1] - Q[k, 1] * w[0])


@kernel
def press_stages(chain: Chain, stages: Stages, driven: Driven, touch: Touch, coupling: Coupling) -> None:
    """Write the forces on the nodes at all stages into `driven.push`."""
    for i in range(STAGES):
        place_nodes(chain, stages.R[i], stages.omega[i], stages.base[i], stages.r[i], stages.V[i],
                    coupling.r[i], coupling.V[i])  # fmt: skip
        press(touch, coupling.r[i], coupling.V[i], i)
    driven.push[:] = touch.push


@kernel
def _load_with_forces(chain: Chain, tangents: Tangents, back: Array, y: Array, sign: float, touch: Touch,
                      coupling: Coupling) -> None:  # fmt: skip
    """Add to coupling.rows what forces `sign` y on the nodes (stage, node, 3) do to the transformed residuals."""
    pairs, rows, mixed = touch.pairs, coupling.rows, coupling.mixed
    count, last, h = pairs.counts[2], len(chain.mass), chain.h
    for m in range(count):
        for i in range(STAGES):
            for c in range(3):
                mixed[i, m, c] = 0.0
                for e in range(STAGES):
                    mixed[i, m, c] += sign * back[i, e] * y[3 * (count * e + m) + c]
    for m in range(count):
        node = pairs.nodes[m]
        part = share(node, last)
        for i in range(STAGES):
            f = mixed[i, m]
            for j, side in ((node - 1, 1.0), (node, -1.0)):
                if j < 0 or j >= last:
                    continue
                R = tangents.R[j + 1]
                p0 = R[0, 0] * f[0] + R[1, 0] * f[1] + R[2, 0] * f[2]
                p1 = R[0, 1] * f[0] + R[1, 1] * f[1] + R[2, 1] * f[2]
                rows.rotation[i, j + 1, 0] += side * part * 0.5 * h * p1
                rows.rotation[i, j + 1, 1] -= side * part * 0.5 * h * p0
                for k in range(3):
                    rows.translation[i, j, k] -= part * f[k]


@kernel
def _move(chain: Chain, tangents: Tangents, transform: Array, inverse: Array, dt: float, real: Factors, pair: Factors,
          touch: Touch, coupling: Coupling) -> None:  # fmt: skip
    """Write the changes of place and velocity of the nodes that take part, at all stages."""
    moved = coupling.moved
    for m in range(touch.pairs.counts[2]):
        node = touch.pairs.nodes[m]
        for k in range(3):
            a, z = node_moves(chain, tangents, real, node, k).real, node_moves(chain, tangents, pair, node, k)
            for i in range(STAGES):
                moved[i, node, k] = transform[i, 0] * a + transform[i, 1] * z.real + transform[i, 2] * z.imag
            for i in range(STAGES):
                rate = inverse[i, 0] * moved[0, node, k] + inverse[i, 1] * moved[1, node, k]
                coupling.accelerated[i, node, k] = (rate + inverse[i, 2] * moved[2, node, k]) / dt


@kernel
def _change(touch: Touch, coupling: Coupling, y: Array) -> None:
    """y = S x: the change of the forces at all stages."""
    size = 3 * touch.pairs.counts[2]
    for i in range(STAGES):
        move_points(touch, coupling.moved[i], coupling.accelerated[i])
        change_forces(touch, i, y[i * size : (i + 1) * size])


@kernel
def solve_with_contact(chain: Chain, driven: Driven, tangents: Tangents, transform: Array, back: Array, inverse: Array,
                       gamma: float, lam: complex, dt: float, residuals: Residuals, real: Factors, pair: Factors,
                       touch: Touch, coupling: Coupling) -> float:  # fmt: skip
    """Solve for the increments that belong to the transformed `residuals`, with the tangents of contact.

    Returns how much of the increment may be taken without using up a pair's distance.
    """
    size, krylov, rows = 3 * STAGES * touch.pairs.counts[2], coupling.krylov, coupling.rows
    solve_stages(chain, driven, tangents, gamma, lam, residuals, real, pair)
    _move(chain, tangents, transform, inverse, dt, real, pair, touch, coupling)
    _change(touch, coupling, krylov.y)
    used = 0
    if begin(krylov, size):
        while unsolved(krylov, used, size, SOLVED):
            _clear(rows)
            _load_with_forces(chain, tangents, back, krylov.basis[used], -1.0, touch, coupling)
            solve_stages(chain, driven, tangents, gamma, lam, rows, real, pair)
            _move(chain, tangents, transform, inverse, dt, real, pair, touch, coupling)
            _change(touch, coupling, krylov.z)
            extend(krylov, used, size)
            used += 1
    combine(krylov, used, size)
    rows.rotation[:] = residuals.rotation
    rows.translation[:] = residuals.translation
    rows.ends[:] = residuals.ends
    _load_with_forces(chain, tangents, back, krylov.y, 1.0, touch, coupling)
    solve_stages(chain, driven, tangents, gamma, lam, rows, real, pair)
    _move(chain, tangents, transform, inverse, dt, real, pair, touch, coupling)
    fraction = 1.0
    for i in range(STAGES):
        move_points(touch, coupling.moved[i], coupling.accelerated[i])
        fraction = min(fraction, allowed_fraction(touch))
    return fraction


@kernel
def _clear(rows: Residuals) -> None:
    rows.rotation[:] = 0.0
    rows.translation[:] = 0.0
    rows.ends[:] = 0.0
