"""Whether a run is right by its own books: what must hold in every frame, whatever the case.

- Every number is finite.
- Energy: what is stored is what came in less what was dissipated, within `BALANCE` of the turnover, the sum of all that
  changed hands.
  What is lost where an end jolts is not counted: an inextensible rod that is caught loses energy for real.
- Length: the chord of an interval is its arc, but for its curvature: (kappa ds)^2 / 8 at most, and `STRETCH`.
- Topology: Tw + Wr = Lk + constant between ends that do not swing, within `TURNS` and what the box method's mean
  curvature may miss, (kappa ds)^2 / 8 of the turns. A pass-through changes it by 2; so does a hop over an end, if the
  run says that there was one. An end behind the start is let be.
- Statics: forces and moments on the whole rod are in equilibrium, within `FORCE` of the largest.
"""

from __future__ import annotations

from dataclasses import fields
from math import isfinite, isnan, pi

import numpy as np

from solver import Condition, End, Frame, Scene
from solver.arrays import Array
from solver.kernels.rotation import rotate
from stress.ending import Ending

BALANCE = STRETCH = TURNS = 0.1
"""What the default increment_tolerance is: a step may err by that part of its motion."""
FORCE = 1e-6
NOISE = 1e-9
"""In the rod's own units: where Newton's iteration stops."""
STORES = ("energy_bending", "energy_torsion", "energy_kinetic", "energy_added_mass", "energy_contact")
FLOWS = ("work_ends", "work_loads", "dissipation")
MAY_LACK = ("Wr", "Lk", "min_gap", "parameter")
"""Not a number where it was not asked for, or does not exist."""
STATIC_LACKS = (*FLOWS, "energy_balance", "astray")


class Books:
    """What the frames of one run showed, and the verdict on it."""

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        self._length = float(scene.rod.length)
        s = np.linspace(0.0, self._length, 11)
        self._force = float(np.mean([stiffness(s) for stiffness in scene.rod.stiffness])) / self._length**2
        self._jolts = jolts(scene)
        self._turning = scene.topology and not (_swings(scene.start) or _swings(scene.end))
        self._before: Frame | None = None
        self._turnover, self._missing, self._made, self._lost = 0.0, 0.0, 0.0, 0.0
        self._defect = 0.0
        self.stretch, self.turns = 0.0, 0.0
        self.fault: tuple[Ending, str] | None = None

    @property
    def balance(self) -> float:
        """The worst energy balance over the turnover, with its sign."""
        floor = NOISE / BALANCE * self._force * self._length
        return (self._made if self._made > -self._lost else self._lost) / (self._turnover + floor)

    def enter(self, frame: Frame, hops: int = 0) -> None:
        """Judge the next frame; by then the run said that loops hopped over an end so many times."""
        wrong = self._not_finite(frame)
        if wrong:
            self._report(Ending.NOT_FINITE, f"{wrong} at t = {frame.t:g} s")
            return
        ds = self._length / (len(frame.r) - 1)
        bend: Array = ds * np.hypot(frame.kappa[:, 0], frame.kappa[:, 1])
        self._enter_length(frame, bend)
        self._enter_turns(frame, bend, hops)
        if self._scene.analysis == "static":
            self._enter_forces(frame)
        else:
            self._enter_energy(frame)
        self._before = frame

    def close(self) -> None:
        """Judge the whole."""
        if abs(self.balance) > BALANCE:
            ending = Ending.MADE_ENERGY if self.balance > 0 else Ending.LOST_ENERGY
            self._report(ending, f"{self.balance:.2g} of the turnover")

    def _report(self, ending: Ending, detail: str) -> None:
        if self.fault is None or (ending is Ending.NOT_FINITE and self.fault[0] is not ending):
            self.fault = ending, detail

    def _not_finite(self, frame: Frame) -> str:
        lacking = MAY_LACK + (STATIC_LACKS if self._scene.analysis == "static" else ())
        for field in fields(frame):
            value = getattr(frame, field.name)
            if isinstance(value, np.ndarray):
                good = bool(np.isfinite(value).all())
            else:
                good = isfinite(value) or (field.name in lacking and isnan(value))
            if not good:
                return field.name
        return ""

    def _enter_length(self, frame: Frame, bend: Array) -> None:
        chords = np.linalg.norm(np.diff(frame.r, axis=0), axis=1) * (len(frame.r) - 1) / self._length
        beyond = np.maximum(chords - 1.0, 1.0 - chords - np.maximum(bend[1:], bend[:-1]) ** 2 / 8)
        self.stretch = max(self.stretch, float(beyond.max()))
        if self.stretch > STRETCH:
            self._report(Ending.STRETCHED, f"by {self.stretch:.2g} at t = {frame.t:g} s")

    def _enter_turns(self, frame: Frame, bend: Array, hops: int) -> None:
        if not self._turning or isnan(frame.Lk) or _has_passed(frame):
            return
        defect = frame.Tw + frame.Wr - frame.Lk
        if self._before is None:
            self._defect = defect
        jumps = round((defect - self._defect) / 2.0)
        if self._scene.contact is None or abs(jumps) <= hops:  # without contact it may pass through itself
            defect -= 2.0 * jumps
        else:
            self._report(Ending.CROSSED, f"Tw + Wr - Lk jumped to {defect:.3g} by t = {frame.t:g} s")
        missed = abs(defect - self._defect)
        self.turns = max(self.turns, missed)
        ds = self._length / (len(frame.r) - 1)
        turning = np.abs(frame.kappa).sum(axis=1) * ds / (2 * pi)
        if missed > TURNS + float((bend**2 / 8 * turning).sum()):
            self._report(Ending.TURNS_LOST, f"|Tw + Wr - Lk| = {missed:.2g} at t = {frame.t:g} s")

    def _enter_energy(self, frame: Frame) -> None:
        if self._before is None:
            self._turnover = sum(abs(getattr(frame, name)) for name in STORES)
            return
        before = self._before
        names = (*STORES, "energy_potential", *FLOWS)
        self._turnover += sum(abs(getattr(frame, name) - getattr(before, name)) for name in names)
        change = frame.energy_balance - before.energy_balance
        jolted = any(before.t <= t <= frame.t for t in self._jolts)
        if change > 0.0 or not jolted:
            self._missing += change
        self._made, self._lost = max(self._made, self._missing), min(self._lost, self._missing)

    def _enter_forces(self, frame: Frame) -> None:
        """The whole rod in equilibrium: what its ends bear is what is put on it, if that is weight alone."""
        scene = self._scene
        if scene.distributed or scene.points or scene.fluid or scene.loads:
            return
        ds = self._length / (len(frame.r) - 1)
        F, Q = rotate(frame.orientation, frame.f), rotate(frame.orientation[[0, -1]], frame.q[[0, -1]])
        middles = np.asarray((np.arange(len(frame.r) - 1) + 0.5) * ds, dtype=np.float64)
        weights = (scene.rod.mass(middles) * ds)[:, None] * np.array(scene.gravity)
        places = 0.5 * (frame.r[1:] + frame.r[:-1])
        force = F[-1] - F[0] + weights.sum(axis=0)
        moment = Q[1] - Q[0] + np.cross(frame.r[-1], F[-1]) - np.cross(frame.r[0], F[0])
        moment += np.cross(places, weights).sum(axis=0)
        largest = max(float(np.abs(F).max()), float(np.abs(weights).sum()), float(np.abs(Q).max()) / self._length)
        span = self._length + float(np.abs(frame.r).max())
        worst = max(float(np.abs(force).max()), float(np.abs(moment).max()) / span)
        off = worst / (largest + NOISE / FORCE * self._force)
        if off > FORCE:
            self._report(Ending.OUT_OF_BALANCE, f"by {off:.2g} of the largest force at {frame.parameter:g} s")


def _has_passed(frame: Frame) -> bool:
    """Whether the end is behind the start, so that the rays that close the curve for Wr meet: it has no Wr then."""
    tangents = rotate(frame.orientation[[0, -1]], np.array([[0.0, 0.0, 1.0]] * 2))
    return bool((tangents @ (frame.r[-1] - frame.r[0]) < 0.0).all())


def jolts(scene: Scene) -> list[float]:
    """Times (s) at which an end's rate may jump, the start among them if the rod or an end moves then."""
    times = [0.0] if any((*scene.initial.velocity, *scene.initial.angular_velocity)) else []
    for end in (scene.start, scene.end):
        for component in (*end.translation, *end.rotation):
            for condition in component:
                times += [condition.since] if condition.since > 0.0 else []
                if condition.kind in ("rate", "position"):
                    times += [*condition.curve.corners]
                if condition.kind == "rate" and condition.curve.value(condition.since) != 0.0:
                    times.append(condition.since)
    return times


def _swings(end: End) -> bool:
    """Whether the end's tangent may change its direction."""
    return not all(_still(condition) for component in end.rotation[:2] for condition in component)


def _still(condition: Condition) -> bool:
    return condition.kind == "stop" or (condition.kind in ("rate", "position") and condition.curve.is_constant
                                        and (condition.kind == "position" or condition.curve.is_zero))  # fmt: skip
