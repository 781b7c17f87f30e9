"""The linear systems of both methods, taken out of a step.

The one place of the validation and the benchmarks that knows the solver's inner signatures.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse import coo_array, csr_array

from solver.arrays import Array
from solver.methods.box import BoxMethod
from solver.methods.linear.shooting import Shooting
from solver.methods.linear.stages import solve_stages
from solver.methods.linear.system import LinearSolver, factor, solve
from solver.methods.linear.tridiagonal import update
from solver.methods.schemes import Scheme, c0_of
from solver.methods.space.box.intervals import MEANS, interval_panel
from solver.methods.space.box.schemes import BOX
from solver.methods.space.segments.motion import move, spin_steadily
from solver.methods.space.segments.stages import evaluate
from solver.methods.staggered import StaggeredMethod
from solver.methods.status import CONVERGED
from solver.methods.time.generalized_alpha.history import history
from solver.methods.time.generalized_alpha.newton import balance_nodes, form_residuals, set_scales
from solver.methods.time.radau.method import SCHEME
from solver.methods.time.radau.newton import factor_both, transform_residuals


class NewtonSystem:
    """The system of the first Newton iteration of a step of `dt` from a method's state, in the solver's own scaling."""

    def __init__(self, method: BoxMethod, dt: float, rho_inf: float = 0.5) -> None:
        self._method, self._dt = method, dt
        self._scheme = Scheme.of(rho_inf)
        self._c0 = c0_of(self._scheme, dt)
        self._ends = method._ends(0.0, dt)
        self._shooting = Shooting.empty(len(method.s) - 1)
        method.trial.Y[:] = method.state.Y
        history(method.state, self._scheme, dt, method.work.past)
        method.work.feedback[:] = 0.0
        set_scales(method._scales, self._c0, method.work.system)
        method.contact.prepare(method._bending, method.state.r, method.state.Y, dt)

    def assemble(self) -> None:
        """Residuals, and what the tangents are made of."""
        method, work = self._method, self._method.work
        balance_nodes(method.state, method.trial, work.past, self._c0, method.section, method.applied.records,
                      work.nodes)  # fmt: skip
        form_residuals(method.trial, work.past, self._c0, method.h, method.section, self._ends, work.nodes,
                       work.feedback, work.system)  # fmt: skip

    def factor(self) -> bool:
        """Form the panels and factor them by the method's linear solver, block elimination by default."""
        return self._factor(self._method.work.linear)

    def solve(self) -> Array:
        """The solution (12 n,) with the factors."""
        return self._solve(self._method.work.linear)

    def shoot(self) -> tuple[Array, float]:
        """Shooting: the solution (12 n,) and the growth of the homogeneous solutions."""
        self._factor(self._shooting)
        return self._solve(self._shooting), float(self._shooting.growth[0])

    def _factor(self, linear: LinearSolver) -> bool:
        method, work = self._method, self._method.work
        status = factor(linear, method.trial.Y, work.past, self._c0, method.h, work.nodes, method.section, work.system)
        return bool(status == CONVERGED)

    def _solve(self, linear: LinearSolver) -> Array:
        system = self._method.work.system
        solve(linear, system, 1.0, system.b, system.x)
        return system.x.ravel().copy()

    def as_sparse(self) -> tuple[csr_array, Array]:
        """Matrix and right-hand side: conditions at s = 0, intervals, conditions at L."""
        method, system = self._method, self._method.work.system
        N = len(method.s) - 1
        rows, columns, values = [], [], []

        def put(block: Array, row: int, column: int) -> None:
            i, k = np.indices(block.shape)
            rows.append((row + i).ravel())
            columns.append((column + k).ravel())
            values.append(block.ravel().copy())

        put(system.start, 0, 0)
        panel, mean = np.zeros((18, 24)), np.zeros((MEANS, 3))
        for j in range(N):
            interval_panel(j, method.trial.Y, self._c0, method.h, BOX, method.work.nodes, method.section, system.rows,
                           system.columns, mean, panel, 6)  # fmt: skip
            put(panel[6:], 6 + 12 * j, 12 * j)
        put(system.end, 6 + 12 * N, 12 * N)
        matrix = coo_array((np.concatenate(values), (np.concatenate(rows), np.concatenate(columns)))).tocsr()
        return matrix, np.concatenate([system.b_start, system.b.ravel(), system.b_end])


class StagesSystem:
    """The system of the stages of a staggered step of `dt` from a method's state, without contact."""

    def __init__(self, method: StaggeredMethod, dt: float) -> None:
        self._method, self._dt = method, dt
        method._drive(0.0, dt)
        method._guess_rest()
        spin_steadily(method.state, SCHEME.nodes, dt, method.stages)
        self.move()
        self.evaluate()

    def move(self) -> None:
        """All that follows from the unknown rotations."""
        method = self._method
        move(method.chain, method.state, method.stages, SCHEME.nodes, SCHEME.inverse, self._dt)

    def evaluate(self) -> None:
        """Moments and residuals."""
        method = self._method
        evaluate(method.chain, method.applied.records, method.driven, method.stages, method.work.residuals)

    def factor(self) -> bool:
        """Tangents, and the real and the complex system factored."""
        method, work = self._method, self._method.work
        return bool(factor_both(method.chain, method.applied.records, method.driven, SCHEME, self._dt, method.stages,
                                work.tangents, work.real, work.pair))  # fmt: skip

    def solve(self) -> None:
        """Both systems solved for the residuals."""
        method, work = self._method, self._method.work
        transform_residuals(method.driven, SCHEME, method.stages, work.tangents, work.residuals,
                            work.transformed)  # fmt: skip
        solve_stages(method.chain, method.driven, work.tangents, SCHEME.gamma / self._dt, SCHEME.pair / self._dt,
                     work.transformed, work.real, work.pair)  # fmt: skip

    def update(self) -> None:
        """A vanishing part of the increments added to the stages, at the cost of all."""
        method, work = self._method, self._method.work
        update(method.chain, SCHEME.transform, 1.0, 1e-30, method.stages, work.tangents, work.real, work.pair)
