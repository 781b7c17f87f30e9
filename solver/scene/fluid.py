"""The fluid around the rod, as a scene gives it."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

import numpy as np

from solver.arrays import Array
from solver.scene.checks import require_finite, unit_vector
from solver.scene.curve import Curve
from solver.scene.view import View

UNIFORM = Curve.constant(1.0)


@dataclass(frozen=True)
class Shear:
    """The current at the lab place r is `factor`(n . r) times that of the fluid, n the unit vector along `normal`."""

    factor: Curve
    normal: tuple[float, float, float] = (0.0, 0.0, 1.0)

    def __post_init__(self) -> None:
        unit_vector("shear normal", self.normal)

    @property
    def up(self) -> Array:
        """n (3,)."""
        return unit_vector("shear normal", self.normal)


EVERYWHERE = Shear(UNIFORM)


@dataclass(frozen=True)
class Fluid:
    """Morison's fluid of density rho_w (kg/m^3), still or with a lab current U (m/s).

    Relative velocity u = v - R^T U. Normal added mass `added_mass` rho_w A; normal drag
    0.5 rho_w D `drag_normal` |u_n| u_n; tangential 0.5 rho_w pi D `drag_tangential` |u_3| u_3.
    A `viscosity` mu (Pa s) drags in proportion to u, as a fluid that creeps past (`creeping_drag`), and at a spin of
    the rod by pi mu D^2 omega_3. With gravity it also bears the rod up by rho_w A g. U is `current` times
    `schedule`(t), and times the factor of `shear`.
    """

    density: float
    added_mass: float = 0.0
    drag_normal: float = 0.0
    drag_tangential: float = 0.0
    current: tuple[float, float, float] = (0.0, 0.0, 0.0)
    shear: Shear | None = None
    schedule: Curve = UNIFORM
    viscosity: float = 0.0

    def __post_init__(self) -> None:
        for name in ("density", "added_mass", "drag_normal", "drag_tangential", "viscosity"):
            value = getattr(self, name)
            if not (np.isfinite(value) and value >= 0):
                raise ValueError(f"fluid {name} must be >= 0, got {value}")
        require_finite("fluid current", self.current)

    @property
    def varies(self) -> bool:
        """Whether the current depends on place or time."""
        return self.shear is not None or not self.schedule.is_constant or self.schedule.value(0.0) != 1.0

    @property
    def fastest(self) -> float:
        """The largest speed of the current (m/s), at the points of its tables."""
        curves = (self.schedule, (self.shear or EVERYWHERE).factor)
        factors = (np.abs(curve(np.array([0.0, *curve.corners]))).max() for curve in curves)
        return float(np.prod([*factors, np.linalg.norm(self.current)]))

    def creeping_drag(self, diameter: Array, length: float) -> Array:
        """Drag per length and velocity (n, 2), across and along, kg/(m s), of a slender rod past which it creeps.

        4 pi mu / (ln(L/D) + .84) and 2 pi mu / (ln(L/D) - .21): of a long cylinder that moves as a whole, Tirado &
        Garcia de la Torre, J. Chem. Phys. 71 (1979) 2581. A rod is taken to be no shorter than two diameters.
        """
        slenderness = np.log(np.maximum(length / diameter, 2.0))
        factors = 4.0 * pi / (slenderness + 0.84), 2.0 * pi / (slenderness - 0.21)
        return self.viscosity * np.stack(factors, axis=-1)

    def keeps(self, view: View) -> bool:
        """Whether the current is the same everywhere and always, and flows along the motion about an axis."""
        return not self.varies and view.moved_by(self.current)


NO_FLUID = Fluid(0.0)
"""What is around a rod in a vacuum."""
