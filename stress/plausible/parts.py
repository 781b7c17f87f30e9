"""What the scenes of the bank are put together from: materials, rods, motions in time, whole cases."""

from __future__ import annotations

from math import pi, sqrt
from typing import Any

import numpy as np
from numpy.random import Generator

Part = dict[str, Any]

MATERIALS = {
    "steel": (2.0e11, 7850.0), "aluminium": (7.0e10, 2700.0), "carbon": (8.0e10, 1600.0),
    "glass fibre": (3.5e10, 1900.0), "nylon": (2.0e9, 1150.0), "polypropylene": (1.3e9, 910.0),
    "rubber": (5.0e6, 1100.0), "silicone": (2.0e6, 1070.0),
}  # fmt: skip
"""Young's modulus (Pa) and density (kg/m^3)."""
GRAVITY = [0.0, 0.0, -9.81]


class Drawn:
    """A rod of one material that was drawn, and what scenes are scaled by: `L` (m), `D` (m), `EJ` (N m^2), `mass`
    (kg/m), and the `period` (s) of its first bending mode as a cantilever."""

    def __init__(self, rng: Generator, materials: tuple[str, ...], L: tuple[float, float],
                 slender: tuple[float, float]) -> None:  # fmt: skip
        self.L, self.D = log(rng, *L), 0.0
        self.D = self.L * log(rng, *slender)
        self.E, self.density = MATERIALS[str(rng.choice(materials))]
        self.EJ = self.E * pi * self.D**4 / 64.0
        self.mass = self.density * pi * self.D**2 / 4.0
        self.period = 2.0 * pi * self.L**2 / 1.8751**2 * sqrt(self.mass / self.EJ)

    @property
    def rod(self) -> Part:
        """As a case has it."""
        return {"length": self.L, "diameter": self.D, "youngs_modulus": self.E, "shear_modulus": self.E / 2.6,
                "density": self.density}  # fmt: skip


def log(rng: Generator, low: float, high: float) -> float:
    """A number between two others, with equal chances for equal ratios; of three digits, as people write them."""
    return float(f"{np.exp(rng.uniform(np.log(low), np.log(high))):.3g}")


def case(kind: str, rod: Part, initial: Part, ends: tuple[Any, Any], t_end: float, frames: int = 40,
         **more: Any) -> Part:  # fmt: skip
    """A case that says nothing of how it is to be solved."""
    return {"schema_version": 1, "name": kind.replace(" ", "-"), "rod": rod, "initial": initial,
            "ends": {"start": ends[0], "end": ends[1]}, "t_end": t_end, "output": {"interval": t_end / frames},
            **more}  # fmt: skip


def straight(*direction: float) -> Part:
    """A straight rod."""
    return {"shape": "straight", "direction": list(direction)}


def curve(points: Any, **more: Any) -> Part:
    """A rod along a curve through points (n, 3)."""
    return {"shape": "centreline", "points": np.asarray(points).tolist(), **more}


def ramp(start: float, end: float, value: float) -> Part:
    """From nothing to a value, smoothly, between two times."""
    times, values = ([0.0, start, end], [0.0, 0.0, value]) if start > 0.0 else ([0.0, end], [0.0, value])
    return {"t": times, "value": values, "interpolation": "smoothstep"}


def harmonic(amplitude: float, period: float, t_end: float) -> Part:
    """A sine in time that begins gently, as a table."""
    t = np.linspace(0.0, t_end, max(int(24 * t_end / period), 24) + 1)
    grown = 1.0 - np.exp(-((t / period) ** 2))
    return {"t": t.tolist(), "value": (amplitude * grown * np.sin(2.0 * pi * t / period)).tolist(),
            "interpolation": "cubic"}  # fmt: skip


def water(rng: Generator, current: float = 0.0) -> Part:
    """Sea water, with a current (m/s)."""
    return {"density": 1025.0, "added_mass": 1.0, "drag_normal": log(rng, 0.9, 1.6), "drag_tangential": 0.01,
            "current": [current, 0.0, 0.0]}  # fmt: skip


def arc(L: float, angle: float, nodes: int = 101) -> Any:
    """Points (nodes, 3) of a circular arc in the e1-e3 plane that turns by `angle` (rad)."""
    a = np.linspace(0.0, angle, nodes)
    return L / angle * np.stack([1.0 - np.cos(a), 0.0 * a, np.sin(a)], axis=1)


def helix(radius: float, pitch: float, turns: float) -> tuple[Any, float]:
    """Points (n, 3) of a helix about e3, and its length (m)."""
    a, rise = np.linspace(0.0, 2.0 * pi * turns, int(80 * turns) + 1), pitch / (2.0 * pi)
    points = np.stack([radius * np.cos(a), radius * np.sin(a), rise * a], axis=1)
    return points, float(np.hypot(radius, rise) * a[-1])
