"""A step of the box method in the middle of Newton's iteration, with everything in it: for tests of its algebra."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from solver import Contact, Fluid, Initial, Numerics, Rod, Scene, UserLoad
from solver.arrays import Array
from solver.kernels.kernel import kernel
from solver.methods.box import _initial_state
from solver.methods.linear.augmented import Augmented, wide_panel, wide_residuals, wide_start
from solver.methods.linear.box_contact import _move, add_contact
from solver.methods.linear.registry import linear_solver_of
from solver.methods.schemes import Scheme, c0_of
from solver.methods.space.box.fields import State
from solver.methods.space.box.intervals import MEANS, interval_panel
from solver.methods.space.box.schemes import SpaceScheme
from solver.methods.space.box.trial import total_bending
from solver.methods.time.generalized_alpha.history import history
from solver.methods.time.generalized_alpha.newton import (
    EndValues,
    Scales,
    Work,
    balance_nodes,
    form_residuals,
    set_scales,
)
from solver.physics.contact.forces import change_forces, touching
from solver.physics.contact.self_contact import SelfContact
from solver.physics.loads.applied import AppliedLoads
from solver.physics.loads.registry import Loads
from solver.physics.section import Section, sample
from solver.scene.curve import Curve
from solver.scene.ends import End
from tests.solver.methods.as_in_runs import call

LENGTH = 0.4
CLAMPED = np.zeros(6, np.int64)


def rod(diameter: float = 0.004) -> Rod:
    """A rod whose diameter varies along s."""
    s = np.linspace(0.0, LENGTH, 11)
    width = Curve.table(s, diameter * (1.0 - 0.1 * np.exp(-(((s - 0.2) / 0.05) ** 2))), "cubic")
    return Rod.circular(LENGTH, width, 1.25e7, 5e6, 1500.0)


def two_turns() -> Initial:
    """A helix of two turns, radius 3 cm, whose neighbouring turns lie 8 mm apart."""
    rate = LENGTH / np.hypot(0.03, 0.008 / (2 * np.pi))

    def helix(s: Array) -> Array:
        angle = rate * s / LENGTH
        return np.stack([0.03 * np.cos(angle), 0.03 * np.sin(angle), 0.008 / (2 * np.pi) * angle], axis=1)

    return Initial(helix, a1=(1.0, 0.0, 0.0))


@kernel
def panel_of(j: int, Y: Array, c0: float, h: float, system, nodes, mean: Array, panel: Array) -> None:  # type: ignore[no-untyped-def]  # fmt: skip
    """`interval_panel` as Python may call it."""
    interval_panel(j, Y, c0, h, system.space, nodes, system.rows, system.columns, mean, panel, 6)


@dataclass
class Problem:
    """A step at an iterate: `residual()` of all equations and `matrix()` of its tangents, both scaled."""

    old: State
    new: State
    section: Section
    loads: Loads
    ends: EndValues
    scheme: Scheme
    dt: float
    work: Work
    contact: SelfContact
    h: float
    applied: AppliedLoads
    """Kept: kernels call a user's loads back by an address in `loads`."""

    @property
    def c0(self) -> float:
        return c0_of(self.scheme, self.dt)

    @property
    def wide(self) -> bool:
        return isinstance(self.work.linear, Augmented)

    def residual(self) -> Array:
        """All residuals in the order of the system's rows."""
        system = self.work.system
        work = self.work
        call(balance_nodes, self.old, self.new, work.past, self.c0, self.section, self.loads, work.nodes)
        if call(touching, self.contact.touch):
            call(add_contact, self.new, work.nodes, self.h, self.contact.touch)
        call(form_residuals, self.new, work.past, self.c0, self.h, self.ends, work.nodes, work.feedback,
             system)  # fmt: skip
        wide = self.work.linear
        if isinstance(wide, Augmented):
            call(wide_residuals, wide, self.new.Y, work.past, self.c0, self.h, work.nodes, system)
            parts = [wide.b_start, wide.b.ravel(), system.b_end]
        else:
            parts = [system.b_start, system.b.ravel(), system.b_end]
        return np.concatenate(parts).copy()

    def unknowns(self) -> list[tuple[Array, int, int, float]]:
        """Each unknown as (array, row, column, scale), in the order of the system's columns."""
        system, wide = self.work.system, self.work.linear
        listed = []
        for j in range(len(self.new.Y)):
            listed += [(self.new.Y, j, k, float(system.columns[k])) for k in range(12)]
            if isinstance(wide, Augmented):
                listed += [(wide.A, j, k, 1.0 / float(system.rows[k] * self.h)) for k in range(12)]
        return listed

    def differences(self, step: float = 1e-6) -> Array:
        """The tangents by central differences."""
        columns = []
        for array, j, k, scale in self.unknowns():
            kept = array[j, k]
            array[j, k] = kept + step * scale
            up = self.residual()
            array[j, k] = kept - step * scale
            columns.append((up - self.residual()) / (2.0 * step))
            array[j, k] = kept
        self.residual()
        return np.stack(columns, axis=1)

    def matrix(self) -> Array:
        """The tangents as the solver writes them, contact included."""
        self.residual()
        system, nodes, Y = self.work.system, self.work.nodes, self.new.Y
        N, mean = len(system.b), np.zeros((MEANS, 3))
        size, left = (24, 18) if self.wide else (12, 6)
        A, W = np.zeros((size * (N + 1), size * (N + 1))), np.zeros((left + size, 2 * size))
        A[:6, :12] = system.start
        if self.wide:
            call(wide_start, Y, self.c0, self.h, nodes, system, mean, W)
            A[:18, :24] = W[:18, :24]
        for j in range(N):
            if self.wide:
                call(wide_panel, j, Y, self.c0, self.h, nodes, system, mean, W)
            else:
                call(panel_of, j, Y, self.c0, self.h, system, nodes, mean, W)
            A[left + size * j : left + size * (j + 1), size * j : size * (j + 2)] = W[left:]
        A[left + size * N :, size * N : size * N + 12] = system.end
        return A + self._contact_matrix(A.shape[0], size, left)

    def _contact_matrix(self, count: int, size: int, left: int) -> Array:
        A = np.zeros((count, count))
        touch, system = self.contact.touch, self.work.system
        near = touch.pairs.members
        if near.counts[0] == 0:
            return A
        x, y = np.zeros((len(self.new.Y), 12)), np.zeros(3 * len(self.new.Y))
        for column in range(12 * len(x)):
            x[:] = 0.0
            x.ravel()[column] = 1.0
            call(_move, x, self.c0, system, near, self.work.coupling)
            call(change_forces, touch, self.c0, self.work.coupling.moved, touch.passed, y)
            at = size * (column // 12) + column % 12
            for m in range(near.counts[1]):
                node = near.nodes[m]
                for j in (node - 1, node):
                    if 0 <= j < len(system.b):
                        rows, share = left + size * j + 6, 1.0 if node in (0, len(system.b)) else 0.5
                        A[rows : rows + 3, at] += share * system.rows[6:9] * y[3 * m : 3 * m + 3]
        return A


def problem(
    intervals: int = 12,
    kinds: tuple[Array, Array] = (CLAMPED, CLAMPED),
    contact: Contact | None = None,
    rho_inf_space: float = 1.0,
    dt: float = 0.02,
    diameter: float = 0.004,
    seed: int = 1,
    damping: float = 0.0,
    fluid: Fluid | None = None,
    gravity: tuple[float, float, float] = (0.0, 0.0, 0.0),
    others: tuple[UserLoad, ...] = (),
    **loads: tuple[Array, Array],
) -> Problem:
    """A step with a random past and a random iterate; `loads`: forces and moments (n, 3) of given loads by name."""
    random = np.random.default_rng(seed)
    numerics = Numerics(intervals=intervals, rho_inf=0.6, rho_inf_space=rho_inf_space)
    scene = Scene(rod(diameter), two_turns(), End.clamp(), End.clamp(), 1.0, 1.0, contact=contact, numerics=numerics,
                  damping=damping, fluid=fluid, gravity=gravity, loads=others)  # fmt: skip
    n, s, h = intervals + 1, np.linspace(0.0, LENGTH, intervals + 1), LENGTH / intervals
    section = sample(scene.rod, s)
    old, new = _initial_state(scene.initial, s, section)[0], State.empty(n)
    natural = np.repeat([0.05, 2.0, 3.0, 1e-3], 3)
    old.Y[:] += natural * random.normal(size=(n, 12))
    old.rate[:] = natural[:9] * random.normal(size=(n, 9))
    old.aux[:] = np.concatenate([natural[:6], natural[:9]]) * random.normal(size=(n, 15))
    new.Y[:] = old.Y + 0.1 * natural * random.normal(size=(n, 12))
    applied = AppliedLoads(scene, section, s)
    records = applied.records
    for name, (force, moment) in loads.items():
        kind = type(getattr(records, name))
        records = records._replace(**{name: kind(True, force[None].copy(), moment[None].copy())})
    values = [np.where(kind % 2 == 1, 1e-4, natural[:6]) * random.normal(size=6) for kind in kinds]
    dead = [1e-4 * random.normal(size=6), 1e-4 * random.normal(size=6)]
    ends = EndValues(kinds[0], values[0], dead[0], kinds[1], values[1], dead[1])
    scheme = Scheme.of(numerics.rho_inf)
    linear = linear_solver_of(numerics)
    work = Work.empty(intervals, SpaceScheme.of(rho_inf_space), linear, contact is not None)
    if isinstance(linear, Augmented):
        linear.A[:] = 0.1 * random.normal(size=linear.A.shape)
    set_scales(Scales(LENGTH, float(section.elastic.K[:, 0, 0].mean())), c0_of(scheme, dt), work.system)
    history(old, scheme, dt, work.past)
    work.feedback[:] = 1e-4 * random.normal(size=work.feedback.shape)
    touching = SelfContact(contact, scene.rod, s, stages=1)
    if contact is not None:
        touching.prepare(total_bending(old.Y, float(s[1])), old.r, old.Y, dt)
    return Problem(old, new, section, records, ends, scheme, dt, work, touching, h, applied)
