"""PyElastica's own case of helical buckling: both ends turned and drawn together, damped to rest."""

from __future__ import annotations

from math import ceil

import elastica
import numpy as np

from benchmarks.work_precision.measure import Stopwatch, refuse_if_long
from benchmarks.work_precision.peers.pyelastica import Simulator, cost_of_a_step, stable_step
from solver.arrays import Array

SHEAR = 1e5
"""N, of shear and of stretch; hockle's rod has neither."""


def solve(
    elements: int, corrected: bool, length: float, radius: float, stiffness: tuple[float, float, float],
    turns: float, slack: float, ramp: float, t_end: float, damping: float,
) -> tuple[Array, float]:  # fmt: skip
    """Positions (n + 1, 3) of the nodes at rest, and the CPU time (s); mass 1 kg/m.

    PyElastica holds the outermost element at each end. `corrected`: these stick out of the rod by half their length.
    Raises `Skipped` if it would take too long.
    """

    def build() -> tuple[Simulator, elastica.CosseratRod, float]:
        whole = length * elements / (elements - 1) if corrected else length
        rod = elastica.CosseratRod.straight_rod(
            elements, np.zeros(3), np.array([0.0, 0.0, 1.0]), np.array([0.0, 1.0, 0.0]), whole, radius,
            1.0 / (np.pi * radius**2), youngs_modulus=1e6, shear_modulus=1e4,
        )  # fmt: skip
        rod.shear_matrix[:] = SHEAR * np.eye(3)[:, :, None]
        rod.bend_matrix[:] = np.diag(stiffness)[:, :, None]
        dt = stable_step(rod)
        simulator = Simulator()
        simulator.append(rod)
        simulator.constrain(rod).using(
            elastica.HelicalBucklingBC, constrained_position_idx=(0, -1), constrained_director_idx=(0, -1),
            twisting_time=ramp, slack=slack, number_of_rotations=turns,
        )  # fmt: skip
        simulator.dampen(rod).using(
            elastica.AnalyticalLinearDamper, uniform_damping_constant=damping, time_step=dt
        )
        simulator.finalize()
        rod.velocity_collection[1, elements // 2] += 1e-6
        return simulator, rod, dt

    stepper = elastica.PositionVerlet()
    simulator, rod, dt = build()
    steps = ceil(t_end / dt)
    refuse_if_long(cost_of_a_step(stepper, simulator, dt), steps)
    watch, t = Stopwatch(), 0.0
    simulator, rod, dt = build()
    for _ in range(steps):
        t = stepper.step(simulator, t, dt)
    return rod.position_collection.T.copy(), watch.read()
