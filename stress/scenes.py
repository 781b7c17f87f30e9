"""The base scenes that the sweeps change: raw cases, short, with a coarse mesh."""

from __future__ import annotations

from copy import deepcopy
from math import pi
from typing import Any

from service.cases import apply_settings, load_case

Case = dict[str, Any]


def swing() -> Case:
    """A cantilever let go under gravity, in air: smooth, large, without contact."""
    return _rod_R() | {
        "ends": {"start": "clamp", "end": "free"}, "loads": {"gravity": [-9.81, 0.0, 0.0]},
        "numerics": {"intervals": 40, "dt_max": 0.01}, "t_end": 1.0, "output": {"interval": 0.05},
    }  # fmt: skip


def cable() -> Case:
    """goyal-2003 with a thick rod, so that all happens within 2 s: twisted in 1 s, it buckles and begins to loop."""
    raw = load_case("goyal-2003")
    return apply_settings(raw, {
        "rod.diameter": 0.01, "loads.distributed.0.force": [0.005, 0.0, 0.0],
        "ends.start.omega3": twist(-16.0), "ends.end": "slider",
        "contact.cutoff": 0.03, "contact.skip": 0.06, "contact.spacing": 0.0025, "contact.k1": 1e-6,
        "numerics.intervals": 40, "numerics.dt_max": 0.02, "t_end": 1.8, "output.interval": 0.06,
    })  # fmt: skip


def loop() -> Case:
    """short-loop: strands that are pressed onto each other, and held."""
    return apply_settings(load_case("short-loop"), {"numerics.intervals": 60, "t_end": 1.2, "output.interval": 0.04})


def bent() -> Case:
    """Statics: a clamped rod under its own weight, turned at its start."""
    return _rod_R() | {
        "analysis": "static", "ends": {"start": {"preset": "clamp", "theta1": _ramp(0.0, pi / 2)}, "end": "free"},
        "loads": {"gravity": [-9.81, 0.0, 0.0]}, "numerics": {"intervals": 40}, "t_end": 1.0,
        "output": {"interval": 0.1},
    }  # fmt: skip


def arch() -> Case:
    """Statics: a clamped arc, free of stress as it is, whose other end is pushed in and turned."""
    n, bend, radius = 40, 2.0, 0.5
    from math import cos, sin

    points = [[radius * (1 - cos(bend * i / n)), 0.0, radius * sin(bend * i / n)] for i in range(n + 1)]
    end = {"preset": "clamp", "frame": "lab", "x3": _ramp(0.0, -0.2), "theta3": _ramp(0.0, 2.0)}
    return _rod_R() | {
        "analysis": "static", "initial": {"shape": "centreline", "points": points, "a1": [1.0, 0.0, 0.0]},
        "ends": {"start": "clamp", "end": end}, "numerics": {"intervals": 40}, "t_end": 1.0,
        "output": {"interval": 0.1},
    }  # fmt: skip


def twist(rate: float, rise: float = 0.1, hold: float = 1.0) -> Case:
    """A schedule that goes to `rate` within `rise` s, stays until `hold` s and goes back to 0."""
    return {"t": [0.0, rise, hold, hold + rise], "value": [0.0, rate, rate, 0.0], "interpolation": "smoothstep"}


def _ramp(first: float, last: float) -> Case:
    return {"t": [0.0, 1.0], "value": [first, last], "interpolation": "linear"}


def _rod_R() -> Case:
    return deepcopy({
        "schema_version": 1,
        "rod": {"length": 1.0, "diameter": 0.01, "youngs_modulus": 1.25e7, "shear_modulus": 5e6, "density": 1500.0},
        "initial": {"shape": "straight", "direction": [0.0, 0.0, 1.0], "a1": [1.0, 0.0, 0.0]},
    })  # fmt: skip


SCENES = {"swing": swing, "cable": cable, "loop": loop, "bent": bent, "arch": arch}
