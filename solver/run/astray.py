"""What is left of the energy that went nowhere: it was in waves that the steps damp, and what damps all motion would
have damped these as well.

As long as nothing does, all of it may still be in waves that nobody follows. A thick fluid is another matter: what a
start from rest stirred up is gone long before a fibre has sunk by its own thickness.
"""

from __future__ import annotations

from math import exp, expm1, pi

import numpy as np

from solver.scene.fluid import NO_FLUID
from solver.scene.scene import Scene


class Fading:
    """How fast the waves of a scene fade at least, whatever it is that moves in them."""

    def __init__(self, scene: Scene) -> None:
        """The scene's damping c takes the part c of a wave's energy in a second, as it takes 2 c of that of motion; a
        viscous fluid takes by its drag, along the rod or across, where it also moves (a spin is damped faster)."""
        fluid, length = scene.fluid or NO_FLUID, float(scene.rod.length)
        s = np.linspace(0.0, length, 101)
        diameter, mass = scene.rod.diameter(s) + 0.0 * s, scene.rod.mass(s) + 0.0 * s
        moved = np.stack([mass + fluid.added_mass * fluid.density * pi / 4.0 * diameter**2, mass], axis=-1)
        self._rate = scene.damping + float((fluid.creeping_drag(diameter, length) / moved).min())

    def left(self, before: float, gone: float, span: float, dt: float) -> float:
        """Energy (J) that may be in waves which steps of `dt` (s) damp: `span` (s) ago there was `before` in them, and
        `gone` (J) went into them since, evenly. No faster than within a step: there they do not swing any more, and
        those that the steps follow creep as slowly as they do."""
        fades = span * min(self._rate, 1.0 / dt) if dt > 0.0 else 0.0
        return before * exp(-fades) + gone * (-expm1(-fades) / fades if fades > 0.0 else 1.0)
