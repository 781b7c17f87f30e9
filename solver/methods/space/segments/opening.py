"""Stretch along the rod: the joints of a chain open, where its rod has a law for it.

Segments stay rigid. Joint a, between the orientations a and a + 1, opens by e along t, the mean of their tangents, or
the segment's own at an end:

    r_a+1 - r_a = (h/2) (T_a + T_a+1) + e t,   e = span eps(kappa, N),   N = F . t.

This is what the Lagrangian says in which F are the multipliers of unopened joints and each joint has its complementary
energy. So F turns both neighbours by their shares of e a3 x R^t F besides, what N adds to q turns them as q does, and
the tangents are symmetric. Nothing here is called where the rod cannot stretch.
"""

from __future__ import annotations

from typing import Any

from solver.arrays import Array
from solver.kernels.kernel import inlined, inner, kernel
from solver.kernels.vectors import (
    add_matrix,
    add_vector,
    dot,
    in_material,
    lever_turned,
    matrix,
    middle,
    outer,
    plus,
    tangent_acceleration,
    tangent_rate,
    times,
    vector,
)
from solver.methods.space.segments.chain import STAGES, Chain, Stages, State, rate_at
from solver.methods.space.segments.joints import add_moment, bend_joints, on_neighbours, share
from solver.physics.elasticity import axial_strain, axial_tangent, moment_of_tension, stretches


@inlined
def beside(a: int, last: int) -> tuple[int, int]:
    """The orientations of the segments beside joint a; at an end, where there is one, that one twice."""
    return max(a, 1), min(a + 1, last)


@inner
def _tangent(R: Array, a: int) -> Any:
    """t of joint a, of the rotations R (N + 2, 3, 3)."""
    one, other = beside(a, len(R) - 2)
    return middle((R[one, 0, 2], R[one, 1, 2], R[one, 2, 2]), (R[other, 0, 2], R[other, 1, 2], R[other, 2, 2]))


@inner
def tension(R: Array, F: Array, a: int) -> float:
    """N of joint a."""
    return float(dot(vector(F, a), _tangent(R, a)))


@kernel
def pull_joints(chain: Chain, R: Array, F: Array, bend: Array, moment: Array, left: Array, right: Array) -> None:
    """Add what the tension adds to q to what `bend_joints` wrote of it."""
    if not stretches(chain.elastic):
        return
    for a in range(len(bend)):
        add_moment(moment_of_tension(chain.elastic, a, tension(R, F, a)), a, bend, moment, left, right)


@kernel
def measure_openings(chain: Chain, R: Array, F: Array, bend: Array, e: Array) -> None:
    """Write by how much (m) each joint opens (N + 1,), of what `bend_joints` wrote of its rotation."""
    for a in range(len(e)):
        kappa = times(1.0 / chain.span[a], vector(bend, a))
        e[a] = chain.span[a] * axial_strain(chain.elastic, a, kappa, tension(R, F, a))


@inner
def open_joints(chain: Chain, state: State, stages: Stages, inverse: Array, dt: float) -> None:
    """Write the openings of all stages and their rates, as those of `base`, and shift the segments accordingly."""
    opening = stages.opening
    for i in range(STAGES):
        bend_joints(chain, stages.quaternion[i], stages.bend[i], stages.moment[i], stages.left[i], stages.right[i])
        measure_openings(chain, stages.R[i], stages.F[i], stages.bend[i], opening[i, 0])
    for rate in range(2):
        for i in range(STAGES):
            for a in range(opening.shape[2]):
                opening[i, rate + 1, a] = rate_at(i, opening[:, rate, a], state.opening[rate, a], inverse, dt)
    for i in range(STAGES):
        shift_segments(stages.R[i], stages.omega[i], stages.alpha[i], opening[i], stages.r[i], stages.V[i], stages.A[i])


@kernel
def shift_segments(R: Array, omega: Array, alpha: Array, opening: Array, r: Array, V: Array, A: Array) -> None:
    """Add to the motion of the segments' centres that of the joints before them: e t and its rates."""
    last = len(r)
    shift, speed, growth = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    for j in range(last):
        e, e_t, e_tt = opening[0, j], opening[1, j], opening[2, j]
        one, other = beside(j, last)
        Q, P = matrix(R, one), matrix(R, other)
        w, u = vector(omega, one), vector(omega, other)
        t, t_t = _tangent(R, j), middle(tangent_rate(Q, w), tangent_rate(P, u))
        t_tt = middle(tangent_acceleration(Q, w, vector(alpha, one)), tangent_acceleration(P, u, vector(alpha, other)))
        shift = plus(shift, times(e, t))
        speed = plus(speed, plus(times(e_t, t), times(e, t_t)))
        growth = plus(growth, plus(times(e_tt, t), plus(times(2.0 * e_t, t_t), times(e, t_tt))))
        add_vector(1.0, shift, r[j])
        add_vector(1.0, speed, V[j])
        add_vector(1.0, growth, A[j])


@inner
def shift_nodes(chain: Chain, R: Array, omega: Array, opening: Array, r: Array, V: Array) -> None:
    """Add to places and velocities of the nodes (N + 1, 3), those of the ends of the segments before them, the way to
    the middle of the opening, or to the end of the rod."""
    if not stretches(chain.elastic):
        return
    last = len(r) - 1
    for a in range(1, last + 1):
        part = share(a, last)
        one, other = beside(a, last)
        t_t = middle(tangent_rate(matrix(R, one), vector(omega, one)),
                     tangent_rate(matrix(R, other), vector(omega, other)))  # fmt: skip
        add_vector(part * opening[0, a], _tangent(R, a), r[a])
        add_vector(part * opening[1, a], _tangent(R, a), V[a])
        add_vector(part * opening[0, a], t_t, V[a])


@kernel
def add_levers(R: Array, F: Array, e: Array, rotation: Array) -> None:
    """Add to the residuals of rotation (N + 2, 3) what the forces do by the openings (N + 1,)."""
    last = len(e) - 1
    for a in range(last + 1):
        one, other = beside(a, last)
        for side in range(2):
            o = one if side == 0 else other
            f = in_material(matrix(R, o), vector(F, a))
            rotation[o, 0] += 0.5 * e[a] * f[1]
            rotation[o, 1] -= 0.5 * e[a] * f[0]


@inner
def opening_tangents(chain: Chain, stages: Stages, i: int, stiff: Array, before: Array, behind: Array,
                     opens: Array) -> None:  # fmt: skip
    """Write `opens` at stage i, and add to the tangents of rotation by rotation: see `balances.Tangents`.

    With n = dN / d psi and u = -span d eps / d psi of the curvature, both of the neighbour on one side, and
    c = span d eps / dN: de / d psi = c n + u, and the neighbours' moments, -e n - B q of the left one and -e n + B^t q
    of the right one, change by -(c n n' + n u' + u n') psi' besides what changes with e and q as they are.
    """
    R, F, last = stages.R[i], stages.F[i], len(chain.mass)
    for a in range(last + 1):
        by_N, by_tension = axial_tangent(chain.elastic, a)
        c, e, t = chain.span[a] * by_N, stages.opening[i, 0, a], _tangent(R, a)
        on_left, on_right = on_neighbours(vector(stages.bend[i], a), by_tension)
        part = share(a, last)
        left, right = 0.0 if a == 0 else part, 0.0 if a == last else part
        f, g = in_material(matrix(R, a), vector(F, a)), in_material(matrix(R, a + 1), vector(F, a))
        n, m = (-left * f[1], left * f[0], 0.0), (-right * g[1], right * g[0], 0.0)
        u, v = on_left, times(-1.0, on_right)
        add_matrix(-e * left, lever_turned(f), stiff[a])
        add_matrix(-e * right, lever_turned(g), stiff[a + 1])
        _add_pair(c, n, u, n, u, stiff[a])
        _add_pair(c, n, u, m, v, behind[a])
        _add_pair(c, m, v, n, u, before[a + 1])
        _add_pair(c, m, v, m, v, stiff[a + 1])
        opens[a] = 0.0
        for k in range(3):
            opens[a, 0, k, 0] = -e * left * R[a, k, 1]
            opens[a, 0, k, 1] = e * left * R[a, k, 0]
            opens[a, 1, k, 0] = -e * right * R[a + 1, k, 1]
            opens[a, 1, k, 1] = e * right * R[a + 1, k, 0]
        add_matrix(1.0, outer(t, plus(times(c, n), u)), opens[a, 0])
        add_matrix(1.0, outer(t, plus(times(c, m), v)), opens[a, 1])
        add_matrix(c, outer(t, t), opens[a, 2])


@inner
def _add_pair(c: float, n: Any, u: Any, m: Any, v: Any, out: Array) -> None:
    """Subtract c n m^t + n v^t + u m^t from `out` (3, 3)."""
    add_matrix(-1.0, outer(n, plus(times(c, m), v)), out)
    add_matrix(-1.0, outer(u, m), out)
