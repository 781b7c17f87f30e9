"""Contact in the staggered method's iteration: forces on the nodes at each stage, and the solve with their tangents.

The rod's tangents are those of the step's first guess. Those of contact are the stages' own: at this iterate, or at an
earlier one as long as the iteration gets on; then the images of the directions are known, too. An increment of the
forces y at all stages goes through the rod's real and complex systems, and comes back as an increment of motion at all
stages.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from solver.arrays import Array
from solver.kernels.copying import copy
from solver.kernels.handed import Reference
from solver.kernels.kernel import inner, kernel
from solver.methods.linear.krylov import KEPT, Krylov, begin, combine, follow, project, set_out, unsolved
from solver.methods.linear.segments import Factors
from solver.methods.linear.segments_increments import node_moves
from solver.methods.linear.stages import solve_stages
from solver.methods.space.segments.balances import Driven, Tangents
from solver.methods.space.segments.chain import STAGES, Chain, Residuals, Stages, State
from solver.methods.space.segments.joints import share
from solver.methods.space.segments.opening import shift_nodes
from solver.physics.contact.forces import Touch, allowed_fraction, change_forces, move_points, press
from solver.physics.contact.members import Members

SOLVED = 1e-4
"""Relative residual at which the solve stops. Of a larger one Newton takes more iterations (docs/decisions/0004)."""


class Coupling(NamedTuple):
    """Scratch of the solve with contact: `krylov`, the `responses` of places to its directions, and of how many of them
    responses and images are `known` (2,); `rows` residuals of the transformed stages; places and velocities of the
    nodes `r`, `V` (3, N + 1, 3), and their changes `moved`, `accelerated`."""

    krylov: Krylov
    responses: Array
    known: Array
    rows: Residuals
    r: Array
    V: Array
    moved: Array
    accelerated: Array

    @classmethod
    def empty(cls, intervals: int) -> Coupling:
        """Zeros for N = `intervals`; 0 where there is no contact."""
        n = intervals + 1
        krylov, moves = Krylov.empty(9 * n), [np.zeros((3, n, 3)) for _ in range(4)]
        return cls(krylov, np.zeros_like(krylov.directions), np.zeros(2, np.int64), Residuals.empty(intervals), *moves)


@kernel
def place_nodes(chain: Chain, R: Array, omega: Array, base: Array, opening: Array, centres: Array, speeds: Array,
                r: Array, V: Array) -> None:  # fmt: skip
    """Write places and velocities of the nodes (N + 1, 3) from those of the start and of the segments' centres, and
    from the joints' `opening`."""
    half = 0.5 * chain.h
    for k in range(3):
        r[0, k], V[0, k] = base[0, k], base[1, k]
    for j in range(len(centres)):
        Q, w = R[j + 1], omega[j + 1]
        for k in range(3):
            r[j + 1, k] = centres[j, k] + half * Q[k, 2]
            V[j + 1, k] = speeds[j, k] + half * (Q[k, 0] * w[1] - Q[k, 1] * w[0])
    shift_nodes(chain, R, omega, opening, r, V)


@kernel
def show_last_stage(reference: Reference, state: State, centres: Array, R: Array, joints: Array, nodes: Array) -> None:
    """Write R (N + 2, 3, 3), the joints' rotation vectors (N + 1, 3), and the nodes' places and velocities
    (2, N + 1, 3) of the `state` at the end of a step, whose `centres` are known."""
    chain, stages = reference.chain, reference.stages
    copy(stages.R[STAGES - 1], R)
    copy(stages.bend[STAGES - 1], joints)
    place_nodes(chain, R, state.omega, state.base, state.opening, centres[0], centres[1], nodes[0], nodes[1])


@inner
def press_stages(chain: Chain, stages: Stages, driven: Driven, touch: Touch, coupling: Coupling, fresh: bool) -> None:
    """Write the forces on the nodes of all stages to `driven.push`; if `fresh`, with the tangents that serve on."""
    for i in range(STAGES):
        place_nodes(chain, stages.R[i], stages.omega[i], stages.base[i], stages.opening[i], stages.r[i], stages.V[i],
                    coupling.r[i], coupling.V[i])  # fmt: skip
    press(touch, touch.tangents if fresh else touch.pressing, coupling.r, coupling.V)
    copy(touch.push, driven.push)


@inner
def _load_with_forces(chain: Chain, tangents: Tangents, back: Array, y: Array, sign: float, touch: Touch,
                      members: Members, rows: Residuals) -> None:  # fmt: skip
    """Add to `rows` what forces `sign` y on the nodes (stage, node, 3), those of `members`, do to the transformed
    residuals."""
    slot, last, h = touch.pairs.members.slot, len(chain.mass), chain.h
    R, size = tangents.R, 3 * touch.pairs.members.counts[1]
    for m in range(members.counts[1]):
        node = members.nodes[m]
        part = sign * share(node, last)
        for i in range(STAGES):
            f = (0.0, 0.0, 0.0)
            for e in range(STAGES):
                at, weight = size * e + 3 * slot[node], part * back[i, e]
                f = (f[0] + weight * y[at], f[1] + weight * y[at + 1], f[2] + weight * y[at + 2])
            for j, side in ((node - 1, 0.5 * h), (node, -0.5 * h)):
                if j < 0 or j >= last:
                    continue
                along = R[j + 1, 0, 1] * f[0] + R[j + 1, 1, 1] * f[1] + R[j + 1, 2, 1] * f[2]
                rows.rotation[i, j + 1, 0] += side * along
                along = R[j + 1, 0, 0] * f[0] + R[j + 1, 1, 0] * f[1] + R[j + 1, 2, 0] * f[2]
                rows.rotation[i, j + 1, 1] -= side * along
                for k in range(3):
                    rows.translation[i, j, k] -= f[k]


@inner
def _respond(chain: Chain, tangents: Tangents, transform: Array, real: Factors, pair: Factors, members: Members,
             response: Array) -> None:  # fmt: skip
    """Write the changes of place of the nodes of `members` at all stages (stage, node, 3) into `response`."""
    size = 3 * members.counts[1]
    for m in range(members.counts[1]):
        for k in range(3):
            a = node_moves(chain, tangents, real, members.nodes[m], k).real
            z = node_moves(chain, tangents, pair, members.nodes[m], k)
            for i in range(STAGES):
                at = size * i + 3 * m + k
                response[at] = transform[i, 0] * a + transform[i, 1] * z.real + transform[i, 2] * z.imag


@kernel
def _move(response: Array, inverse: Array, dt: float, touch: Touch, members: Members, coupling: Coupling) -> None:
    """Write the changes of place and velocity of the nodes of `members` at all stages."""
    slot, size = touch.pairs.members.slot, 3 * touch.pairs.members.counts[1]
    for m in range(members.counts[1]):
        node = members.nodes[m]
        for k in range(3):
            at = 3 * slot[node] + k
            a, b, c = response[at], response[at + size], response[at + 2 * size]
            for i in range(STAGES):
                coupling.moved[i, node, k] = response[at + i * size]
                rate = inverse[i, 0] * a + inverse[i, 1] * b + inverse[i, 2] * c
                coupling.accelerated[i, node, k] = rate / dt


@inner
def _change(response: Array, inverse: Array, dt: float, touch: Touch, coupling: Coupling, y: Array) -> None:
    """y = S x: the change of the forces at all stages."""
    members, size = touch.tangents.members, 3 * touch.pairs.members.counts[1]
    _move(response, inverse, dt, touch, members, coupling)
    for i in range(STAGES):
        move_points(touch, members, coupling.moved[i], coupling.accelerated[i])
        change_forces(touch, touch.tangents, i, y[i * size : (i + 1) * size])


@kernel
def solve_with_contact(chain: Chain, driven: Driven, tangents: Tangents, transform: Array, back: Array, inverse: Array,
                       gamma: float, lam: complex, dt: float, residuals: Residuals, real: Factors, pair: Factors,
                       touch: Touch, coupling: Coupling, first: bool, fresh: bool) -> float:  # fmt: skip
    """Solve for the increments that belong to the transformed `residuals`, with the tangents of contact.

    The directions of the step's earlier solves, of which the `first` has none, come first: their responses are known,
    and their images unless the tangents are `fresh`. Returns how much of the increment may be taken without using up a
    pair's distance.
    """
    pressing = touch.tangents if fresh else touch.pressing
    near, krylov, rows, responses = touch.pairs.members, coupling.krylov, coupling.rows, coupling.responses
    size = 3 * STAGES * near.counts[1]
    used = 0
    if first:
        coupling.known[0] = 0
    solve_stages(chain, driven, tangents, gamma, lam, residuals, real, pair)
    _respond(chain, tangents, transform, real, pair, near, krylov.z)
    _change(krylov.z, inverse, dt, touch, coupling, krylov.y)
    begin(krylov, size)
    if not fresh:
        used = coupling.known[1]
        project(krylov, used, size)
    while unsolved(krylov, used, size, SOLVED):
        if used >= coupling.known[0]:
            set_out(krylov, used, size)
            _clear(rows)
            _load_with_forces(chain, tangents, back, krylov.directions[used], -1.0, touch, touch.tangents.members,
                              rows)  # fmt: skip
            solve_stages(chain, driven, tangents, gamma, lam, rows, real, pair)
            _respond(chain, tangents, transform, real, pair, near, responses[used])
        _change(responses[used], inverse, dt, touch, coupling, krylov.z)
        follow(krylov, used, size)
        used += 1
    coupling.known[0], coupling.known[1] = min(KEPT, max(used, coupling.known[0])), min(KEPT, used)
    combine(krylov, used, size)
    copy(residuals.rotation, rows.rotation)
    copy(residuals.translation, rows.translation)
    copy(residuals.ends, rows.ends)
    _load_with_forces(chain, tangents, back, krylov.y, 1.0, touch, near, rows)
    solve_stages(chain, driven, tangents, gamma, lam, rows, real, pair)
    _respond(chain, tangents, transform, real, pair, near, krylov.z)
    _move(krylov.z, inverse, dt, touch, near, coupling)
    fraction = 1.0
    for i in range(STAGES):
        move_points(touch, near, coupling.moved[i], coupling.accelerated[i])
        fraction = min(fraction, allowed_fraction(touch, pressing, i))
    return fraction


@inner
def _clear(rows: Residuals) -> None:
    rows.rotation[:] = 0.0
    rows.translation[:] = 0.0
    rows.ends[:] = 0.0
