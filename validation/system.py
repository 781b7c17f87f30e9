"""The linear systems of both methods, taken out of a step.

The one place of the validation and the benchmarks that knows the solver's inner signatures. Records go to kernels as
those of a step get them, by reference.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse import coo_array, csr_array

from solver.arrays import Array
from solver.kernels.handed import Reference
from solver.kernels.kernel import kernel
from solver.methods.box import BoxMethod
from solver.methods.linear.segments_increments import update
from solver.methods.linear.shooting import Shooting
from solver.methods.linear.stages import solve_stages
from solver.methods.linear.system import LinearSolver, factor, solve
from solver.methods.schemes import Scheme, c0_of
from solver.methods.space.box.fields import State
from solver.methods.space.box.intervals import MEANS, interval_panel
from solver.methods.space.box.schemes import BOX
from solver.methods.space.segments.motion import move, spin_steadily
from solver.methods.space.segments.stages import evaluate
from solver.methods.space.stages import Record
from solver.methods.staggered import StaggeredMethod
from solver.methods.status import CONVERGED
from solver.methods.time.generalized_alpha.history import history
from solver.methods.time.generalized_alpha.newton import EndValues, balance_nodes, form_residuals, set_scales
from solver.methods.time.radau.method import SCHEME
from solver.methods.time.radau.newton import factor_both, transform_residuals


class NewtonSystem:
    """The system of the first Newton iteration of a step of `dt` from a method's state, in the solver's own scaling."""

    def __init__(self, method: BoxMethod, dt: float, rho_inf: float = 0.5) -> None:
        self._method, self._dt = method, dt
        self._scheme = Scheme.of(rho_inf)
        self._c0 = c0_of(self._scheme, dt)
        self._ends = method._ends(0.0, dt, True)
        self._shooting = Shooting.empty(len(method.s) - 1)
        method.trial.Y[:] = method.state.Y
        history(method.state, self._scheme, dt, method.work.past)
        method.work.feedback[:] = 0.0
        set_scales(method._scales, self._c0, method.work.system)
        method.contact.prepare(method._bending, method.state.r, method.state.Y, dt)
        self._handed = Reference.to(method._records)

    def assemble(self) -> None:
        """Residuals, and what the tangents are made of."""
        method = self._method
        _assemble(self._handed, method.state, method.trial, self._c0, method.h, self._ends)

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
        status = factor(linear, method.trial.Y, work.past, self._c0, method.h, work.nodes, work.system)
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
            interval_panel(j, method.trial.Y, self._c0, method.h, BOX, method.work.nodes, system.rows,
                           system.columns, mean, panel, 6)  # fmt: skip
            put(panel[6:], 6 + 12 * j, 12 * j)
        put(system.end, 6 + 12 * N, 12 * N)
        matrix = coo_array((np.concatenate(values), (np.concatenate(rows), np.concatenate(columns)))).tocsr()
        return matrix, np.concatenate([system.b_start, system.b.ravel(), system.b_end])


@kernel
def _assemble(reference: Reference, old: State, new: State, c0: float, h: float, ends: EndValues) -> None:
    section, loads, work = reference.section, reference.loads, reference.work
    balance_nodes(old, new, work.past, c0, section, loads, work.nodes)
    form_residuals(new, work.past, c0, h, ends, work.nodes, work.feedback, work.system)


class StagesSystem:
    """The system of the stages of a staggered step of `dt` from a method's state, without contact."""

    def __init__(self, method: StaggeredMethod, dt: float) -> None:
        self._method, self._dt = method, dt
        method._drive(0.0, dt)
        method._guess_rest()
        spin_steadily(method.state, SCHEME.nodes, dt, method.stages)
        self._handed = Reference.to(method._records)
        self.move()
        self.evaluate()

    def move(self) -> None:
        """All that follows from the unknown rotations."""
        _move(self._handed, self._method.state, self._dt)

    def evaluate(self) -> None:
        """Moments and residuals."""
        _evaluate(self._handed)

    def factor(self) -> bool:
        """Tangents, and the real and the complex system factored."""
        return bool(_factor(self._handed, self._dt))

    def solve(self) -> None:
        """Both systems solved for the residuals."""
        _solve(self._handed, self._dt)

    def update(self) -> None:
        """A vanishing part of the increments added to the stages, at the cost of all."""
        _update(self._handed)


@kernel
def _move(reference: Reference, state: Record, dt: float) -> None:
    chain, scheme, stages = reference.chain, reference.scheme, reference.stages
    move(chain, state, stages, scheme.nodes, scheme.inverse, dt)


@kernel
def _evaluate(reference: Reference) -> None:
    evaluate(reference.chain, reference.loads, reference.driven, reference.stages, reference.work.residuals)


@kernel
def _factor(reference: Reference, dt: float) -> bool:
    chain, loads, driven, scheme = reference.chain, reference.loads, reference.driven, reference.scheme
    stages, work = reference.stages, reference.work
    return factor_both(chain, loads, driven, scheme, dt, stages, work.tangents, work.real, work.pair)


@kernel
def _solve(reference: Reference, dt: float) -> None:
    chain, driven, scheme, stages = reference.chain, reference.driven, reference.scheme, reference.stages
    work = reference.work
    transform_residuals(driven, scheme, stages, work.tangents, work.residuals, work.transformed)
    solve_stages(chain, driven, work.tangents, scheme.gamma / dt, scheme.pair / dt, work.transformed, work.real,
                 work.pair)  # fmt: skip


@kernel
def _update(reference: Reference) -> None:
    chain, scheme, stages, work = reference.chain, reference.scheme, reference.stages, reference.work
    update(chain, scheme.transform, 1.0, 1e-30, stages, work.tangents, work.real, work.pair)
