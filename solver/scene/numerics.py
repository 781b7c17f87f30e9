"""How the equations are solved, as a scene gives it."""

from __future__ import annotations

from dataclasses import dataclass
from numbers import Integral
from typing import Literal

import numpy as np


@dataclass(frozen=True)
class Numerics:
    """How the equations are solved.

    `linear_solver` of the box method: a name in solver/methods/linear/registry.py; `intervals` of equal length along s;
    `dt_max` the largest step (s); `rho_inf` the spectral radius of generalized-alpha at infinite frequency in time,
    `rho_inf_space` the same along s (1 is the box scheme); `increment_tolerance` bounds each step's error relative to
    the step's motion (None: the method's own), or to `small_motion`, rotation (rad) and displacement (rod lengths), if
    that is more. With `strides` above 1 (staggered method) steps end at every so manieth frame only, may be so many
    dt_max long, and give the frames within them by their own polynomials.

    With a `tolerance` (staggered method) the scene runs on meshes that are twice as fine each, at most of
    `most_intervals`, until the estimated error of r, kappa, the energies and Tw and Wr is below it, or the work is done
    that may be: a target, not a condition. `verify`: the scene also runs with intervals and steps half as long. Either
    way the frames have the extrapolated solution and an estimate of its error.
    """

    method: Literal["box", "staggered"] = "box"
    linear_solver: str = "block_elimination"
    intervals: int = 200
    dt_max: float = 0.1
    rho_inf: float = 0.5
    rho_inf_space: float = 1.0
    increment_tolerance: float | None = None
    small_motion: float = 1e-7
    strides: int = 1
    tolerance: float | None = None
    most_intervals: int = 2000
    verify: bool = False

    def keeps(self, _view: object) -> bool:
        """How equations are solved has no direction."""
        return True

    def __post_init__(self) -> None:
        intervals: object = self.intervals  # whatever it was promised to be
        if isinstance(intervals, bool) or not isinstance(intervals, Integral) or int(intervals) < 2:
            raise ValueError(f"intervals must be a whole number >= 2, got {self.intervals}")
        if not (np.isfinite(self.dt_max) and self.dt_max > 0):
            raise ValueError(f"dt_max must be > 0 s, got {self.dt_max}")
        for name in ("rho_inf", "rho_inf_space"):
            if not 0 <= getattr(self, name) <= 1:
                raise ValueError(f"{name} must be in [0, 1], got {getattr(self, name)}")
        if self.linear_solver != Numerics.linear_solver and self.rho_inf_space != 1.0:
            raise ValueError(
                f"rho_inf_space must be 1 with linear_solver {self.linear_solver}, got {self.rho_inf_space}"
            )
        for name in ("increment_tolerance", "small_motion", "tolerance"):
            value = getattr(self, name)
            if value is not None and not value > 0:
                raise ValueError(f"{name} must be > 0, got {value}")
        if self.strides < 1 or (self.strides > 1 and self.method != "staggered"):
            raise ValueError(f"strides must be 1, or more with the method staggered, got {self.strides}")
        if self.tolerance is not None and self.method != "staggered":
            raise ValueError(f"method must be staggered with a tolerance, got {self.method}")
