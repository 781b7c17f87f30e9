"""Which linear solvers of the box method there are, and which one a scene asks for."""

from __future__ import annotations

from solver.methods.linear.augmented import Augmented
from solver.methods.linear.banded import Banded
from solver.methods.linear.elimination import Elimination
from solver.methods.linear.shooting import Shooting
from solver.methods.linear.system import LinearSolver
from solver.scene.numerics import Numerics

LINEAR_SOLVERS: dict[str, type[LinearSolver]] = {
    "block_elimination": Elimination,
    "shooting": Shooting,
    "banded": Banded,
}


def linear_solver_of(numerics: Numerics) -> LinearSolver:
    """The linear solver that a scene asks for; with auxiliary derivatives along s, the one that carries them.

    Raises ValueError where there is none of that name.
    """
    if numerics.linear_solver not in LINEAR_SOLVERS:
        raise ValueError(f"linear_solver must be one of {', '.join(LINEAR_SOLVERS)}, got {numerics.linear_solver}")
    kind = Augmented if numerics.rho_inf_space < 1.0 else LINEAR_SOLVERS[numerics.linear_solver]
    return kind.empty(numerics.intervals)
