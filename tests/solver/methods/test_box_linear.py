"""The linear solves: block elimination, shooting, and conjugate residuals on the contact forces."""

from __future__ import annotations

import numpy as np
import pytest

from solver import Contact
from solver.arrays import Array
from solver.methods.linear.banded import Banded
from solver.methods.linear.box_contact import solve_with_contact
from solver.methods.linear.registry import LINEAR_SOLVERS
from solver.methods.linear.shooting import LARGEST_GROWTH, Shooting
from solver.methods.linear.system import LinearSolver
from solver.methods.status import CONVERGED, LOST_DIGITS, SINGULAR
from tests.solver.methods.as_in_runs import call, factor, solve
from tests.solver.methods.problem import Problem, problem


def factored(case: Problem, linear: LinearSolver) -> int:
    """How factoring the assembled system ended."""
    work = case.work
    return int(call(factor, linear, case.new.Y, work.past, case.c0, case.h, work.nodes, work.system))


def eliminate(case: Problem, linear: LinearSolver | None = None) -> Array:
    """The increment by block elimination, or another linear solver."""
    case.residual()
    system, linear = case.work.system, linear or case.work.linear
    assert factored(case, linear) == CONVERGED
    call(solve, linear, system, 1.0, system.b, system.x)
    return system.x.copy()


def banded_error(case: Problem, x: Array) -> float:
    """Normwise backward error |A x - b| / (|A| |x| + |b|), from the dense matrix."""
    A, b, flat = case.matrix(), case.residual(), x.ravel()
    return float(np.abs(A @ flat - b).max() / (np.abs(A).sum(axis=1).max() * np.abs(flat).max() + np.abs(b).max()))


@pytest.mark.parametrize("diameter", [0.0005, 0.002, 0.01])
@pytest.mark.parametrize("dt", [1e-4, 1e-2, 1e-1])
def test_block_elimination_is_backward_stable(diameter: float, dt: float) -> None:
    case = problem(60, diameter=diameter, dt=dt, damping=0.5)
    assert banded_error(case, eliminate(case)) <= 1e-14


@pytest.mark.parametrize("diameter", [0.0005, 0.002, 0.01])
@pytest.mark.parametrize("dt", [1e-4, 1e-2, 1e-1])
def test_elimination_within_the_band_is_backward_stable(diameter: float, dt: float) -> None:
    case = problem(60, diameter=diameter, dt=dt, damping=0.5)
    assert banded_error(case, eliminate(case, Banded.empty(60))) <= 1e-14


def test_generalized_alpha_in_space_is_solved_by_the_same_elimination() -> None:
    case = problem(20, rho_inf_space=0.5)
    x = eliminate(case)
    expected = np.linalg.solve(case.matrix(), case.residual()).reshape(-1, 24)[:, :12]
    assert x == pytest.approx(expected, rel=1e-7, abs=1e-9 * np.abs(expected).max())


@pytest.mark.parametrize(("diameter", "dt"), [(0.01, 0.1), (0.01, 0.01), (0.002, 0.1), (0.002, 0.02)])
def test_shooting_agrees_with_elimination_while_little_is_lost(diameter: float, dt: float) -> None:
    case = problem(60, diameter=diameter, dt=dt)
    x = eliminate(case)
    case.residual()
    shooting, shot, system = Shooting.empty(60), np.zeros_like(x), case.work.system
    assert factored(case, shooting) == CONVERGED
    call(solve, shooting, system, 1.0, system.b, shot)
    growth = float(shooting.growth[0])
    assert growth < 1e8
    # both err by rounding times the condition of the system; shooting by its growth besides
    bound = max(growth, np.linalg.cond(case.matrix())) * np.finfo(float).eps
    assert np.abs(shot - x).max() <= bound * np.abs(x).max()


def test_shooting_tells_how_much_it_has_lost() -> None:
    case = problem(60, diameter=0.0005, dt=1e-4)
    case.residual()
    shooting = Shooting.empty(60)
    assert factored(case, shooting) == LOST_DIGITS
    assert shooting.growth[0] > LARGEST_GROWTH


@pytest.mark.parametrize("solver", ["block_elimination", "banded"])
def test_the_solve_with_contact_solves_the_whole_system(solver: str) -> None:
    contact = Contact(k1=1e-7, k2=3.0, k3=0.0, k4=1.0, aperture=np.radians(100), cutoff=0.013, skip=0.06,
                      spacing=0.004)  # fmt: skip
    case = problem(24, contact=contact)
    expected = np.linalg.solve(case.matrix(), case.residual()).reshape(-1, 12)
    work, linear = case.work, LINEAR_SOLVERS[solver].empty(24)
    eliminate(case, linear)
    iterations = call(solve_with_contact, linear, case.c0, case.h, work.system, case.contact.touch, work.coupling)
    # the solve stops at a relative residual of 1e-6 in the contact forces
    assert np.abs(case.work.system.x - expected).max() <= 1e-4 * np.abs(expected).max()
    assert 0 < iterations <= 40


def test_a_system_that_leaves_a_motion_free_is_found_singular() -> None:
    nothing_held = np.ones(6, np.int64)
    case = problem(10, kinds=(nothing_held, nothing_held))
    case.residual()
    case.work.system.start[:, :] = 0.0
    assert factored(case, case.work.linear) == SINGULAR
