"""Contact in the staggered method's iteration: forces on the nodes at each stage, and the solve with their tangents.

The tangents of contact are those of the middle stage, as the rod's are: at this iterate, or at an earlier one as long
as the iteration gets on. So the real and the complex system, into which the stages fall apart, are solved for the
forces one after the other: where the nodes of one move by x, the forces on them change by S x, with the velocities'
part in S by the system's eigenvalue. The directions of a step's earlier solves serve again, as the rod's tangents stay;
while the tangents of contact do, their images are known, too.
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
from solver.methods.linear.stages import clear, load_pair, load_real, solve_loaded, solve_stages
from solver.methods.space.segments.balances import Driven, Tangents
from solver.methods.space.segments.chain import STAGES, Chain, Residuals, Stages, State
from solver.methods.space.segments.joints import share
from solver.methods.space.segments.opening import shift_nodes
from solver.physics.contact.forces import Passed, Touch, allowed_fraction, change_forces, press
from solver.physics.contact.members import Members

SOLVED = 1e-4
"""Relative residual at which the solve stops. Of a larger one Newton takes more iterations (docs/decisions/0004)."""


MIDDLE = 1
"""The stage at which the tangents are taken."""


class Half(NamedTuple):
    """Scratch of one system: `krylov`, the `responses` of places to its directions, and of how many of them responses
    and images are `known` (2,); changes of the places of the `nodes` (N + 1, 3)."""

    krylov: Krylov
    responses: Array
    known: Array
    nodes: Array

    @classmethod
    def empty(cls, nodes: int, dtype: type) -> Half:
        """Zeros."""
        krylov = Krylov.empty(3 * nodes, dtype)
        return cls(krylov, np.zeros_like(krylov.directions), np.zeros(2, np.int64), np.zeros((nodes, 3), dtype))


class Coupling(NamedTuple):
    """Scratch of the solve with contact, of the `real` and of the complex system, the `pair`; places and velocities of
    the nodes `r`, `V` (3, N + 1, 3), and the changes of their places at one stage `moved` (N + 1, 3)."""

    real: Half
    pair: Half
    r: Array
    V: Array
    moved: Array

    @classmethod
    def empty(cls, intervals: int) -> Coupling:
        """Zeros for N = `intervals`; 0 where there is no contact."""
        n = intervals + 1
        return cls(Half.empty(n, np.float64), Half.empty(n, np.complex128), np.zeros((STAGES, n, 3)),
                   np.zeros((STAGES, n, 3)), np.zeros((n, 3)))  # fmt: skip


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
    press(touch, coupling.r, coupling.V, MIDDLE if fresh else -1)
    copy(touch.push, driven.push)


@inner
def _load_forces(chain: Chain, tangents: Tangents, y: Array, sign: float, touch: Touch, members: Members,
                 factors: Factors) -> None:  # fmt: skip
    """Add to the right-hand side what forces `sign` y on the nodes, those of `members`, do to the balances."""
    slot, last, h, R = touch.pairs.members.slot, len(chain.mass), chain.h, tangents.R
    for m in range(members.counts[1]):
        node = members.nodes[m]
        part, at = sign * share(node, last), 3 * slot[node]
        f = (part * y[at], part * y[at + 1], part * y[at + 2])
        for j, side in ((node - 1, 0.5 * h), (node, -0.5 * h)):
            if j < 0 or j >= last:
                continue
            factors.x[j + 1, 0] -= side * (R[j + 1, 0, 1] * f[0] + R[j + 1, 1, 1] * f[1] + R[j + 1, 2, 1] * f[2])
            factors.x[j + 1, 1] += side * (R[j + 1, 0, 0] * f[0] + R[j + 1, 1, 0] * f[1] + R[j + 1, 2, 0] * f[2])
            for k in range(3):
                factors.load[j, k] -= f[k]


@inner
def _respond(chain: Chain, tangents: Tangents, factors: Factors, members: Members, response: Array) -> None:
    """Write the changes of place of the nodes of `members` (node, 3) into `response`."""
    for m in range(members.counts[1]):
        for k in range(3):
            response[3 * m + k] = node_moves(chain, tangents, factors, members.nodes[m], k)


@inner
def _change(response: Array, rate: complex, touch: Touch, passed: Passed, nodes: Array, y: Array) -> None:
    """y = S x: the change of the forces."""
    members, slot = touch.tangents.members, touch.pairs.members.slot
    for m in range(members.counts[1]):
        node = members.nodes[m]
        for k in range(3):
            nodes[node, k] = response[3 * slot[node] + k]
    change_forces(touch, rate, nodes, passed, y)


@inner
def _find_forces(chain: Chain, driven: Driven, tangents: Tangents, eigenvalue: complex, factors: Factors, touch: Touch,
                 passed: Passed, half: Half, first: bool, fresh: bool) -> None:  # fmt: skip
    """Write the forces of contact that belong to the solution of one system into `half.krylov.y`, from the solution
    without them. See `solve_with_contact`."""
    near, krylov, known, responses = touch.pairs.members, half.krylov, half.known, half.responses
    size, used = 3 * near.counts[1], 0
    if first:
        known[0] = 0
    _respond(chain, tangents, factors, near, krylov.z)
    _change(krylov.z, eigenvalue, touch, passed, half.nodes, krylov.y)
    begin(krylov, size)
    if not fresh:
        used = known[1]
        project(krylov, used, size)
    while unsolved(krylov, used, size, SOLVED):
        if used >= known[0]:
            set_out(krylov, used, size)
            clear(factors)
            _load_forces(chain, tangents, krylov.directions[used], -1.0, touch, touch.tangents.members, factors)
            solve_loaded(chain, driven, tangents, eigenvalue, factors)
            _respond(chain, tangents, factors, near, responses[used])
        _change(responses[used], eigenvalue, touch, passed, half.nodes, krylov.z)
        follow(krylov, used, size)
        used += 1
    known[0], known[1] = min(KEPT, max(used, known[0])), min(KEPT, used)
    combine(krylov, used, size)


@kernel
def solve_with_contact(chain: Chain, driven: Driven, tangents: Tangents, transform: Array, gamma: float, lam: complex,
                       residuals: Residuals, real: Factors, pair: Factors, touch: Touch, coupling: Coupling,
                       first: bool, fresh: bool) -> float:  # fmt: skip
    """Solve for the increments that belong to the transformed `residuals`, with the tangents of contact.

    The directions of the step's earlier solves, of which the `first` has none, come first: their responses are known,
    and their images unless the tangents are `fresh`. Returns how much of the increment may be taken without using up a
    pair's distance.
    """
    near, a, z = touch.pairs.members, coupling.real, coupling.pair
    solve_stages(chain, driven, tangents, gamma, lam, residuals, real, pair)
    _find_forces(chain, driven, tangents, gamma, real, touch, touch.passed, a, first, fresh)
    _find_forces(chain, driven, tangents, lam, pair, touch, touch.passed_pair, z, first, fresh)
    load_real(residuals, real)
    _load_forces(chain, tangents, a.krylov.y, 1.0, touch, near, real)
    solve_loaded(chain, driven, tangents, gamma, real)
    load_pair(residuals, pair)
    _load_forces(chain, tangents, z.krylov.y, 1.0, touch, near, pair)
    solve_loaded(chain, driven, tangents, lam, pair)
    _respond(chain, tangents, real, near, a.krylov.z)
    _respond(chain, tangents, pair, near, z.krylov.z)
    fraction, T = 1.0, transform
    for i in range(STAGES):
        for m in range(near.counts[1]):
            for k in range(3):
                x, w = a.krylov.z[3 * m + k], z.krylov.z[3 * m + k]
                coupling.moved[near.nodes[m], k] = T[i, 0] * x + T[i, 1] * w.real + T[i, 2] * w.imag
        fraction = min(fraction, allowed_fraction(touch, coupling.moved, i))
    return fraction
