"""What holds at the ends, as a scene gives it."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from itertools import pairwise
from math import inf
from typing import Literal

import numpy as np

from solver.scene.curve import Curve
from solver.scene.loads import Frame_
from solver.scene.view import NONE, View


@dataclass(frozen=True)
class Condition:
    """What holds at an end for one component, from time `since` on.

    `kind`:
      "rate"      velocity (m/s) or angular velocity (rad/s) is `curve`(t);
      "position"  displacement (m) along, or rotation (rad) about, the axis since `since` is `curve`(t) less
                  `curve`(since);
      "load"      force (N) or moment (N m) is `curve`(t), the internal f_i or q_i at that end;
      "stop"      the rate that the component has at `since` is brought to zero by a smoothstep
                  within `within` s (> 0), and held at zero.
    """

    kind: Literal["rate", "position", "load", "stop"]
    curve: Curve = field(default_factory=lambda: Curve.constant(0.0))
    since: float = 0.0
    within: float = 0.0

    def __post_init__(self) -> None:
        if self.kind == "stop" and not self.within > 0:
            raise ValueError(f"within must be > 0 s for a stop, got {self.within}")


Component = tuple[Condition, ...]
"""The conditions of one component in order of `since`; the first has since = 0."""

FIXED: Component = (Condition("rate"),)
FREE: Component = (Condition("load"),)


@dataclass(frozen=True)
class End:
    """Six conditions: translation along, and rotation about, three axes.

    `translation[i]` is on v_i or f_i, `rotation[i]` on omega_i or q_i. The components of the
    translation are along a1, a2, a3 (`frame` "material") or e1, e2, e3 ("lab"); those of the
    rotation are always material.

    `mass` (kg, >= 0) of a body at the end's place, a point: along components that are loaded, it pulls with
    m (g - dv/dt) besides. (Staggered method.)
    """

    translation: tuple[Component, Component, Component]
    rotation: tuple[Component, Component, Component]
    frame: Frame_ = "material"
    mass: float = 0.0

    def __post_init__(self) -> None:
        if not 0.0 <= self.mass < inf:
            raise ValueError(f"mass must be >= 0 kg, got {self.mass}")
        for name, components in (("translation", self.translation), ("rotation", self.rotation)):
            for i, component in enumerate(components):
                times = [c.since for c in component]
                if not times or times[0] != 0.0 or any(a >= b for a, b in pairwise(times)):
                    raise ValueError(f"{name}[{i}]: since must start at 0 and increase, got {times}")
                if component[0].kind == "stop":
                    raise ValueError(f"{name}[{i}]: a stop needs a condition before it")

    @classmethod
    def clamp(cls) -> End:
        """Held in position and in rotation."""
        return cls((FIXED, FIXED, FIXED), (FIXED, FIXED, FIXED))

    @classmethod
    def pin(cls) -> End:
        """Held in position, free to rotate."""
        return cls((FIXED, FIXED, FIXED), (FREE, FREE, FREE))

    @classmethod
    def slider(cls) -> End:
        """Held in rotation and across, free to slide along a3."""
        return cls((FIXED, FIXED, FREE), (FIXED, FIXED, FIXED))

    @classmethod
    def free(cls) -> End:
        """No force, no moment."""
        return cls((FREE, FREE, FREE), (FREE, FREE, FREE))

    def holds_tangent(self) -> bool:
        """Whether the tangent stays as it is at all times."""
        return _rest(self.rotation[:2])

    def holds_place(self) -> bool:
        """Whether it stays where it is at all times."""
        return _rest(self.translation)

    def keeps(self, view: View) -> bool:
        """Whether the end asks for no motion and no load but along the motion about an axis, at all times, and has no
        body, which is known in space alone."""
        if self.mass > 0.0:
            return False
        moves = view.moves
        if self.frame == "lab":
            along = np.abs(view.n) > 0.5
            if np.abs(np.abs(view.n) - along).max() > NONE:
                return False
            moves = along if view.index == 2 else ~along
        asked = [*zip(self.translation, moves, strict=True), *zip(self.rotation, view.turns, strict=True)]
        return all(allowed or all(map(_is_rest, component)) for component, allowed in asked)


def _rest(components: Iterable[Component]) -> bool:
    """Whether components are held as they are at all times."""
    return all(c.kind != "load" and _is_rest(c) for component in components for c in component)


def _is_rest(condition: Condition) -> bool:
    """Whether a condition asks for rest, or for no load, at all times."""
    kind, curve = condition.kind, condition.curve
    return kind == "stop" or (curve.is_constant if kind == "position" else curve.is_zero)
