"""Energy that went astray: the balance of a run does not say where to.

The steps damp waves that are shorter than they are, and from then on nobody knows what these had. All of it may still
be in waves, as long as nothing else would have damped them. A thick fluid is another matter: what a start from rest
stirred up is gone there long before a fibre has sunk by its own thickness.
"""

from __future__ import annotations

from math import exp, expm1, pi

import numpy as np

from solver.scene.scene import Scene

FADED = 3.0
"""Powers of e by which waves fade in the time after which the books are looked at again: more often costs more."""


class Astray:
    """The energy that went astray and may still be in waves: less of it the longer ago, where all motion is damped."""

    def __init__(self, scene: Scene) -> None:
        """The scene's damping c takes the part c of a wave's energy in a second, as it takes 2 c of that of motion; a
        viscous fluid takes by its drag, along the rod or across, where it also moves (a spin is damped faster)."""
        self.energy, self.most = 0.0, 0.0
        """What is left of it (J), with its sign: below 0 where energy was lost. And the most that may be left, where
        some was made after more was lost, or the other way round."""
        self._rate = scene.damping
        if scene.fluid is None or scene.fluid.viscosity == 0.0:
            return
        fluid, length = scene.fluid, float(scene.rod.length)
        s = np.linspace(0.0, length, 101)
        diameter, mass = scene.rod.diameter(s) + 0.0 * s, scene.rod.mass(s) + 0.0 * s
        moved = np.stack([mass + fluid.added_mass * fluid.density * pi / 4.0 * diameter**2, mass], axis=-1)
        self._rate += float((fluid.creeping_drag(diameter, length) / moved).min())

    def is_due(self, span: float) -> bool:
        """Whether waves fade so much within `span` (s) that it matters when in that time energy went astray."""
        return self._rate * span > FADED

    def enter(self, change: float, span: float, dt: float) -> None:
        """Enter by how much (J) the balance has changed in the last `span` (s), evenly, by steps of `dt` (s)."""
        self.energy = self._left(self.energy, change, span, dt)
        self.most = max(abs(self.energy), self._left(self.most, 0.0, span, dt))

    def _left(self, before: float, gone: float, span: float, dt: float) -> float:
        """What is left of two energies, one of `before` and one that went astray since. Nothing fades within less than
        a step: waves as long as the steps do not swing any more then, and creep as slowly as these are."""
        fades = span * min(self._rate, 1.0 / dt) if dt > 0.0 else 0.0
        return before * exp(-fades) + gone * (-expm1(-fades) / fades if fades > 0.0 else 1.0)
