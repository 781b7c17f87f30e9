"""Energies of the chain that turns about one axis, and what flows in and out within a step."""

from __future__ import annotations

import numpy as np

from solver.arrays import Array
from solver.kernels.handed import Reference
from solver.kernels.kernel import kernel
from solver.measures.energies import Energies
from solver.methods.space.one_axis.axis import Plane, directions
from solver.methods.space.one_axis.balances import across, along, end_velocity
from solver.methods.space.one_axis.chain import Chain
from solver.methods.space.segments.chain import STAGES
from solver.physics.loads.applied import Loads


def energies(chain: Chain, loads: Loads, current: complex, weight: Plane, phi: Array, omega: Array,
             centres: Plane) -> Energies:  # fmt: skip
    """The energies at a state: angles (N + 2,); segments' `omega` and `weight` (N,); `centres` (2, N), position and
    velocity."""
    strain = np.diff(phi) / chain.span - chain.kappa0
    elastic = float(0.5 * np.sum(chain.span * chain.stiffness * strain**2))
    kinetic = np.sum(chain.mass * (centres[1].real ** 2 + centres[1].imag ** 2)) + np.sum(chain.dry_inertia * omega**2)
    aside = ((centres[1] - current) * directions(-chain.swing * phi[1:-1])).imag
    added = np.sum(loads.added_mass * aside**2) + np.sum((chain.inertia - chain.dry_inertia) * omega**2)
    return Energies(
        bending=elastic * chain.swing,
        torsion=elastic * (1.0 - chain.swing),
        kinetic=float(0.5 * chain.h * kinetic),
        added_mass=float(0.5 * chain.h * added),
        potential=float(-chain.h * np.sum(weight.conj() * centres[0]).real),
    )


@kernel
def stage_powers(given: Reference, weight: Plane, out: Array) -> None:
    """Write the power (W) of the ends, of loads other than `weight`, and dissipated, at the stages, into `out`.

    `given`: see `newton.step`.
    """
    chain, loads, driven, _, stages, _ = given.records
    N = len(chain.mass)
    for i in range(STAGES):
        by_loads, lost = 0.0, 0.0
        work = along(stages.F[i, N], end_velocity(chain, stages, i, 1)) + stages.q[i, N] * stages.omega[i, N + 1]
        work -= along(stages.F[i, 0], end_velocity(chain, stages, i, 0)) + stages.q[i, 0] * stages.omega[i, 0]
        for j in range(N):
            T, V, w = stages.T[i, j + 1], stages.V[i, j], stages.omega[i, j + 1]
            by_loads += along(driven.force[i, j] - weight[j] + T * driven.following[i, j], V) + driven.moment[i, j] * w
            lost += loads.damping * (chain.mass[j] * along(V, V) + chain.dry_inertia[j] * w * w)
            if loads.wet:
                # as in `loads.fluid.fluid_power`
                u, U = V - driven.current[0], driven.current[0]
                a, b, pushed = along(T, u), across(T, u), loads.added_mass[j] * across(T, stages.A[i, j])
                by_a, by_b = loads.drag_tangential[j] * abs(a) * a, loads.drag_normal[j] * abs(b) * b
                by_loads -= by_a * along(T, U) + (by_b + pushed) * across(T, U)
                lost += by_a * a + by_b * b + loads.added_mass[j] * a * b * chain.swing * w
        out[i, 0], out[i, 1], out[i, 2] = work, chain.h * by_loads, chain.h * lost
