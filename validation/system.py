"""The box method's linear system, taken out of a step before it is factored.

The one place of the validation and the benchmarks that knows the solver's inner signatures.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse import coo_array, csr_array

from solver.methods.box.fields import Linear
from solver.methods.box.generalized_alpha import Scheme, history
from solver.methods.box.intervals import measure_drift
from solver.methods.box.method import BoxMethod
from solver.methods.box.newton import assemble, set_scales
from solver.rod import Array


def assembled(method: BoxMethod, dt: float, rho_inf: float = 0.5) -> Linear:
    """Assemble the system of the first Newton iteration of a step of dt from the method's state at t = 0."""
    scheme, work, gain = Scheme.of(rho_inf), method.work, 0.0
    c0 = scheme.c0(dt)
    method.trial.Y[:] = method.state.Y
    history(method.state, scheme, dt, work.past)
    measure_drift(method.state, method.h, gain, work.drift)
    set_scales(method._scales, c0, work.system)
    method.contact.prepare(method.state)
    assemble(method.state, method.trial, work.past, c0, method.h, method.section, method.loads,
             method._ends(0.0, dt, gain), work.nodes, work.drift, work.system, method.contact.touch)  # fmt: skip
    return work.system


def as_sparse(system: Linear) -> tuple[csr_array, Array]:
    """Matrix and right-hand side of an unfactored system: conditions at s = 0, intervals, conditions at L."""
    N = len(system.panels)
    rows, columns, values = [], [], []

    def put(block: Array, row: int, column: int) -> None:
        i, k = np.indices(block.shape)
        rows.append((row + i).ravel())
        columns.append((column + k).ravel())
        values.append(block.ravel().copy())

    put(system.start, 0, 0)
    for j in range(N):
        put(system.panels[j, 6:], 6 + 12 * j, 12 * j)
    put(system.end, 6 + 12 * N, 12 * N)
    matrix = coo_array((np.concatenate(values), (np.concatenate(rows), np.concatenate(columns)))).tocsr()
    return matrix, np.concatenate([system.b_start, system.b.ravel(), system.b_end])
