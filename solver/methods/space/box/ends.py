"""The six conditions at an end: residuals and tangents by the unknowns of the end's node."""

from __future__ import annotations

from solver.arrays import Array
from solver.kernels.kernel import inner
from solver.methods.space.box.fields import KAPPA, OMEGA, F, Nodes, V
from solver.physics.ends import LOAD, RATE, RATE_LAB, Kinds


@inner
def end_conditions(Y: Array, node: int, kinds: Kinds, targets: Array, dead: Array, rows: Array, columns: Array,
                   nodes: Nodes, b: Array, A: Array) -> None:  # fmt: skip
    """Write residuals `b` (6,) and tangents `A` (6, 12) of the conditions `kinds` (6,) with values `targets` (6,).

    `dead` (6,): lab force and moment that add to f and q where these are what is given. `rows` (12,) and
    `columns` (12,) are the system's scales.
    """
    A[:, :] = 0.0
    for i in range(3):
        held = kinds[i] == RATE or kinds[i] == RATE_LAB
        first = V if held else F
        if kinds[i] == RATE or kinds[i] == LOAD:
            b[i] = -targets[i]
            for k in range(3):
                vector = Y[node, first + k]
                if not held:
                    vector -= dead[k]
                b[i] += nodes.R[node, k, i] * vector
                A[i, first + k] = nodes.R[node, k, i]
                _turn_axis(nodes.R[node], nodes.J[node], i, k, vector, A[i])
        else:
            b[i] = Y[node, first + i] - targets[i] - (0.0 if held else dead[i])
            A[i, first + i] = 1.0
        _scale(i, rows[3] if held else rows[6], columns, b, A)
        row = 3 + i
        if kinds[row] == RATE:
            b[row] = Y[node, OMEGA + i] - targets[row]
            A[row, OMEGA + i] = 1.0
        else:
            b[row] = nodes.q[node, i] - targets[row]
            for k in range(3):
                A[row, KAPPA + k] = nodes.K[node, i, k]
                b[row] -= nodes.R[node, k, i] * dead[3 + k]
                _turn_axis(nodes.R[node], nodes.J[node], i, k, -dead[3 + k], A[row])
        _scale(row, rows[0] if kinds[row] == RATE else rows[9], columns, b, A)


@inner
def _turn_axis(R: Array, J: Array, i: int, k: int, component: float, row: Array) -> None:
    """Add component * d(R[k, i])/d omega: d(R e_i) = R (dpsi x e_i) = R[:, a] dpsi_c - R[:, c] dpsi_a."""
    a, c = (i + 1) % 3, (i + 2) % 3
    for m in range(3):
        row[OMEGA + m] += component * (R[k, a] * J[c, m] - R[k, c] * J[a, m])


@inner
def _scale(row: int, scale: float, columns: Array, b: Array, A: Array) -> None:
    b[row] *= scale
    for k in range(12):
        A[row, k] *= scale * columns[k]
