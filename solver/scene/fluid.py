"""The fluid around the rod, as a scene gives it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from solver.scene.checks import require_finite
from solver.scene.view import View


@dataclass(frozen=True)
class Fluid:
    """Morison's fluid of density rho_w (kg/m^3), still or with a uniform lab current U (m/s).

    Relative velocity u = v - R^T U. Normal added mass `added_mass` rho_w A; normal drag
    0.5 rho_w D `drag_normal` |u_n| u_n; tangential 0.5 rho_w pi D `drag_tangential` |u_3| u_3.
    With gravity it also bears the rod up by rho_w A g.
    """

    density: float
    added_mass: float = 0.0
    drag_normal: float = 0.0
    drag_tangential: float = 0.0
    current: tuple[float, float, float] = (0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        for name in ("density", "added_mass", "drag_normal", "drag_tangential"):
            value = getattr(self, name)
            if not (np.isfinite(value) and value >= 0):
                raise ValueError(f"fluid {name} must be >= 0, got {value}")
        require_finite("fluid current", self.current)

    def keeps(self, view: View) -> bool:
        """Whether the current flows along the motion about an axis."""
        return view.moved_by(self.current)
