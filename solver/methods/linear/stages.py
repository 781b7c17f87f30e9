"""The linear systems of a step's three stages, one real and one complex, and what they ask of a solver.

A system's `Factors` hold its right-hand side and solution `x`, first a row's rotation; `load` and `ends`, residuals of
translation and of the ends' conditions; `moved`, displacements of the segments' centres.
"""

from __future__ import annotations

from typing import NamedTuple

from solver.arrays import Array
from solver.kernels.copying import copy
from solver.kernels.dispatch import dispatched
from solver.kernels.kernel import inner
from solver.methods.space.segments.chain import STAGES
from solver.methods.space.stages import Record


class Scheme(NamedTuple):
    """Coefficients of a scheme of three stages: `nodes` c, `inverse` A^-1 = T diag(gamma, lambda) T^-1 with T
    `transform` and T^-1 `back`, `gamma` and lambda `pair`, and the weights `error` of the embedded estimate.

    And the coefficients of 1, x and x^2 (row) by the values at the stages (column): of the `parabola` through them, and
    of `cubic` / x, which goes through (0, 0) and them.
    """

    nodes: Array
    inverse: Array
    transform: Array
    back: Array
    gamma: float
    pair: complex
    error: Array
    cubic: Array
    parabola: Array


@dispatched
def factor(chain: Record, driven: Record, tangents: Record, eigenvalue: complex, factors: Record) -> bool:
    """Factor the system for one eigenvalue of the time scheme, real or complex; False if it is singular."""
    raise NotImplementedError


@dispatched
def complete(chain: Record, driven: Record, tangents: Record, eigenvalue: complex, factors: Record) -> None:
    """Complete the right-hand side `x`, in which only rotation stands, with minus, by `load` and `ends`."""
    raise NotImplementedError


@dispatched
def solve(factors: Record) -> None:
    """From the right-hand side to the solution, and `moved`."""
    raise NotImplementedError


@dispatched
def solve_with_contact(chain: Record, driven: Record, tangents: Record, transform: Array, gamma: float, lam: complex,
                       residuals: Record, real: Record, pair: Record, touch: Record, coupling: Record,
                       first: bool, fresh: bool) -> float:  # fmt: skip
    """As `solve_stages`, with the tangents of contact; return the part of the increments that may be taken."""
    raise NotImplementedError


@dispatched
def update(chain: Record, transform: Array, unit: float, fraction: float, stages: Record, tangents: Record,
           real: Record, pair: Record) -> tuple[float, float, float]:  # fmt: skip
    """Add a fraction of the increments to the stages; return their size: rotation (rad), force by the largest one, and
    displacement of the start (m)."""
    raise NotImplementedError


@dispatched
def widths(factors: Record) -> tuple[int, int]:
    """How many numbers stand for the rotation of a row, and for the displacement of a segment or an end."""
    raise NotImplementedError


@inner
def solve_stages(chain: Record, driven: Record, tangents: Record, gamma: float, pair: complex, rows: Record,
                 real_factors: Record, pair_factors: Record) -> None:  # fmt: skip
    """Solve both systems for the transformed residuals `rows`."""
    load_real(rows, real_factors)
    solve_loaded(chain, driven, tangents, gamma, real_factors)
    load_pair(rows, pair_factors)
    solve_loaded(chain, driven, tangents, pair, pair_factors)


@inner
def solve_loaded(chain: Record, driven: Record, tangents: Record, eigenvalue: complex, factors: Record) -> None:
    """Solve one system for what is loaded as its right-hand side."""
    complete(chain, driven, tangents, eigenvalue, factors)
    solve(factors)


@inner
def clear(factors: Record) -> None:
    """No right-hand side."""
    factors.x[:] = 0.0
    factors.load[:] = 0.0
    factors.ends[:] = 0.0


@inner
def load_real(rows: Record, factors: Record) -> None:
    """The first of the transformed residuals as a right-hand side."""
    n, (turned, _) = len(factors.x), widths(factors)
    rotation = rows.rotation.reshape(STAGES, n, turned)
    for a in range(n):
        for k in range(turned):
            factors.x[a, k] = -rotation[0, a, k]
    copy(rows.translation[0], factors.load)
    copy(rows.ends[0], factors.ends)


@inner
def load_pair(rows: Record, factors: Record) -> None:
    """The second and third of the transformed residuals as the right-hand side of the complex system."""
    n, load, ends, (turned, moved) = len(factors.x), factors.load, factors.ends, widths(factors)
    rotation = rows.rotation.reshape(STAGES, n, turned)
    for a in range(n):
        for k in range(turned):
            factors.x[a, k] = complex(-rotation[1, a, k], -rotation[2, a, k])
    for j in range(len(load)):
        for k in range(moved):
            load[j, k] = complex(rows.translation[1, j, k], rows.translation[2, j, k])
    for side in range(2):
        for k in range(moved):
            ends[side, k] = complex(rows.ends[1, side, k], rows.ends[2, side, k])
