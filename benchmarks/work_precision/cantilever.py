"""A cantilever that hockle and the peers can all do: rod R, clamped at its start, free or pushed at its tip."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from benchmarks.work_precision.measure import Stopwatch
from solver import Curve, End, Frame, Initial, Numerics, PointLoad, Scene, simulate
from solver.arrays import Array
from validation.rods import LENGTH, rod_R


def straight(s: Array) -> Array:
    """Along e3."""
    return np.outer(s, [0.0, 0.0, 1.0])


@dataclass(frozen=True)
class Cantilever:
    """Rod R, straight when free of stress, let go at rest from `shape`.

    `shape` maps arclengths (n,) to lab positions (n, 3), along e3 at the clamp. `tip_force` (N, along e1) grows from
    zero within `ramp` (s); `damping` (1/s) is of the velocity. `samples` of the tip and the energy in `t_end` (s).
    """

    t_end: float
    samples: int
    shape: Callable[[Array], Array] = straight
    tip_force: float = 0.0
    ramp: float = 1.0
    damping: float = 0.0


@dataclass(frozen=True)
class Motion:
    """Times t (m,) in s, the tip (m, 3) in m, all energy that is stored (m,) in J, and the CPU time (s) it took."""

    t: Array
    tip: Array
    energy: Array
    cpu: float


def solve(cantilever: Cantilever, numerics: Numerics) -> Motion:
    """The motion by hockle, its construction and its frames included in the time."""
    force = Curve.table([0.0, cantilever.ramp], [0.0, cantilever.tip_force], "smoothstep")
    zero = Curve.constant(0.0)
    loads = (PointLoad(LENGTH, force=(force, zero, zero)),) if cantilever.tip_force else ()
    scene = Scene(
        rod=rod_R(), initial=Initial(centreline=cantilever.shape), start=End.clamp(), end=End.free(),
        t_end=cantilever.t_end, output_interval=cantilever.t_end / cantilever.samples, points=loads,
        damping=cantilever.damping, numerics=numerics, topology=False,
    )  # fmt: skip
    watch = Stopwatch()
    frames = list(simulate(scene))
    cpu = watch.read()
    return Motion(np.array([f.t for f in frames]), np.array([f.r[-1] for f in frames]),
                  np.array([stored(f) for f in frames]), cpu)  # fmt: skip


def stored(frame: Frame) -> float:
    """Bending, torsion and kinetic energy (J)."""
    return frame.energy_bending + frame.energy_torsion + frame.energy_kinetic


@dataclass(frozen=True)
class Elements:
    """The cantilever cut into `count` straight elements of `length` (m), the first of them held.

    Both peers hold a whole element, and bend first where it ends, which stands for the curvature of half an element to
    either side: the clamp is felt in the middle of the element that is held, not at its start. `corrected` elements
    are a little longer, and the first sticks out of the clamp by half its length.
    """

    count: int
    corrected: bool

    @property
    def length(self) -> float:
        """Of each element, m."""
        return LENGTH / (self.count - 0.5) if self.corrected else LENGTH / self.count

    @property
    def first(self) -> float:
        """Arclength (m) of the first node."""
        return -0.5 * self.length if self.corrected else 0.0

    def tangents(self, shape: Callable[[Array], Array]) -> Array:
        """Unit tangents (n, 3) of the elements; that of the one which is held is e3."""
        middle = np.maximum(self.first + self.length * (np.arange(self.count) + 0.5), 1e-6)
        step = 1e-4 * self.length
        tangents = shape(middle + step) - shape(middle - step)
        tangents /= np.linalg.norm(tangents, axis=1)[:, None]
        tangents[0] = [0.0, 0.0, 1.0]
        return np.asarray(tangents, dtype=float)

    def nodes(self, shape: Callable[[Array], Array]) -> Array:
        """Positions (n + 1, 3) of their nodes."""
        steps = self.length * self.tangents(shape)
        return np.vstack([np.zeros(3), np.cumsum(steps, axis=0)]) + np.array([0.0, 0.0, self.first])


def carried_frames(tangents: Array, first: Array) -> Array:
    """Rotation matrices (n, 3, 3) that follow unit tangents (n, 3) from `first` (3, 3) without twist."""
    frames = [first]
    for before, after in pairwise(tangents):
        axis = np.cross(before, after)
        skew = np.array([[0.0, -axis[2], axis[1]], [axis[2], 0.0, -axis[0]], [-axis[1], axis[0], 0.0]])
        frames.append((np.eye(3) + skew + skew @ skew / (1.0 + before @ after)) @ frames[-1])
    return np.array(frames)
