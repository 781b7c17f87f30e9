"""A run with its own error bars: the same scene on two meshes, and what they say together."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields, replace
from math import pi
from typing import Any

import numpy as np

from solver.arrays import Array
from solver.measures.frame import OUTPUTS, Frame, Statistics
from solver.methods.registry import METHODS, tolerated_increment
from solver.physics.elasticity import can_stretch, principal
from solver.physics.section import sample
from solver.run.run import Run
from solver.scene.rod import Rod
from solver.scene.scene import Scene

OF_WAVES, OF_SOUND = ("energy_bending", "energy_torsion", "energy_kinetic"), ("energy_stretching",)
"""Outputs that are wrong by as much energy (J) as may be in waves that no run follows; and of rods that can stretch."""
SHORTEST = 1e-300
"""A step (s) that stands for none, as at t = 0."""
NAMES = tuple(field.name for field in fields(Frame))


@dataclass(frozen=True, kw_only=True)
class VerifiedFrame(Frame):
    """The extrapolated solution of two runs, and the estimate of its error: `error.r` for `r`, of the same shape."""

    error: Frame


class Verified(Run):
    """A run of a scene and of its refinement: neither begins a frame before the other has ended the last one. The
    frames are `VerifiedFrame`."""

    def __init__(self, scene: Scene, kind: Callable[[Scene, Statistics], Run]) -> None:
        """`kind`: what makes the run of a scene, given the account that its cost goes to."""
        super().__init__(scene)
        single = replace(scene, numerics=replace(scene.numerics, verify=False))
        self._runs = [kind(resolved, self.statistics) for resolved in (single, refine(single))]
        self.remarks = self._runs[0].remarks
        self._waiting: list[list[Any]] = []  # the values of frames, because a checkpoint holds no frames

    @property
    def s(self) -> Array:
        """Arclengths of the nodes (n,), m."""
        return self._runs[0].s

    def warm(self) -> None:
        """Have every kernel compiled."""
        self._runs[0].warm()

    def _first_frame(self) -> Frame | None:
        return self._next_frame(0.0)

    def _next_frame(self, output: float) -> Frame | None:
        """Take one step of the run whose turn it is."""
        frame = self._runs[len(self._waiting)].advance()
        self.t = min(run.t for run in self._runs)
        if frame is not None:
            self._waiting.append([getattr(frame, name) for name in NAMES])
        if len(self._waiting) < len(self._runs):
            return None
        coarse, fine = (Frame(**dict(zip(NAMES, values, strict=True))) for values in self._waiting)
        self._waiting.clear()
        lost, missed = float(np.fmax(fine.astray, 0.0)), float(np.fmax(abs(fine.energy_balance), 0.0))
        least = unseen(self._scene.rod, self.s, lost, fine.dt) | dict.fromkeys(of_waves(self._scene.rod), lost)
        return extrapolate(coarse, fine, least | {"dissipation": missed})


def refine(scene: Scene) -> Scene:
    """The scene with intervals and steps half as long: dt_max, and by what their error makes of them."""
    numerics = scene.numerics
    tolerated = tolerated_increment(numerics) * 0.5 ** METHODS[numerics.method][-1].increment_order
    finer = replace(numerics, intervals=2 * numerics.intervals, dt_max=0.5 * numerics.dt_max,
                    increment_tolerance=tolerated)  # fmt: skip
    return replace(scene, numerics=finer)


def of_waves(rod: Rod) -> tuple[str, ...]:
    """Those of `OF_WAVES` that a rod may have."""
    return OF_WAVES + OF_SOUND if can_stretch(rod) else OF_WAVES


def unseen(rod: Rod, s: Array, lost: float, dt: float) -> dict[str, Array | float]:
    """How large outputs may be in waves with the energy `lost` (J), damped away by both runs' steps of dt: fields
    (n, ...), and Tw and Wr.

    Waves shorter than the steps are damped within a few of them, by either run alike, and their difference does not
    show it; but the energy that the finer run has missed so far does. In a field x with the energy 1/2 int K x^2 ds it
    has the rms sqrt(2 lost / (K L)). In bending waves nearly all
    kinetic energy is in v; of those that turn by 1 rad in dt, k^2 = (m / EJ)^(1/2) / dt, omega is k v and f is
    m v / (k dt), and Tw and Wr differ by what the rod turns, omega dt. How far it moves, v dt, hardly counts. Tension
    is in waves only where the rod can stretch.
    """
    section = sample(rod, s)
    stiffness, mass = principal(section.elastic), section.mass[:, None]
    weights = {"v": mass, "omega": section.inertia, "kappa": stiffness, "q": 1.0 / stiffness}
    fields = {name: np.sqrt(2.0 * lost / (weight * float(rod.length))) for name, weight in weights.items()}
    dt = max(dt, SHORTEST)
    k = (mass / stiffness[:, :2]) ** 0.25 / np.sqrt(dt)
    fields["omega"][:, :2] = k * fields["v"]
    f = np.zeros((len(s), 3))
    f[:, :2] = mass * fields["v"] / (k * dt)
    if can_stretch(rod):
        f[:, 2] = np.sqrt(2.0 * lost / (section.elastic.compliance * float(rod.length)))
    turned = dt * np.linalg.norm(fields["omega"][:, :2], axis=1)
    turns = float(turned.max() / (2.0 * pi))
    return {**fields, "f": f, "orientation": 0.5 * turned[:, None], "Tw": turns, "Wr": turns}


def extrapolate(coarse: Frame, fine: Frame, least: Mapping[str, Array | float]) -> VerifiedFrame:
    """Richardson: both methods are of order 2 along s, so the error of the finer run is (fine - coarse) / 3.

    That much is added, and is also the estimate: the error of the finer run, which that of the extrapolated solution
    is below wherever the order shows. Where the two runs cross they say nothing: along the rod no estimate is less than
    its component's rms, and none is less than the output's `least`. The nodes are the coarse run's, every second one of
    the fine run's.
    """
    values: dict[str, Any] = {"t": fine.t}
    errors: dict[str, Any] = {"t": fine.t}
    for output in OUTPUTS:
        name = output.name
        coarse_values, fine_values = getattr(coarse, name), getattr(fine, name)
        if output.along_rod:
            fine_values = fine_values[::2]
        if not output.verified:
            values[name], errors[name] = fine_values, fine_values
            continue
        if output.axes == "quaternion":  # a quaternion and its opposite are the same rotation
            fine_values = fine_values * np.sign(np.sum(coarse_values * fine_values, axis=-1, keepdims=True))
        error = np.abs(fine_values - coarse_values) / 3.0
        if output.along_rod:
            error = np.maximum(error, np.sqrt(np.mean(error**2, axis=0)))
        error = np.maximum(error, least.get(name, 0.0))
        value = fine_values + (fine_values - coarse_values) / 3.0
        if output.axes == "quaternion":
            value /= np.linalg.norm(value, axis=-1, keepdims=True)
        values[name], errors[name] = value, error
    return VerifiedFrame(**values, error=Frame(**errors))
