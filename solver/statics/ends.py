"""An end in statics: where it is held and what loads it, as functions of the schedule's time.

Equilibrium has no rates, so a condition must say where the end *is*. A rate holds it where its exact travel leads, the
integral of the rate. Axes of a material frame that swings would make that depend on the path: such ends are refused.
"""

from __future__ import annotations

import numpy as np

from solver.arrays import Array
from solver.physics.ends import travel
from solver.scene.ends import Condition, End


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
    if len(moving) > 1 and len(held) == 3:
        raise ValueError("rotation must be driven about one axis only in a static analysis")
    if end.frame == "lab" or all(c.kind == "load" for c in shift) or all(_is_still(c) for c in shift):
        return
    alike = all(_is_still(c) for c in shift[:2]) or all(c.kind == "load" for c in shift[:2])
    if not (_is_still(turn[0]) and _is_still(turn[1]) and (_is_still(turn[2]) or alike)):
        raise ValueError("translation that is held or moved must be along lab axes where the end turns, in a "
                         'static analysis: use frame "lab"')  # fmt: skip


def _is_still(condition: Condition) -> bool:
    if condition.kind == "rate":
        return condition.curve.is_zero
    return condition.kind == "position" and condition.curve.is_constant


class StaticEnd:
    """The six conditions of one end.

    `axes` (3, 3): columns along which the translation is held, lab; `held` (6,): which components are; the others are
    loaded, along the axes of the end's own frame if `follows`.
    """

    def __init__(self, end: End, R: Array) -> None:
        """`R` (3, 3): rotation of the end before anything is applied."""
        check_end(end)
        self._conditions = [component[0] for component in (*end.translation, *end.rotation)]
        self.follows = end.frame == "material"
        self.axes = R.copy() if self.follows else np.eye(3)
        self.held = np.array([c.kind != "load" for c in self._conditions])

    def corners(self) -> list[float]:
        """Times at which a schedule bends."""
        return [corner for condition in self._conditions for corner in condition.curve.corners]

    def values(self, t: float) -> Array:
        """(6,) at time t: displacement (m) or rotation (rad) where held, else internal force (N) or moment (N m)."""
        return np.array([travel(c, t) if c.kind != "load" else c.curve.value(t) for c in self._conditions])

    def spin(self, t: float) -> float | None:
        """The rotation (rad) about a3, if it is prescribed."""
        return float(self.values(t)[5]) if self.held[3:].all() else None
