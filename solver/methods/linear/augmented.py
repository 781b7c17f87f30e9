"""Generalized-alpha in space with rho_inf < 1: the system that carries the auxiliary derivatives A along s.

Per interval the twelve balances with their term h b A_j, and the twelve formulas
h ((1 - gamma) A_j + gamma A_{j+1}) - Delta Z = 0; at s = 0 the six conditions and A_0 + G_0 = 0. A is scaled with the
rows, A = x / (rows h). This is an option for comparison: it costs several times the box scheme.
"""

from __future__ import annotations

from solver.arrays import Array
from solver.kernels.kernel import kernel
from solver.kernels.scratch import scratch
from solver.methods.space.box.fields import OMEGA, F, Linear, Nodes, V
from solver.methods.space.box.intervals import interval_panel, interval_residuals
from solver.methods.space.box.schemes import AT_LEFT_NODE, MINUS_DIFFERENCE
from solver.physics.section import Section


@kernel
def wide_residuals(Y: Array, past: Array, c0: float, h: float, nodes: Nodes, system: Linear) -> None:
    """Write the residuals of the wide system; those of the box part, `system.b`, are complete but for A."""
    wide, rows, gamma = system.wide, system.rows, system.space.gamma
    nothing, at_start = scratch((1, 3)), scratch((1, 12))
    interval_residuals(Y, past, c0, h, AT_LEFT_NODE, nodes, nothing, rows, at_start)
    wide.b_start[:6] = system.b_start
    for k in range(12):
        wide.b_start[6 + k] = at_start[0, k] + rows[k] * h * wide.A[0, k]
    for j in range(len(wide.b)):
        for k in range(12):
            if k < 3:
                change = Y[j + 1, OMEGA + k] - Y[j, OMEGA + k]
            elif k < 6:
                change = Y[j + 1, V + k - 3] - Y[j, V + k - 3]
            elif k < 9:
                change = Y[j + 1, F + k - 6] - Y[j, F + k - 6]
            else:
                change = nodes.q[j + 1, k - 9] - nodes.q[j, k - 9]
            wide.b[j, k] = system.b[j, k] + rows[k] * h * system.space.b * wide.A[j, k]
            carried = h * ((1.0 - gamma) * wide.A[j, k] + gamma * wide.A[j + 1, k])
            wide.b[j, 12 + k] = rows[k] * (carried - change)


@kernel
def wide_panel(j: int, Y: Array, c0: float, h: float, nodes: Nodes, section: Section, system: Linear, mean: Array,
               W: Array) -> None:  # fmt: skip
    """Write the tangents of interval j into rows 18 to 41 of W (42, 48)."""
    interval_panel(j, Y, c0, h, system.space, nodes, section, system.rows, system.columns, mean, W, 18)
    interval_panel(j, Y, c0, h, MINUS_DIFFERENCE, nodes, section, system.rows, system.columns, mean, W, 30)
    for k in range(12):
        W[18 + k, 12 + k] = system.space.b
        W[30 + k, 12 + k] = 1.0 - system.space.gamma
        W[30 + k, 36 + k] = system.space.gamma


@kernel
def wide_start(Y: Array, c0: float, h: float, nodes: Nodes, section: Section, system: Linear, mean: Array,
               W: Array) -> None:  # fmt: skip
    """Write the 18 conditions at s = 0 into the first rows of W (42, 48)."""
    interval_panel(0, Y, c0, h, AT_LEFT_NODE, nodes, section, system.rows, system.columns, mean, W, 6)
    W[:6, :] = 0.0
    W[:6, :12] = system.start
    for k in range(12):
        W[6 + k, 12 + k] = 1.0


@kernel
def take_auxiliary(fraction: float, h: float, system: Linear) -> None:
    """Subtract the increments of A in the wide solution."""
    for j in range(len(system.wide.A)):
        for k in range(12):
            system.wide.A[j, k] -= fraction * system.wide.x[j, 12 + k] / (system.rows[k] * h)
