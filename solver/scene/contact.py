"""Self-contact, as a scene gives it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

LAW = ("k1", "k2", "k3", "k4", "aperture", "cutoff")
"""The constants of eq. (6): all of them are given, or none."""
GEOMETRY = ("skip", "spacing")
"""What may be given without them."""


@dataclass(frozen=True)
class Contact:
    """Self-contact: `Contact()`, whose law follows from the rod and its ends, or eq. (6) with all its constants.

    `Contact()`: see physics/contact/recipe.py; `skip` and `spacing` (m) may be given. Else eq. (6),
    rho_c A (k1/(d - D/2)^k2 - (k3/d) d_t |d_t|^k4).

    Between points `spacing` (m) apart along the centreline, nearer than `cutoff` (m), more than
    `skip` (m) of arc apart, each within the other's aperture (full angle `aperture`, rad). `sum`
    "density": the force of a pair is weighted by spacing / 1 mm, so that it does not depend on the
    spacing; "grid_points": the sum as printed, which does.
    """

    k1: float | None = None
    k2: float | None = None
    k3: float | None = None
    k4: float | None = None
    aperture: float | None = None
    cutoff: float | None = None
    skip: float | None = None
    spacing: float | None = None
    sum: Literal["density", "grid_points"] = "density"

    def __post_init__(self) -> None:
        for name in (*LAW, *GEOMETRY):
            self._check_presence(name)
        for name in ("k1", "k2", "k3", "k4"):
            value = getattr(self, name)
            if value is not None and not (np.isfinite(value) and value >= 0):
                raise ValueError(f"contact {name} must be >= 0, got {value}")
        for name in ("cutoff", "skip", "spacing"):
            value = getattr(self, name)
            if value is not None and not (np.isfinite(value) and value > 0):
                raise ValueError(f"contact {name} must be > 0 m, got {value}")
        if self.aperture is not None and not 0 < self.aperture <= np.pi:
            raise ValueError(f"contact aperture must be in (0, pi] rad, got {self.aperture}")
        if self.automatic and self.sum != "density":
            raise ValueError(f"contact sum must be density without the constants of eq. (6), got {self.sum}")

    @property
    def automatic(self) -> bool:
        """Whether the law is to follow from the rod and its ends."""
        return all(getattr(self, name) is None for name in LAW)

    def _check_presence(self, name: str) -> None:
        """All constants of eq. (6) or none."""
        if getattr(self, name) is None and not self.automatic:
            value = next(f"{other} = {getattr(self, other)}" for other in LAW if getattr(self, other) is not None)
            raise ValueError(f"contact {name} must be given with the other constants of eq. (6), or none: got {value}")
