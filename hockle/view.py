"""How a rod is looked at: gravity down, the longest to the right."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

LIES = 0.7
"""Cosine with e3 above which a rod without weight is drawn lying, as in the paper."""


@dataclass(frozen=True)
class View:
    """Where the lab axes point in a picture: the rows of `axes` (3, 3) are right, back and up, in the lab frame."""

    axes: Array
    directions: str

    @classmethod
    def of(cls, case: Mapping[str, Any], r: Array) -> Self:
        """Of a case and all positions (frames, n, 3) of its rod.

        Up is against gravity; without gravity it is e3, or -e1 where the rod lies along e3, as in the paper's figures.
        """
        gravity = np.array(case.get("loads", {}).get("gravity", (0, 0, 0)), float)
        weighs = bool(gravity.any())
        along = r[0, -1] - r[0, 0]
        lies = abs(along[2]) > LIES * np.linalg.norm(along)
        up = -gravity / np.linalg.norm(gravity) if weighs else np.array([-1.0, 0, 0] if lies else [0, 0, 1.0])
        level = np.eye(3) - np.outer(up, up)
        sizes = np.ptp(r.reshape(-1, 3), axis=0) * np.linalg.norm(level, axis=1)
        right = level[int(np.argmax(sizes - 1e-3 * sizes.max() * np.arange(3)))]
        right = right / np.linalg.norm(right)
        down = f"gravity {_name(-up)} down" if weighs else f"{_name(-up)} down"
        return cls(np.array([right, np.cross(up, right), up]), f"{_name(right)} to the right, {down}")


def _name(direction: Array) -> str:
    """The lab axis in a direction; where it is along none, its components."""
    largest = int(np.abs(direction).argmax())
    if abs(direction[largest]) > 1 - 1e-9:
        return ("-" if direction[largest] < 0 else "") + f"e{largest + 1}"
    return "({:.2g}, {:.2g}, {:.2g})".format(*direction)
