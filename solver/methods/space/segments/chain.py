"""The arrays of the staggered method, each named once.

N rigid segments of length h are joined at N + 1 nodes. Orientations are counted from 0 to N + 1: the frame of the
start, the N segments, the frame of the end; the end frames have no length and no mass. Joint i, at node i, lies between
the orientations i and i + 1; the joints of the ends are half as long as the others. So kappa, q, F and r live at the
nodes, omega and the tangent between them.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from solver.arrays import Array
from solver.kernels.kernel import inlined
from solver.physics.elasticity import Elasticity

STAGES = 3


@inlined
def rate_at(i: int, values: Any, before: Any, inverse: Array, dt: float) -> Any:
    """The rate at stage i of what was `before` when the step of dt began, and is `values` (3,) at its stages."""
    change = inverse[i, 0] * (values[0] - before) + inverse[i, 1] * (values[1] - before)
    return (change + inverse[i, 2] * (values[2] - before)) / dt


class Chain(NamedTuple):
    """What does not change in a run.

    `h` (m). Segments (N,): `mass` rho_c A (kg/m), `inertia` and `dry_inertia` (N, 3) (kg m) per length about the
    segment's centre, with and without the fluid's added mass: I + (h^2/12) m across the segment, the consistent mass.
    Joints: `span` (N + 1,) in m, and what is `elastic` there.
    """

    h: float
    mass: Array
    inertia: Array
    dry_inertia: Array
    span: Array
    elastic: Elasticity


class State(NamedTuple):
    """The rod at one time: all that a restart needs.

    `quaternion` (N + 2, 4), `omega` and its rate `alpha` (N + 2, 3), material; `base` (3, 3): position, velocity and
    acceleration of the start, lab; `F` (N + 1, 3): forces at the nodes, lab; `opening` (3, N + 1): by how much (m) the
    joints are open, and its rates (see `opening`).
    """

    quaternion: Array
    omega: Array
    alpha: Array
    base: Array
    F: Array
    opening: Array

    @classmethod
    def empty(cls, intervals: int) -> State:
        """Zeros for N = `intervals`."""
        n = intervals + 2
        return cls(np.zeros((n, 4)), np.zeros((n, 3)), np.zeros((n, 3)), np.zeros((3, 3)), np.zeros((n - 1, 3)),
                   np.zeros((3, n - 1)))  # fmt: skip


class Stages(NamedTuple):
    """The three stages of a step, stage first.

    Unknown: `theta` (3, N + 2, 3), by how much the rotation departs from a steady one (see `motion`); `shift` (3, 3),
    displacement of the start; `F` (3, N + 1, 3). Of the steady rotation: `start` (N + 2, 3, 3) its beginning,
    `steady` (3, N + 2, 4) and `S` (3, N + 2, 3, 3). From these: `theta_t`, `theta_tt`; `quaternion`, `R`, `omega`,
    `alpha` of the orientations; `r`, `V`, `A` (3, N, 3): position, velocity and acceleration of the segments' centres,
    lab; `base` (3, 3, 3) those of the start; `opening` (3, 3, N + 1) of the joints, with its rates; `bend`
    (3, N + 1, 3): the joints' rotation vectors; `moment` (3, N + 1, 3) q; `left`, `right` (3, N + 1, 3): q turned into
    the frames before and behind the joint; `F_t` (3, 2, 3): rates of F at the start and at the end.
    """

    theta: Array
    shift: Array
    F: Array
    start: Array
    steady: Array
    S: Array
    theta_t: Array
    theta_tt: Array
    quaternion: Array
    R: Array
    omega: Array
    alpha: Array
    r: Array
    V: Array
    A: Array
    base: Array
    opening: Array
    bend: Array
    moment: Array
    left: Array
    right: Array
    F_t: Array

    @classmethod
    def empty(cls, intervals: int) -> Stages:
        """Zeros for N = `intervals`."""
        n = intervals + 2
        turned, centres, joints = (STAGES, n, 3), (STAGES, n - 2, 3), (STAGES, n - 1, 3)
        quaternions, matrices = (STAGES, n, 4), (STAGES, n, 3, 3)
        shapes = (turned, (STAGES, 3), joints, (n, 3, 3), quaternions, matrices, turned, turned, quaternions, matrices,
                  turned, turned, centres, centres, centres, (STAGES, 3, 3), (STAGES, 3, n - 1), *[joints] * 4,
                  (STAGES, 2, 3))  # fmt: skip
        return cls(*(np.zeros(shape) for shape in shapes))


class Residuals(NamedTuple):
    """What is left of the equations at each stage.

    `rotation` (3, N + 2, 3): moments on the orientations (N m), or what an end's rotation condition misses;
    `translation` (3, N, 3): forces on the segments (N); `ends` (3, 2, 3): what the conditions on the translation of the
    start and of the end miss.
    """

    rotation: Array
    translation: Array
    ends: Array

    @classmethod
    def empty(cls, intervals: int) -> Residuals:
        """Zeros for N = `intervals`."""
        return cls(np.zeros((STAGES, intervals + 2, 3)), np.zeros((STAGES, intervals, 3)), np.zeros((STAGES, 2, 3)))
