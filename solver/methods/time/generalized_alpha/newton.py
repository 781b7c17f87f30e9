"""One time step of the box method: Newton's iteration on all nodes at once."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from solver.arrays import Array
from solver.kernels.handed import Reference
from solver.kernels.kernel import inner, kernel
from solver.methods.linear.box_contact import Coupling, add_contact, contact_fraction, solve_with_contact
from solver.methods.linear.system import LinearSolver, System, factor, solve, solves_again, take_own_unknowns
from solver.methods.schemes import Scheme, c0_of
from solver.methods.space.box.ends import end_conditions
from solver.methods.space.box.fields import KAPPA, F, Nodes, State
from solver.methods.space.box.intervals import interval_residuals
from solver.methods.space.box.nodes import balance_rotation, balance_translation, load_nodes, place_nodes
from solver.methods.space.box.schemes import SpaceScheme
from solver.methods.status import CONVERGED, STALLED
from solver.methods.time.generalized_alpha.history import finish, history
from solver.physics.contact.forces import Touch, touching
from solver.physics.ends import Kinds
from solver.physics.loads.registry import Loads
from solver.physics.section import Section

LARGEST_ITERATIONS = 12
LARGEST_INCREMENT = 1e8
"""Scaled increment beyond which an iteration is given up: forces of a heavy, soft cable start at 1e4 or more."""
TOLERANCE = 1e-9
"""Scaled increment at which an iteration has converged: far below a buckling seed."""


class EndValues(NamedTuple):
    """Conditions at both ends, at the end of the step: kinds, values, and dead lab loads, (6,) each."""

    start_kinds: Kinds
    start: Array
    start_dead: Array
    end_kinds: Kinds
    end: Array
    end_dead: Array


class Scales(NamedTuple):
    """Natural units: length L (m), stiffness EJ (N m^2)."""

    length: float
    stiffness: float


@kernel
def set_scales(scales: Scales, c0: float, system: System) -> None:
    """Scale unknowns to displacements / L, rotations, L kappa and F L^2/EJ, and the equations to match."""
    force = scales.stiffness / scales.length**2
    for i in range(3):
        system.columns[i] = c0 * scales.length
        system.columns[3 + i] = c0
        system.columns[6 + i] = 1.0 / scales.length
        system.columns[9 + i] = force
        system.rows[i] = 1.0 / c0
        system.rows[3 + i] = 1.0 / (c0 * scales.length)
        system.rows[6 + i] = 1.0 / force
        system.rows[9 + i] = 1.0 / (force * scales.length)


@kernel
def balance_nodes(old: State, new: State, past: Array, c0: float, section: Section, loads: Loads, nodes: Nodes) -> None:
    """What the nodes bring to the balances at the iterate `new`, but for contact, with its tangents."""
    place_nodes(old, new, past, c0, nodes)
    balance_rotation(new, section, past, c0, nodes)
    balance_translation(new, section, past, c0, nodes)
    load_nodes(new, loads, past, c0, nodes)


@kernel
def form_residuals(new: State, past: Array, c0: float, h: float, ends: EndValues, nodes: Nodes,
                   feedback: Array, system: System) -> None:  # fmt: skip
    """Residuals of every equation at the iterate `new`, and the tangents of those of the ends."""
    interval_residuals(new.Y, past, c0, h, system.space, nodes, feedback, system.rows, system.b)
    end_conditions(new.Y, 0, ends.start_kinds, ends.start, ends.start_dead, system.rows, system.columns,
                   nodes, system.b_start, system.start)  # fmt: skip
    end_conditions(new.Y, len(new.Y) - 1, ends.end_kinds, ends.end, ends.end_dead, system.rows, system.columns,
                   nodes, system.b_end, system.end)  # fmt: skip


@inner
def increment_size(new: State, system: System, scales: Scales) -> float:
    """The largest scaled increment, kappa and F relative to their own size where that exceeds 1."""
    kappa, force, size = 1.0, 1.0, 0.0
    for j in range(len(new.Y)):
        for i in range(3):
            kappa = max(kappa, scales.length * abs(new.Y[j, KAPPA + i]))
            force = max(force, abs(new.Y[j, F + i]) * scales.length**2 / scales.stiffness)
    for j in range(len(new.Y)):
        for i in range(3):
            size = max(size, abs(system.x[j, i]), abs(system.x[j, 3 + i]))
            size = max(size, abs(system.x[j, 6 + i]) / kappa, abs(system.x[j, 9 + i]) / force)
        if not np.isfinite(system.x[j, 0]):
            return np.inf
    return size


class Work(NamedTuple):
    """Arrays that a step writes and nobody keeps."""

    past: Array
    feedback: Array
    nodes: Nodes
    system: System
    linear: LinearSolver
    coupling: Coupling

    @classmethod
    def empty(cls, intervals: int, space: SpaceScheme, linear: LinearSolver, touching: bool) -> Work:
        """Zeros for a rod of `intervals` intervals."""
        n = intervals + 1
        return cls(np.zeros((n, 15)), np.zeros((intervals, 3)), Nodes.empty(n), System.empty(intervals, space), linear,
                   Coupling.empty(intervals if touching else 0))  # fmt: skip


class StepRecords(NamedTuple):
    """What the kernels of a step get by reference."""

    section: Section
    loads: Loads
    scales: Scales
    touch: Touch
    work: Work


@kernel
def step(reference: Reference, old: State, new: State, scheme: Scheme, dt: float, h: float,
         ends: EndValues) -> tuple[int, int]:  # fmt: skip
    """Advance `old` by dt into `new`; `new.Y` is the first guess. Returns how it ended and the iterations.

    `reference`: to `StepRecords`; `work.feedback` holds the stretch times its feedback rate.
    Convergence: the increment, or its extrapolation for a quadratically converging iteration, is below 1e-9 of the
    natural units.
    Records of many arrays go only to where they are needed: each one passed on costs some ns in every iteration.
    """
    section, loads, scales, touch = reference.section, reference.loads, reference.scales, reference.touch
    work = reference.work
    c0, contact = c0_of(scheme, dt), touching(touch)
    past, nodes, system = work.past, work.nodes, work.system
    history(old, scheme, dt, past)
    set_scales(scales, c0, system)
    before = 0.0
    for iteration in range(1, LARGEST_ITERATIONS + 1):
        balance_nodes(old, new, past, c0, section, loads, nodes)
        if contact:
            add_contact(new, nodes, h, touch)
        form_residuals(new, past, c0, h, ends, nodes, work.feedback, system)
        status = factor(work.linear, new.Y, past, c0, h, nodes, system)
        if status != CONVERGED:
            return status, iteration
        if contact and solves_again(work.linear):
            solve_with_contact(work.linear, c0, h, system, touch, work.coupling)
        else:
            solve(work.linear, system, 1.0, system.b, system.x)
        size = increment_size(new, system, scales)
        if not size < LARGEST_INCREMENT:
            return STALLED, iteration
        fraction = contact_fraction(c0, system, touch, work.coupling) if contact else 1.0
        for j in range(len(new.Y)):
            for k in range(12):
                new.Y[j, k] -= fraction * system.columns[k] * system.x[j, k]
        take_own_unknowns(work.linear, fraction, h, system)
        if size < TOLERANCE or (before > 0.0 and size < 1e-4 and size * size / before < TOLERANCE):
            place_nodes(old, new, past, c0, nodes)
            finish(old, new, scheme, dt, past)
            return CONVERGED, iteration
        before = size
    return STALLED, LARGEST_ITERATIONS
