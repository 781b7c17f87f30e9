"""The books of a run: what flows in and out at each step, and the frame that sums them up."""

from __future__ import annotations

from math import nan
from typing import Any

import numpy as np

from solver.arrays import Array
from solver.measures.energies import Energies
from solver.measures.frame import Frame
from solver.measures.ring import is_ring
from solver.measures.topology import writhe_of_rod
from solver.methods.method import Ahead, Method
from solver.physics.elasticity import elasticity_of, principal
from solver.physics.ends import ABOUT_A3
from solver.run.astray import Astray
from solver.run.linking import LinkingNumber
from solver.scene.scene import Scene

MADE_OF_NOTHING, LOST_AT_REST = 1e-8, 0.5e-6
"""In the rod's own energy EJ/L, of the softer axis: what the balance may be off by where nothing moves. A mesh's errors
may be worth a bend by 1e-3 of what a rod is bent by at first, of 1 rad at the most or if something pulls at it: it may
lose that at rest, but must not make as much."""

OF_ENERGIES = tuple(f"energy_{name}" for name in Energies._fields)
"""Outputs that are the rod's energies."""


class Accounts:
    """Work, dissipation and their balance, linking number, and the numbers of the last step."""

    def __init__(self, scene: Scene, method: Method) -> None:
        self._scene, self._method = scene, method
        self._totals = np.zeros(4)
        self._dt, self._iterations = 0.0, 0
        self._energy_at_start: float | None = None
        self._t, self._balance, self._missing = 0.0, 0.0, 0.0
        self._astray, self._lost = Astray(scene), Astray(scene)
        """Of the whole balance, and of that without what an end's jolt took."""
        self._entries: tuple[float, ...] = ()
        """Of the last frame: the energies, and what has flowed."""
        self._settled = False
        """Whether the balance is that of the last step's end."""
        thrown = any((*scene.initial.velocity, *scene.initial.angular_velocity))
        self._jolts = [*([0.0] if thrown else []), *method.start.jolts(), *method.end.jolts()]
        s = np.linspace(0.0, scene.rod.length, 11)
        self._unit = float(principal(elasticity_of(scene.rod, s))[:, :2].min(axis=1).mean()) / scene.rod.length
        pulled = any(scene.gravity) or scene.distributed or scene.points or scene.loads or scene.fluid
        bent = float(scene.rod.length * np.linalg.norm(method.fields().kappa[:, :2], axis=1).max())
        self._lost_at_rest = max(MADE_OF_NOTHING, LOST_AT_REST * (1.0 if pulled else min(bent, 1.0)) ** 2) * self._unit
        self._turnover, self._there = 0.0, 0.0
        self._linking, self._ring = LinkingNumber(), is_ring(scene)
        self._swings = scene.topology and not (scene.start.holds_tangent() and scene.end.holds_tangent())
        """Whether the linking number changes by how the ends' tangents move."""
        self._follow_ends()

    def after_step(self, t: float, dt: float, iterations: int, flowed: Array) -> None:
        """Enter the step just taken, which ends at t, and the energy (4,) that flowed in it: see `Method.take_step`."""
        self._totals += flowed
        self._settled = False
        self._dt, self._iterations = dt, iterations
        if self._astray.is_due(t - self._t):
            self._settle(t, self._method.energies())
        self._follow_ends()

    def _follow_ends(self) -> None:
        if self._swings and (orientations := self._method.orientations) is not None:
            self._linking.follow(self._turned(), orientations)

    def _turned(self) -> float:
        """By how much the end has turned about its tangent more than the start (rad), as integrated."""
        return float(self._method.end.travel[ABOUT_A3] - self._method.start.travel[ABOUT_A3])

    def frame(self, t: float, ago: float = 0.0) -> Frame:
        """The frame at time t, `ago` (s) before the end of the last step.

        The balance is that of the steps: a polynomial within one makes or loses some energy that the motion does not.
        """
        method = self._method
        if ago > 0.0 and not self._settled:
            self._settle(t + ago, method.energies())
        ahead = method.look_back(ago)
        fields, energy, Tw = method.fields(), method.energies(), method.twist()
        work_ends, work_loads, dissipation, contact = (self._totals - ahead.energy).tolist()
        total = sum(energy) + contact
        entries = (*energy, contact, work_ends, work_loads, dissipation)
        if self._energy_at_start is None:
            self._energy_at_start = total
            self._turnover += total - energy.potential
        else:
            self._turnover += sum(abs(now - before) for now, before in zip(entries, self._entries, strict=True))
        self._entries = entries
        self._there = max(self._there, total - energy.potential)
        if not self._settled:
            self._settle(t, energy)
        Wr = writhe_of_rod(fields.r, fields.orientation, self._ring) if self._scene.topology else nan
        # the moment is the same on both sides of a step, but at the start, where the curvature is given
        kappa = method.beside.at_nodes(fields.kappa, fields.q) if t > 0.0 else fields.kappa
        shown = energy._replace(bending=energy.bending + method.unresolved_bending)
        named: dict[str, Any] = vars(fields) | {"kappa": kappa} | dict(zip(OF_ENERGIES, shown, strict=True))
        return Frame(
            t=t, **named, energy_contact=contact,
            work_ends=work_ends, work_loads=work_loads, dissipation=dissipation,
            energy_balance=self._balance, astray=self._astray.most,
            Tw=Tw, Wr=Wr, Lk=self._linking_number(t, Tw, Wr, ahead, fields.orientation), min_gap=method.smallest_gap(),
            contacts=method.pressing(), dt=self._dt, newton_iterations=self._iterations,
        )  # fmt: skip

    @property
    def made(self) -> float:
        """Energy that came from nowhere until the last frame, over all that changed its form or hands.

        Negative where energy went nowhere. What an end's jolt took does not count.
        """
        floor = MADE_OF_NOTHING * self._unit if self._missing > 0.0 else self._lost_at_rest
        return self._missing / (self._turnover + floor)

    @property
    def lost(self) -> float:
        """Energy that went nowhere until the last frame, but for what would have been damped since, over the largest
        that motion, strain and contact ever had."""
        return max(-self._lost.energy, 0.0) / (self._there + self._lost_at_rest)

    def _settle(self, t: float, energy: Energies) -> None:
        """Enter the balance (J) at the end t of the last step, where the rod has this energy."""
        work_ends, work_loads, dissipation, contact = self._totals.tolist()
        balance = sum(energy) + contact - (self._energy_at_start or 0.0) - work_ends - work_loads + dissipation
        self._settled, change = True, balance - self._balance
        counts = change > 0.0 or not any(self._t <= jolt <= t for jolt in self._jolts)
        self._missing += change if counts else 0.0
        self._astray.enter(change, t - self._t, self._dt)
        self._lost.enter(change if counts else 0.0, t - self._t, self._dt)
        self._t, self._balance = t, balance

    def _linking_number(self, t: float, Tw: float, Wr: float, ahead: Ahead, orientation: Array) -> float:
        """NaN where nobody asks."""
        if not self._scene.topology:
            return nan
        turned = []
        for end, still in zip((self._method.start, self._method.end), ahead.twisted, strict=True):
            exact = end.prescribed(ABOUT_A3, t)
            turned.append(float(end.travel[ABOUT_A3]) - still if exact is None else exact)
        swept = 0.0
        if self._swings and self._method.orientations is not None:
            swept = self._linking.swept_since(self._turned() - (ahead.twisted[1] - ahead.twisted[0]), orientation)
        return self._linking.of(turned[1] - turned[0], Tw, Wr, swept)
