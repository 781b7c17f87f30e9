"""How the ends of a rod are moved: what the estimate of a run's cost asks of that."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from solver import Scene
from solver.arrays import Array
from solver.physics.ends import ABOUT_A3, DrivenEnd
from solver.scene.ends import End

TIMES = 201
"""Times that are looked at."""
BACK = 0.01
"""Part of its largest speed that an end has on its way back, if it moves to and fro."""


@dataclass(frozen=True)
class Driven:
    """How both ends are moved. `turned`: the largest rotation (rad) of one about itself relative to the other, where
    both are prescribed; `spun`: that of any; `moved`: whether one changes its place or leans; `to_and_fro`: whether one
    comes back; `turns`: how often at the most; `acceleration`: the largest (m/s^2) of an end, or of the rod's length
    where it leans."""

    turned: float
    spun: float
    moved: bool
    to_and_fro: bool
    turns: int
    acceleration: float

    @classmethod
    def of(cls, scene: Scene) -> Driven:
        """As a scene has it."""
        times = np.linspace(0.0, scene.t_end, TIMES)
        start, end = (_prescribed(e, times) for e in (scene.start, scene.end))
        turned = np.nan_to_num(np.abs(end[:, ABOUT_A3] - start[:, ABOUT_A3]))
        spun = np.nan_to_num(np.abs([start[:, ABOUT_A3], end[:, ABOUT_A3]]))
        lengths = np.repeat([1.0, scene.rod.length], (3, 2))  # two rotations lean the rod
        places = np.hstack([np.nan_to_num(known[:, :ABOUT_A3]) * lengths for known in (start, end)])
        speeds = np.diff(places, axis=0) / times[1]
        fastest = np.abs(speeds).max(axis=0)
        there, back = ((sign * speeds > BACK * fastest).any(axis=0) for sign in (1.0, -1.0))
        sides = np.sign(np.where(np.abs(speeds) > BACK * fastest, speeds, 0.0))
        return cls(
            turned=float(turned.max()), spun=float(spun.max()), moved=bool(fastest.any()),
            to_and_fro=bool((there & back).any()), turns=max(map(_changes, sides.T)),
            acceleration=float(np.abs(np.diff(speeds, axis=0, prepend=0.0)).max() / times[1]),
        )  # fmt: skip


def _changes(sides: Array) -> int:
    """How often signs (n,) change, but for those that are 0."""
    return int(np.count_nonzero(np.diff(sides[sides != 0.0])))


def _prescribed(end: End, times: Array) -> Array:
    """Displacements (m) and rotations (rad) since t = 0 (times, 6); NaN for what is not prescribed all along."""
    driven = DrivenEnd(end)
    known = [[driven.prescribed(i, t) for i in range(6)] for t in times.tolist()]
    return np.array(known, dtype=np.float64)  # None becomes NaN
