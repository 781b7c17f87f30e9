"""Accuracy on demand: pilot runs of a scene on coarse meshes choose the mesh and the steps that a tolerance needs.

A pilot is three runs side by side: N intervals, N / 2, and N / 2 with steps half as long. The first two tell the error
of the mesh, which falls with its square; the last two that of the steps. The steps are halved until their error is
small beside the tolerance, and N is doubled until the mesh that is wanted lies within reach of the estimate. See
docs/decisions/ for what was measured.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from math import ceil, inf, sqrt
from typing import Any, NamedTuple

import numpy as np

from solver.arrays import Array
from solver.measures.frame import Frame, Statistics
from solver.outcome import Outcome, RunFailed
from solver.physics.elasticity import elasticity_of, principal
from solver.run.resolution import halve_steps, with_intervals
from solver.run.run import Run
from solver.run.side_by_side import Kind, SideBySide
from solver.run.simulation import Simulation
from solver.scene.numerics import Numerics
from solver.scene.scene import Scene

FIRST_INTERVALS = 32
LEAST_INTERVALS = 16
REACH = 4
"""How many times finer a mesh than the pilot's may be chosen from it."""
MESH_SHARE, STEP_SHARE = 0.5, 0.25
"""Parts of the tolerance that the errors of the mesh and of the steps may take."""
MOST_HALVINGS = 4
SMALL_BEND = 1e-4
"""Total curvature (rad) that counts as none, so that a straight rod's rounding errors are not to be resolved."""


class Errors(NamedTuple):
    """Relative errors of a run that come from its mesh and from its steps."""

    mesh: float
    steps: float


class Resolution(NamedTuple):
    """Intervals, and how often the longest steps have been halved; `settled` if they are what the tolerance needs."""

    intervals: int
    halvings: int
    settled: bool


def next_resolution(now: Resolution, errors: Errors, numerics: Numerics) -> Resolution | None:
    """What follows from the errors of a pilot; None if the tolerance is out of reach."""
    tolerance, most = numerics.tolerance or inf, numerics.most_intervals
    wanted = max(now.intervals * sqrt(errors.mesh / (MESH_SHARE * tolerance)), LEAST_INTERVALS)
    far, coarse = wanted > REACH * now.intervals, errors.steps > STEP_SHARE * tolerance
    trusted = not far or REACH * now.intervals >= most
    if (trusted and wanted > most) or (coarse and now.halvings == MOST_HALVINGS):
        return None
    if not far and not coarse:
        return Resolution(min(2 * ceil(0.5 * wanted), most), now.halvings, settled=True)
    return Resolution(now.intervals * (2 if far else 1), now.halvings + coarse, settled=False)


class Pilot(SideBySide):
    """N intervals, N / 2, and N / 2 with steps half as long; its frames are those of the first."""

    def __init__(self, scene: Scene, statistics: Statistics) -> None:
        coarser = with_intervals(scene, scene.numerics.intervals // 2)
        super().__init__((scene, coarser, halve_steps(coarser)), Simulation, statistics)
        self._mesh, self._steps = Difference(scene), Difference(scene)

    def _together(self, *frames: Frame) -> Frame:
        fine, coarse, shorter = frames
        self._mesh.add(fine, coarse)
        self._steps.add(shorter, coarse)
        return fine

    @property
    def errors(self) -> Errors:
        """Of the run with N intervals, so far; the errors of the mesh fall with its square."""
        return Errors(self._mesh.largest / 3.0, self._steps.largest)


class Piloted(Run):
    """A run at the resolution that its tolerance needs. The steps of pilots come first, before its first frame."""

    def __init__(self, scene: Scene, kind: Kind) -> None:
        """`kind` makes the run itself."""
        super().__init__(scene)
        self._kind = kind
        self._resolution = Resolution(FIRST_INTERVALS, 0, settled=False)
        self._run = self._begin()

    @property
    def chosen(self) -> Scene:
        """The scene with the intervals and steps of a pilot and, from the first frame on, those that it needs."""
        numerics = replace(self._scene.numerics, tolerance=None, dt_max=self._scene.output_interval)
        scene = with_intervals(replace(self._scene, numerics=numerics), self._resolution.intervals)
        for _ in range(self._resolution.halvings):
            scene = halve_steps(scene)
        return scene

    def _begin(self) -> Run:
        """What the resolution is for: a pilot, or the run itself."""
        settled = self._resolution.settled
        run = (self._kind(self.chosen, self.statistics) if settled
               else Pilot(replace(self.chosen, topology=False), self.statistics))  # fmt: skip
        self.remarks = run.remarks
        return run

    @property
    def s(self) -> Array:
        """Arclengths of the nodes (n,), m; before the first frame they may be those of a pilot."""
        return self._run.s

    def warm(self) -> None:
        """Have every kernel compiled."""
        self._run.warm()

    def restore(self, checkpoint: Mapping[str, Any]) -> None:
        """Go on where a run of the same scene was, in a pilot or after them; see `Run.restore`."""
        self._resolution = Resolution(*(checkpoint[f"._resolution.{name}"] for name in Resolution._fields))
        self._run = self._begin()
        super().restore(checkpoint)

    def _first_frame(self) -> Frame | None:
        if not isinstance(self._run, Pilot):
            return self._run.advance()
        try:
            self._run.advance()
        except RunFailed as failure:
            self._decide(Errors(inf, 0.0), f"{failure.outcome.value} at t = {failure.t:.6g} s")
        else:
            if self._run.finished:
                mesh, steps = self._run.errors
                self._decide(self._run.errors, f"error of the mesh {mesh:.1e}, of the steps {steps:.1e}")
        return None

    def _next_frame(self, output: float) -> Frame | None:
        frame = self._run.advance()
        self.t = self._run.t
        return frame

    def _decide(self, errors: Errors, told: str) -> None:
        """After a pilot: begin the next one, or the run. Raises RunFailed where the tolerance is out of reach."""
        following = next_resolution(self._resolution, errors, self._scene.numerics)
        if following is None:
            detail = f"{self._resolution.intervals} intervals: {told}"
            raise RunFailed(Outcome.TOLERANCE_NOT_REACHED, 0.0, self.statistics.steps, detail)
        self._resolution = following
        self._run = self._begin()


class Difference:
    """How far two runs of a scene are apart, relative to the motion: the largest over all frames of

    r      the largest distance of a node, in rod lengths;
    kappa  the rms along the rod, relative to its largest rms;
    energy of bending, torsion and motion, each relative to the largest sum of the three.
    """

    def __init__(self, scene: Scene) -> None:
        length = float(scene.rod.length)
        bend = SMALL_BEND / length
        stiffness = float(principal(elasticity_of(scene.rod, np.array([0.5 * length])))[0, 0])
        self._apart = np.zeros(3)
        self._scale = np.array([length, bend, 0.5 * stiffness * bend**2 * length])

    def add(self, frame: Frame, other: Frame) -> None:
        """Compare two frames of the same time, the nodes of one being among the other's."""
        (r, other_r), (kappa, other_kappa) = (
            _common(getattr(frame, name), getattr(other, name)) for name in ("r", "kappa")
        )
        energy = _energies(frame)
        now = (np.linalg.norm(r - other_r, axis=1).max(), _rms(kappa - other_kappa),
               np.abs(energy - _energies(other)).max())  # fmt: skip
        self._apart = np.maximum(self._apart, now)
        self._scale = np.maximum(self._scale, (0.0, _rms(kappa), energy.sum()))

    @property
    def largest(self) -> float:
        """The largest of all differences."""
        return float((self._apart / self._scale).max())


def _common(a: Array, b: Array) -> tuple[Array, Array]:
    n = min(len(a), len(b)) - 1
    return a[:: (len(a) - 1) // n], b[:: (len(b) - 1) // n]


def _rms(field: Array) -> float:
    return float(np.sqrt(np.mean(np.sum(field**2, axis=1))))


def _energies(frame: Frame) -> Array:
    motion = frame.energy_kinetic + frame.energy_added_mass
    return np.array([frame.energy_bending, frame.energy_torsion, motion])
