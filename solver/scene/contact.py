"""Self-contact, as a scene gives it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np


@dataclass(frozen=True)
class Contact:
    """Self-contact after eq. (6): rho_c A (k1/(d - D/2)^k2 - (k3/d) d_t |d_t|^k4).

    Between points `spacing` (m) apart along the centreline, nearer than `cutoff` (m), more than
    `skip` (m) of arc apart, each within the other's aperture (full angle `aperture`, rad). `sum`
    "density": the force of a pair is weighted by spacing / 1 mm, so that it does not depend on the
    spacing; "grid_points": the sum as printed, which does.
    """

    k1: float
    k2: float
    k3: float
    k4: float
    aperture: float
    cutoff: float
    skip: float
    spacing: float
    sum: Literal["density", "grid_points"] = "density"

    def __post_init__(self) -> None:
        for name in ("k1", "k2", "k3", "k4"):
            value = getattr(self, name)
            if not (np.isfinite(value) and value >= 0):
                raise ValueError(f"contact {name} must be >= 0, got {value}")
        for name in ("cutoff", "skip", "spacing"):
            value = getattr(self, name)
            if not (np.isfinite(value) and value > 0):
                raise ValueError(f"contact {name} must be > 0 m, got {value}")
        if not 0 < self.aperture <= np.pi:
            raise ValueError(f"contact aperture must be in (0, pi] rad, got {self.aperture}")
