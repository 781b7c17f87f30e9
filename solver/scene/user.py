"""A load that a user gives in Python."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Literal

import numpy as np

from solver.arrays import Array

RELATIVE_STEP = 1e-6
"""Of the largest place or velocity: the step of the differences that tangents are taken by."""


class UserLoad(ABC):
    """A force per length as a function of time, arclength, place and velocity: subclass it and give `force`.

    `account` says what becomes of its power: "given" (work of the loads), "lost" (dissipated), "stored" (it has a
    potential `energy`). `corners`: times (s) at which it may jump or bend, to which steps are aligned.
    """

    account: Literal["given", "lost", "stored"] = "given"
    corners: tuple[float, ...] = ()

    @abstractmethod
    def force(self, t: float, s: Array, r: Array, V: Array) -> Array:
        """Force (n, 3) in N/m, lab, at arclengths s (n,), places r and velocities V (n, 3), lab, at time t (s)."""

    def tangents(self, t: float, s: Array, r: Array, V: Array) -> tuple[Array, Array]:
        """Its derivatives (n, 3, 3) by place and by velocity, [point, component of force, component of r or V].

        By central differences, unless a subclass knows better. The force at a point is that point's own affair.
        """
        step_r = RELATIVE_STEP * max(float(np.ptp(r, axis=0).max()), 1e-9)
        step_V = RELATIVE_STEP * max(float(np.abs(V).max()), 1e-3)
        K, C = np.empty((len(s), 3, 3)), np.empty((len(s), 3, 3))
        for k in range(3):
            aside = np.zeros(3)
            aside[k] = step_r
            K[:, :, k] = (self.force(t, s, r + aside, V) - self.force(t, s, r - aside, V)) / (2.0 * step_r)
            aside[k] = step_V
            C[:, :, k] = (self.force(t, s, r, V + aside) - self.force(t, s, r, V - aside)) / (2.0 * step_V)
        return K, C

    def energy(self, t: float, s: Array, r: Array) -> Array:
        """Potential energy per length (n,) in J/m, of a load that is "stored": the same at all times."""
        raise NotImplementedError("a load whose power is stored must say its energy")
