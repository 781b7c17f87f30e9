"""A material that resists the rates of bending and twisting: what the joints of a chain do besides.

With the material angular velocities omega of a joint's neighbours, and B of `joints`, Theta changes at the rate
Theta_t = B omega_right - B^t omega_left, so kappa_t = Theta_t / span. The moment D kappa_t acts on the neighbours as q
does, and takes the power span kappa_t . D kappa_t. Nothing here is called where the rod has no viscosity.
"""

from __future__ import annotations

from typing import Any

from solver.arrays import Array
from solver.kernels.kernel import inner, kernel
from solver.kernels.vectors import add_matrix, add_vector, dot, minus, scale, stiffness, times, transform, vector
from solver.methods.space.segments.chain import Chain
from solver.methods.space.segments.joints import add_moment, directions_on, on_neighbours


@inner
def _rate(chain: Chain, omega: Array, bend: Array, a: int) -> Any:
    """kappa_t of joint a."""
    theta = vector(bend, a)
    from_left, from_right = on_neighbours(theta, vector(omega, a)), on_neighbours(theta, vector(omega, a + 1))
    return times(1.0 / chain.span[a], minus(from_right[0], from_left[1]))


@kernel
def resist_rates(chain: Chain, omega: Array, bend: Array, moment: Array, left: Array, right: Array) -> None:
    """Add what the rates of bending and twisting add to q to what `bend_joints` wrote of it."""
    for a in range(len(bend)):
        q = transform(stiffness(chain.elastic.viscosity, a), _rate(chain, omega, bend, a))
        add_moment(q, a, bend, moment, left, right)


@kernel
def resist_at_nodes(chain: Chain, omega: Array, bend: Array, q: Array) -> None:
    """Add what they add to q (N + 1, 3) in the frames of the nodes: see `fields.bending_at_nodes`."""
    last = len(bend) - 1
    for a in range(last + 1):
        resisting = transform(stiffness(chain.elastic.viscosity, a), _rate(chain, omega, bend, a))
        on_left, on_right = on_neighbours(vector(bend, a), resisting)
        add_vector(1.0, on_left if a == 0 else on_right if a == last else resisting, q[a])


@inner
def dissipated(chain: Chain, omega: Array, bend: Array) -> float:
    """The power (W) that the joints take."""
    power = 0.0
    for a in range(len(bend)):
        kappa_t = _rate(chain, omega, bend, a)
        power += chain.span[a] * dot(kappa_t, transform(stiffness(chain.elastic.viscosity, a), kappa_t))
    return power


@inner
def rate_tangents(chain: Chain, bend: Array, stiff: Array, before: Array, behind: Array) -> None:
    """Write the tangents of rotation's balances by the rates of rotation, (N + 2, 3, 3) each: see `balances.Tangents`.

    They leave out how B and Theta_t change with the rotation itself: that is small where joints turn little within the
    retardation time, and else Newton's iteration takes more steps.
    """
    stiff[:], before[:], behind[:] = 0.0, 0.0, 0.0
    for a in range(len(bend)):
        S = scale(1.0 / chain.span[a], stiffness(chain.elastic.viscosity, a))
        B, B_t = directions_on(vector(bend, a))
        add_matrix(1.0, _between(B, S, B_t), stiff[a])
        add_matrix(-1.0, _between(B, S, B), behind[a])
        add_matrix(-1.0, _between(B_t, S, B_t), before[a + 1])
        add_matrix(1.0, _between(B_t, S, B), stiff[a + 1])


@inner
def _between(A: Any, S: Any, C: Any) -> Any:
    """A S C."""
    return _product(A, _product(S, C))


@inner
def _product(A: Any, C: Any) -> Any:
    return _row(A[0], C), _row(A[1], C), _row(A[2], C)


@inner
def _row(a: Any, C: Any) -> Any:
    return (a[0] * C[0][0] + a[1] * C[1][0] + a[2] * C[2][0], a[0] * C[0][1] + a[1] * C[1][1] + a[2] * C[2][1],
            a[0] * C[0][2] + a[1] * C[1][2] + a[2] * C[2][2])  # fmt: skip
