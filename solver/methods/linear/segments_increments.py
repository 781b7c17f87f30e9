"""Residuals of segments in space as the right-hand side of Newton's system, and motion from its solution."""

from __future__ import annotations

import numpy as np

from solver.arrays import Array
from solver.kernels.kernel import inner, kernel
from solver.kernels.vectors import in_lab, in_material, matrix, vector, vector_product
from solver.methods.linear.segments import Factors
from solver.methods.space.segments.balances import Driven, Tangents
from solver.methods.space.segments.chain import STAGES, Chain, Stages
from solver.methods.space.segments.joints import share
from solver.physics.elasticity import stretches
from solver.physics.ends import LOAD, RATE, RATE_LAB


@inner
def widths(factors: Factors) -> tuple[int, int]:
    """In space."""
    return 3, 3


@kernel
def complete(chain: Chain, driven: Driven, tangents: Tangents, eigenvalue: complex, factors: Factors) -> None:
    """Write the rows of F into x and condition the ends; rotation, with minus, is there."""
    N = len(chain.mass)
    X, b, load, ends = factors.X, factors.x, factors.load, factors.ends
    for side in range(2):
        frame = 0 if side == 0 else N + 1
        for k in range(3):
            if driven.kinds[side, 3 + k] == RATE:
                b[frame, k] /= eigenvalue
            elif side == 0:
                b[frame, k] = -b[frame, k]
    for k in range(3):
        b[0, 3 + k] = 0.0
        b[N + 1, 3 + k] = 0.0
    for j in range(N):
        for k in range(3):
            moved = X[j + 1, k, 0] * load[j, 0] + X[j + 1, k, 1] * load[j, 1] + X[j + 1, k, 2] * load[j, 2]
            b[j, 3 + k] += moved
            b[j + 1, 3 + k] = -moved
    for side in range(2):
        node, R = (0, tangents.R[0]) if side == 0 else (N, tangents.R[N + 1])
        x, y, z = b[node, 3], b[node, 4], b[node, 5]
        sign = 1.0 if side == 0 else -1.0
        for k in range(3):
            kind = driven.kinds[side, k]
            if kind == RATE:
                b[node, 3 + k] = R[0, k] * x + R[1, k] * y + R[2, k] * z - sign * ends[side, k] / eigenvalue
            elif kind == RATE_LAB:
                b[node, 3 + k] -= sign * ends[side, k] / eigenvalue
            else:
                b[node, 3 + k] = -ends[side, k]
                if driven.mass[side] > 0.0:
                    moved = R[0, k] * x + R[1, k] * y + R[2, k] * z if kind == LOAD else (x, y, z)[k]
                    b[node, 3 + k] -= driven.mass[side] * eigenvalue * eigenvalue * moved


@inner
def displace(factors: Factors) -> None:
    """Write the displacements of the centres that belong to the solution."""
    x = factors.x
    for j in range(len(factors.moved)):
        X, Y, psi, near, far, load = factors.X[j + 1], factors.Y[j + 1], x[j + 1], x[j], x[j + 1], factors.load[j]
        u, v, w = far[3] - near[3] - load[0], far[4] - near[4] - load[1], far[5] - near[5] - load[2]
        for k in range(3):
            factors.moved[j, k] = (X[k, 0] * u + X[k, 1] * v + X[k, 2] * w
                                   + (Y[k, 0] * psi[0] + Y[k, 1] * psi[1] + Y[k, 2] * psi[2]))  # fmt: skip


@inner
def _opened(tangents: Tangents, factors: Factors, a: int, k: int) -> complex:
    """Component k of delta (e t) of joint a in the solution."""
    opens, x, y = tangents.opens[a], factors.x[a], factors.x[a + 1]
    moved: complex = 0.0 * x[0]
    for m in range(3):
        moved += opens[0, k, m] * x[m] + opens[1, k, m] * y[m] + opens[2, k, m] * x[3 + m]
    return moved


@inner
def node_moves(chain: Chain, tangents: Tangents, factors: Factors, node: int, k: int) -> complex:
    """Component k of a node's displacement in the solution."""
    j, side = (node - 1, 1.0) if node > 0 else (0, -1.0)
    R, x = tangents.R[j + 1], factors.x[j + 1]
    moved: complex = factors.moved[j, k] + side * 0.5 * chain.h * (R[k, 0] * x[1] - R[k, 1] * x[0])
    if stretches(chain.elastic):
        moved += side * share(node, len(chain.mass)) * _opened(tangents, factors, node, k)
    return moved


@kernel
def update(chain: Chain, transform: Array, unit: float, fraction: float, stages: Stages, tangents: Tangents,
           real: Factors, pair: Factors) -> tuple[float, float, float]:  # fmt: skip
    """Add a fraction of the increments to the stages; return their size: rotation (rad), force by the largest one, and
    displacement of the start (m)."""
    T = transform
    turned, forced, shifted, largest = 0.0, 0.0, 0.0, unit
    for i in range(STAGES):
        t0, t1, t2 = fraction * T[i, 0], fraction * T[i, 1], fraction * T[i, 2]
        for a in range(stages.theta.shape[1]):
            x, z = real.x[a], pair.x[a]
            c0 = t0 * x[0] + t1 * z[0].real + t2 * z[0].imag
            c1 = t0 * x[1] + t1 * z[1].real + t2 * z[1].imag
            c2 = t0 * x[2] + t1 * z[2].real + t2 * z[2].imag
            cosine, sine = tangents.spun[i, a, 0], tangents.spun[i, a, 1]
            c0, c1 = cosine * c0 + sine * c1, cosine * c1 - sine * c0
            p = in_material(matrix(stages.start, a), in_lab(matrix(stages.R[i], a), (c0, c1, c2)))
            # a rotation by p in the frame of R_n changes theta by p - theta x p / 2 + ...
            theta = vector(stages.theta[i], a)
            once = vector_product(theta, p)
            twice = vector_product(theta, once)
            for k in range(3):
                stages.theta[i, a, k] += p[k] - 0.5 * once[k] + (1 / 12) * twice[k]
            turned = max(turned, abs(p[0]), abs(p[1]), abs(p[2]))
            if not np.isfinite(p[0]):
                return np.inf, np.inf, np.inf
        for a in range(stages.F.shape[1]):
            for k in range(3):
                change = t0 * real.x[a, 3 + k] + t1 * pair.x[a, 3 + k].real + t2 * pair.x[a, 3 + k].imag
                stages.F[i, a, k] += change
                forced = max(forced, abs(change))
                largest = max(largest, abs(stages.F[i, a, k]))
        for k in range(3):
            z0 = node_moves(chain, tangents, pair, 0, k)
            moved = t0 * node_moves(chain, tangents, real, 0, k).real + t1 * z0.real + t2 * z0.imag
            stages.shift[i, k] += moved
            shifted = max(shifted, abs(moved))
    return turned / fraction, forced / (fraction * largest), shifted / fraction
