"""MuJoCo's cable: rigid cylinders on ball joints, sprung by its elasticity plugin; both of its explicit integrators."""

from __future__ import annotations

from math import ceil, pi, sqrt
from time import process_time

import mujoco
import numpy as np
from scipy.spatial.transform import Rotation

from benchmarks.work_precision.cantilever import Cantilever, Elements, Motion, carried_frames
from benchmarks.work_precision.measure import Skipped, refuse_if_long
from solver.arrays import Array
from validation.rods import DENSITY, DIAMETER, EJ, GJ, SHEAR_MODULUS, YOUNGS_MODULUS

TRIAL = 200
OF_LIMIT = 0.7
"""At 0.9 a rod that bends far, cut into 40 elements, became unstable."""
LIMIT = {"RK4": 2.0 * sqrt(2.0), "Euler": 2.0}
"""Of omega dt: Runge-Kutta's method of order 4 on the imaginary axis, and the semi-implicit one of Euler."""

MODEL = """
<mujoco>
  <option gravity="0 0 0" integrator="{integrator}" timestep="{dt}">
    <flag energy="enable" contact="disable" constraint="disable"/>
  </option>
  <extension><plugin plugin="mujoco.elasticity.cable"/></extension>
  <worldbody>
    <composite type="cable" initial="none" vertex="{vertices}">
      <plugin plugin="mujoco.elasticity.cable">
        <config key="twist" value="{G}"/><config key="bend" value="{E}"/>
      </plugin>
      <geom type="cylinder" size="{radius}" density="{density}"/>
    </composite>
  </worldbody>
</mujoco>
"""


def stable_step(element: float, integrator: str) -> float:
    """The step (s), from the fastest bending and torsion of a chain of elements of one length (m)."""
    mass = DENSITY * pi * DIAMETER**2 / 4
    inertia = mass * DIAMETER**2 / 16
    bending = 16.0 * EJ / element**4 / (mass / 3.0 + 4.0 * inertia / element**2)
    torsion = 4.0 * GJ / element**2 / (2.0 * inertia)
    return OF_LIMIT * LIMIT[integrator] / sqrt(max(bending, torsion))


class Cable:
    """A MuJoCo model of the cantilever and its state."""

    def __init__(self, cantilever: Cantilever, elements: Elements, dt: float, integrator: str) -> None:
        heights = elements.first + elements.length * np.arange(elements.count + 1)
        self.model = mujoco.MjModel.from_xml_string(MODEL.format(
            dt=dt, integrator=integrator, vertices=" ".join(f"0 0 {z!r}" for z in heights.tolist()),
            G=SHEAR_MODULUS, E=YOUNGS_MODULUS, radius=0.5 * DIAMETER, density=DENSITY,
        ))  # fmt: skip
        self.data = mujoco.MjData(self.model)
        self.length, self.damping = elements.length, cantilever.damping
        self._drag = np.zeros(self.model.nv)
        mujoco.mj_forward(self.model, self.data)
        frames = carried_frames(elements.tangents(cantilever.shape), self.data.xmat[1].reshape(3, 3).copy())
        turns = Rotation.from_matrix(frames[:-1].transpose(0, 2, 1) @ frames[1:]).as_quat(scalar_first=True)
        self.data.qpos[:] = turns.ravel()
        mujoco.mj_forward(self.model, self.data)

    def push(self, force: float) -> None:
        """Put the force (N, along e1) on the tip, and the drag on everything."""
        model, data = self.model, self.data
        data.qfrc_applied[:] = 0.0
        if self.damping:
            mujoco.mj_mulM(model, data, self._drag, data.qvel)
            data.qfrc_applied[:] = -self.damping * self._drag
        if force:
            load, none = np.array([force, 0.0, 0.0]), np.zeros(3)
            mujoco.mj_applyFT(model, data, load, none, self.tip(), model.nbody - 1, data.qfrc_applied)

    def tip(self) -> Array:
        """Its position (3,), m."""
        return np.asarray(self.data.xpos[-1] + self.length * self.data.xmat[-1].reshape(3, 3)[:, 0])

    def energy(self) -> float:
        """Kinetic, and elastic of the joints (J)."""
        bends = Rotation.from_quat(self.data.qpos.reshape(-1, 4), scalar_first=True).as_rotvec()
        elastic = 0.5 / self.length * (GJ * bends[:, 0] ** 2 + EJ * (bends[:, 1] ** 2 + bends[:, 2] ** 2)).sum()
        mujoco.mj_forward(self.model, self.data)
        return float(self.data.energy[1] + elastic)


def solve(cantilever: Cantilever, elements: Elements, integrator: str) -> Motion:
    """The motion, the model's construction included in the time; raises `Skipped` if it would take too long."""
    sample = cantilever.t_end / cantilever.samples
    substeps = ceil(sample / stable_step(elements.length, integrator))
    dt = sample / substeps
    refuse_if_long(_cost_of_a_step(Cable(cantilever, elements, dt, integrator)), substeps * cantilever.samples)
    started = process_time()
    cable = Cable(cantilever, elements, dt, integrator)
    states = [(cable.tip(), cable.energy())]
    for _ in range(cantilever.samples):
        _advance(cable, cantilever, substeps)
        states.append((cable.tip(), cable.energy()))
    cpu = process_time() - started
    if any(warning.number for warning in cable.data.warning):  # MuJoCo then starts again from the model's own state
        raise Skipped("unstable")
    times = np.linspace(0.0, cantilever.t_end, cantilever.samples + 1)
    return Motion(times, np.array([tip for tip, _ in states]), np.array([energy for _, energy in states]), cpu)


def _advance(cable: Cable, cantilever: Cantilever, steps: int) -> None:
    if not (cantilever.damping or cantilever.tip_force):
        mujoco.mj_step(cable.model, cable.data, steps)
        return
    for _ in range(steps):
        cable.push(cantilever.tip_force * min(cable.data.time / cantilever.ramp, 1.0))
        mujoco.mj_step(cable.model, cable.data)


def _cost_of_a_step(cable: Cable) -> float:
    started = process_time()
    mujoco.mj_step(cable.model, cable.data, TRIAL)
    return (process_time() - started) / TRIAL
