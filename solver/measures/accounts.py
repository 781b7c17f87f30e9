"""The books of a run: what flows in and out at each step, and the frame that sums them up."""

from __future__ import annotations

from math import nan, pi

import numpy as np

from solver.frame import Frame
from solver.measures.energies import energies
from solver.measures.topology import writhe
from solver.methods.box.fields import KAPPA, OMEGA, F
from solver.methods.box.method import BoxMethod
from solver.rotation import rotate, rotate_back
from solver.scene import Scene

E3 = np.array([[0.0, 0.0, 1.0]])


class Accounts:
    """Work, dissipation and their balance, linking number, and the numbers of the last step."""

    def __init__(self, scene: Scene, method: BoxMethod) -> None:
        self._scene, self._method = scene, method
        self._power, self._power_before = np.zeros(4), np.zeros(4)
        self._totals = np.zeros(4)
        self._dt, self._iterations = 0.0, 0
        self._energy_at_start: float | None = None
        self._Lk_at_start = 0.0

    def after_step(self, t: float, dt: float, iterations: int) -> None:
        """Enter a step that ended at t."""
        self._power, self._power_before = self._power_before, self._power
        self._method.power(self._power[:3])
        self._power[3], rubbed = self._method.contact.power()
        self._power[2] += rubbed
        self._totals += 0.5 * dt * (self._power + self._power_before)
        self._dt, self._iterations = dt, iterations

    def frame(self, t: float) -> Frame:
        """The frame at time t."""
        method = self._method
        state, section = method.state, method.section
        Y, quaternion = state.Y, state.quaternion
        tangent = rotate(quaternion, np.repeat(E3, len(Y), axis=0))
        energy = energies(state, section, method.loads, method.applied.weight, tangent, method.h)
        work_ends, work_loads, dissipation, contact = (float(total) for total in self._totals)
        total = sum(energy) + contact
        if self._energy_at_start is None:
            self._energy_at_start = total
        kappa = Y[:, KAPPA : KAPPA + 3].copy()
        Tw = float(np.sum(0.5 * (kappa[1:, 2] + kappa[:-1, 2])) * method.h / (2 * pi))
        Wr = float(writhe(state.r, tangent[0], tangent[-1])) if self._scene.topology else nan
        return Frame(
            t=t, v=method.velocity(), omega=Y[:, OMEGA : OMEGA + 3].copy(), f=rotate_back(quaternion, Y[:, F:].copy()),
            kappa=kappa, q=section.stiffness * (kappa - section.kappa0), r=state.r.copy(),
            orientation=quaternion.copy(),
            energy_bending=energy.bending, energy_torsion=energy.torsion, energy_kinetic=energy.kinetic,
            energy_added_mass=energy.added_mass, energy_potential=energy.potential, energy_contact=contact,
            work_ends=work_ends, work_loads=work_loads, dissipation=dissipation,
            energy_balance=total - self._energy_at_start - work_ends - work_loads + dissipation,
            Tw=Tw, Wr=Wr, Lk=self._linking_number(t, Tw, Wr), min_gap=method.contact.smallest_gap(state),
            contacts=method.contact.pressing,
            dt=self._dt, newton_iterations=self._iterations,
        )  # fmt: skip

    def _linking_number(self, t: float, Tw: float, Wr: float) -> float:
        """Relative rotation of the ends in turns, from Tw + Wr at the start on."""
        if not self._scene.topology:
            return nan
        if t == 0.0:
            self._Lk_at_start = Tw + Wr
        turned = []
        for end in (self._method.start, self._method.end):
            exact = end.rotation_prescribed(t)
            turned.append(float(end.travel[5]) if exact is None else exact)
        return self._Lk_at_start + (turned[1] - turned[0]) / (2 * pi)
