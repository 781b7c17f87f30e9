"""PyElastica: a Cosserat rod that stretches and shears, position Verlet at the largest step that is stable."""

from __future__ import annotations

from math import ceil, sqrt
from time import process_time

import elastica
import numpy as np

from benchmarks.work_precision.cantilever import Cantilever, Elements, Motion, carried_frames
from benchmarks.work_precision.measure import refuse_if_long
from solver.arrays import Array
from validation.rods import DENSITY, DIAMETER, SHEAR_MODULUS, YOUNGS_MODULUS

TRIAL = 500
"""Steps that are taken to compile and to learn what a step costs, before the run that is measured."""
OF_LIMIT = 0.9


class Simulator(  # type: ignore[misc]
    elastica.BaseSystemCollection, elastica.Constraints, elastica.Forcing, elastica.Damping
):
    """What a PyElastica simulation is put together in."""


def stable_step(rod: elastica.CosseratRod) -> float:
    """The step (s): of Verlet's limit 2 / omega, with the fastest stretch, shear and rotation of an element."""
    element = float(rod.rest_lengths[0])
    mass = float(rod.mass[1]) / element
    inertia = float(rod.mass_second_moment_of_inertia[0, 0, 0]) / element
    shear, stretch = float(rod.shear_matrix[0, 0, 0]), float(rod.shear_matrix[2, 2, 0])
    bend, twist = float(rod.bend_matrix[0, 0, 0]), float(rod.bend_matrix[2, 2, 0])
    wave = 4.0 / element**2
    across = shear / inertia + wave * (shear / mass + bend / inertia)
    along = wave * max(stretch / mass, twist / float(rod.mass_second_moment_of_inertia[2, 2, 0]) * element)
    return OF_LIMIT * 2.0 / sqrt(max(across, along))


def _cantilever(cantilever: Cantilever, elements: Elements) -> tuple[Simulator, elastica.CosseratRod, float]:
    rod = elastica.CosseratRod.straight_rod(
        elements.count, np.zeros(3), np.array([0.0, 0.0, 1.0]), np.array([1.0, 0.0, 0.0]),
        elements.count * elements.length, 0.5 * DIAMETER, DENSITY,
        youngs_modulus=YOUNGS_MODULUS, shear_modulus=SHEAR_MODULUS,
    )  # fmt: skip
    dt = stable_step(rod)
    first = rod.director_collection[..., 0].T
    frames = carried_frames(elements.tangents(cantilever.shape), first)
    rod.position_collection[:] = elements.nodes(cantilever.shape).T
    rod.director_collection[:] = frames.transpose(2, 1, 0)
    simulator = Simulator()
    simulator.append(rod)
    simulator.constrain(rod).using(
        elastica.OneEndFixedBC, constrained_position_idx=(0,), constrained_director_idx=(0,)
    )
    if cantilever.tip_force:
        force = np.array([cantilever.tip_force, 0.0, 0.0])
        simulator.add_forcing_to(rod).using(
            elastica.EndpointForces, np.zeros(3), force, ramp_up_time=cantilever.ramp
        )
    if cantilever.damping:
        simulator.dampen(rod).using(
            elastica.AnalyticalLinearDamper, uniform_damping_constant=cantilever.damping, time_step=dt
        )
    simulator.finalize()
    return simulator, rod, dt


def solve(cantilever: Cantilever, elements: Elements) -> Motion:
    """The motion, the simulator's construction included in the time; raises `Skipped` if it would take too long."""
    stepper = elastica.PositionVerlet()
    simulator, rod, dt = _cantilever(cantilever, elements)
    substeps = ceil(cantilever.t_end / cantilever.samples / dt)
    dt = cantilever.t_end / cantilever.samples / substeps
    refuse_if_long(cost_of_a_step(stepper, simulator, dt), substeps * cantilever.samples)
    started, t = process_time(), 0.0
    simulator, rod, _ = _cantilever(cantilever, elements)
    states = [_state(rod)]
    for _ in range(cantilever.samples):
        for _ in range(substeps):
            t = stepper.step(simulator, t, dt)
        states.append(_state(rod))
    cpu = process_time() - started
    times = np.linspace(0.0, cantilever.t_end, cantilever.samples + 1)
    return Motion(times, np.array([tip for tip, _ in states]), np.array([energy for _, energy in states]), cpu)


def cost_of_a_step(stepper: elastica.PositionVerlet, simulator: Simulator, dt: float) -> float:
    """CPU time (s) of a step, once compiled."""
    t = 0.0
    for count in (2, TRIAL):
        started = process_time()
        for _ in range(count):
            t = stepper.step(simulator, t, dt)
    return (process_time() - started) / TRIAL


def forecast(length: float, radius: float, E: float, G: float, density: float, elements: int, t_end: float) -> str:
    """What t_end (s) of a rod would take, from the cost of a step; SI units."""
    rod = elastica.CosseratRod.straight_rod(
        elements, np.zeros(3), np.array([0.0, 0.0, 1.0]), np.array([1.0, 0.0, 0.0]), length, radius, density,
        youngs_modulus=E, shear_modulus=G,
    )  # fmt: skip
    dt = stable_step(rod)
    simulator = Simulator()
    simulator.append(rod)
    simulator.finalize()
    steps = ceil(t_end / dt)
    cost = steps * cost_of_a_step(elastica.PositionVerlet(), simulator, dt)
    return f"not run: would take {cost:.0f} CPU s ({steps} steps)"


def _state(rod: elastica.CosseratRod) -> tuple[Array, float]:
    energy = (rod.compute_bending_energy() + rod.compute_shear_energy()
              + rod.compute_translational_energy() + rod.compute_rotational_energy())  # fmt: skip
    return rod.position_collection[:, -1].copy(), float(energy)
