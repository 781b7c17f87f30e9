"""An end in statics: where it is held and what loads it, as functions of the schedule's time, and its equations.

Equilibrium has no rates, so a condition must say where the end *is*. A rate holds it where its exact travel leads, the
integral of the rate. A place that is given along axes which swing would depend on the path: such ends are refused.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from solver.arrays import Array
from solver.kernels.rotation import relative_rotation, rotate, rotation_of
from solver.physics.ends import travel
from solver.scene.ends import Condition, End
from solver.scene.layout import nodes_at_rest
from solver.scene.scene import Scene
from solver.statics.point import FORCE, PSI, X
from solver.statics.tangent import crossing
from solver.statics.turning import Turning

ALONG = 1e-6
"""Cosine below which a direction that is held counts as across another one."""
CLOSED = 1e-3
"""Part of the rod's length below which its ends meet."""


class Units(NamedTuple):
    """By which all is made dimensionless: EJ/L (N m), EJ/L^2 (N), L (m)."""

    moment: float
    force: float
    length: float


def check_end(end: End) -> None:
    """Raise ValueError if the conditions do not say where the end is: see the rules in the messages."""
    components = (*end.translation, *end.rotation)
    if any(len(component) > 1 for component in components):
        raise ValueError("switches must not be given with a static analysis, which may go back in time")
    shift, turn = (tuple(component[0] for component in group) for group in (end.translation, end.rotation))
    held = [c for c in turn if c.kind != "load"]
    moving = [c for c in held if not _is_still(c)]
    if len(held) not in (0, 3) and (len(held) == 1 or moving):
        raise ValueError("rotation must be free about all axes, held about all, or held still about two, in a "
                         "static analysis")  # fmt: skip
    if end.frame == "lab" or all(c.kind == "load" for c in shift) or all(_is_still(c) for c in shift):
        return
    alike = all(_is_still(c) for c in shift[:2]) or all(c.kind == "load" for c in shift[:2])
    if not (_is_still(turn[0]) and _is_still(turn[1]) and (_is_still(turn[2]) or alike)):
        raise ValueError("translation that is held or moved must be along lab axes where the end turns, in a "
                         'static analysis: use frame "lab"')  # fmt: skip


def check_place(scene: Scene) -> None:
    """Raise ValueError if the rod may go as a whole where it likes: no end holds it along some direction.

    What else there is, solids or a user's load, may hold it instead.
    """
    if scene.loads:
        return
    r, orientation, _ = nodes_at_rest(scene.initial, np.linspace(0.0, scene.rod.length, 2))
    held = np.zeros((6, 3))
    for i, end in enumerate((scene.start, scene.end)):
        axes = np.eye(3) if end.frame == "lab" else rotate(np.tile(orientation[-i], (3, 1)), np.eye(3))
        held[3 * i : 3 * i + 3] = [
            axis if component[0].kind != "load" else 0.0 * axis
            for axis, component in zip(axes, end.translation, strict=True)
        ]
    _, sizes, directions = np.linalg.svd(held)
    if sizes[-1] < ALONG:
        loose = ", ".join(f"{x:.3g}" for x in directions[-1] + 0.0)
        closed = np.linalg.norm(r[1] - r[0]) < CLOSED * scene.rod.length
        remedy = "clamp both of them, as this is a ring" if closed else "clamp or pin one of them"
        raise ValueError(f"ends must hold the rod's place in a static analysis, and neither holds it along ({loose}): "
                         f"{remedy}")  # fmt: skip


def _is_still(condition: Condition) -> bool:
    if condition.kind == "rate":
        return condition.curve.is_zero
    return condition.kind == "position" and condition.curve.is_constant


class StaticEnd:
    """The six conditions of one end, and their rows of the equations.

    `axes` (3, 3): columns along which the translation is held, lab; `held` (6,): which components are; the others are
    loaded, along the axes of the end's own frame if `follows`. Of what was asked for last: `follower` (N), the force,
    and `moment` (N m), all (3,), that turn with the end's frame; `pin` (3,), where its place is held, m.
    """

    def __init__(self, end: End, side: int, quaternion: Array, place: Array, until: float, units: Units,
                 compliance: float) -> None:  # fmt: skip
        """`quaternion` (4,), `place` (3,): of the end before anything is applied. `until` (s): the schedules' end.
        `compliance` (m/N): of what holds it, see `physics.axial`."""
        check_end(end)
        self._conditions = [component[0] for component in (*end.translation, *end.rotation)]
        self._sign = 2.0 * side - 1.0
        self._home, self._units, self._give = place, units, self._sign * compliance
        self._turning = Turning(quaternion, self._conditions[3:], until)
        self.follows = end.frame == "material"
        self.axes = rotation_of(quaternion) if self.follows else np.eye(3)
        self._given = [i for i, c in enumerate(self._conditions) if not c.curve.is_zero]
        self.held = np.array([c.kind != "load" for c in self._conditions])
        self._turns_held = int(self.held[3:].sum())
        self.follower, self.moment, self.pin = np.zeros(3), np.zeros(3), place

    @property
    def stays(self) -> bool:
        """Whether it stays where, and as, it is held."""
        return all(_is_still(c) for c in self._conditions if c.kind != "load")

    def corners(self) -> list[float]:
        """Times at which a schedule bends."""
        return [corner for condition in self._conditions for corner in condition.curve.corners]

    def values(self, t: float) -> Array:
        """(6,) at time t: displacement (m) or rotation (rad) where held, else internal force (N) or moment (N m)."""
        values = np.zeros(6)
        for i in self._given:
            c = self._conditions[i]
            values[i] = travel(c, t) if c.kind != "load" else c.curve.value(t)
        return values

    def spin(self, t: float) -> float | None:
        """The rotation (rad) about a3, if it is prescribed."""
        return float(self.values(t)[5]) if self.held[3:].all() else None

    def left(self, t: float, quaternion: Array, R: Array, place: Array, F: Array, moment: Array, dead: Array,
             follower: Array) -> tuple[Array, Array]:  # fmt: skip
        """Its rows at time t, N m and N (3,): what is not balanced, or by how much it is away from where it is held.

        The end lies at `place` with the rotation R, and in it are the force `F`, lab, and the `moment`, material;
        `dead` and `follower` (6,): the point loads on it along lab and material axes.
        """
        values, units = self.values(t), self._units
        loaded = np.where(self.held, 0.0, values)
        self.moment = loaded[3:] + follower[3:]
        self.follower = follower[:3] + (loaded[:3] if self.follows else 0.0)
        force = dead[:3] + R @ self.follower + (0.0 if self.follows else loaded[:3])
        across = self.axes.T @ (self._sign * (F - force)) / units.force
        if self._give:
            place = place + self._give * np.outer(R[:, 2], R[:, 2]) @ F
        self.pin = self._home + self.axes @ np.where(self.held[:3], values[:3], 0.0)
        away = self.axes.T @ (place - self.pin) / units.length
        unbalanced = self._sign * (moment - R.T @ dead[3:] - follower[3:] - loaded[3:]) / units.moment
        turned = self._turned(t, quaternion)
        return (np.where(self.held[3:], turned, unbalanced) * units.moment,
                np.where(self.held[:3], away, across) * units.force)  # fmt: skip

    def _turned(self, t: float, quaternion: Array) -> Array:
        """By how much its frame is turned away from where it is held at time t (3,)."""
        if self._turns_held == 0:
            return np.zeros(3)
        there, away = self._turning.at(t), np.empty(3)
        if self._turns_held == 3:
            relative_rotation(there, quaternion, away)
            return away
        free = np.eye(3)[int(np.argmin(self.held[3:]))]
        return np.cross(rotation_of(quaternion).T @ rotation_of(there) @ free, free)

    def bind(self, D: Array, lower: Array, upper: Array, R: Array, F: Array) -> None:
        """Make its rows of the tangent those of `left`, in the blocks (9, 9) of its frame in a chain that nothing
        holds. `R`, `F`: as there."""
        turns, place = self.held[3:], self.held[:3]
        if self.follower.any():
            D[X, PSI] = self._sign * R @ crossing(self.follower)
        for block in (D, lower, upper):
            block[X] = self.axes.T @ block[X]
            block[PSI][turns] = 0.0
            block[X][place] = 0.0
        rows = self.axes.T[place] * self._units.force / self._units.length
        D[PSI, PSI][turns] = np.eye(3)[turns] * self._units.moment
        D[X, X][place] = rows
        if self._give:
            tangent, by_force = R[:, 2], upper if self._sign < 0.0 else D
            by_force[X, FORCE][place] = rows @ (self._give * np.outer(tangent, tangent))
            turned = np.column_stack([-R[:, 1], R[:, 0], np.zeros(3)])  # the tangent, by a rotation of the frame
            changed = turned * (tangent @ F) + np.outer(tangent, F @ turned)
            D[X, PSI][place] = rows @ (self._give * changed)
