"""The paper's scene with a cable of 10 mm: stiff, fast, and wound tight.

The diameter's profile, the seed force (which goes with the weight), cutoff, skip and spacing of contact are scaled; its
constants k1 to k4 are as they were. 1.74 turns by 12 s, then .15 turns a second; the far end is held from 30 s on. The
rod throws its loop at 15.8 s, within a fraction of a second.
"""

from __future__ import annotations

from math import pi
from typing import Any

from service.cases.build import build_scene
from service.cases.library import apply_settings, load_case, parse_case
from solver import Run, RunFailed, simulate
from validation.goyal import LARGEST_DIAMETER
from validation.row import Row, at_most

DIAMETER = 0.01
TURNS, BY, THEN = 1.74, 12.0, 0.15
"""Turns by a time (s), and turns a second after it."""
NUMERICS = {"numerics.method": "staggered", "numerics.intervals": 200, "numerics.dt_max": 0.1,
            "numerics.increment_tolerance": 0.1, "t_end": 36.0}  # fmt: skip
CONTACT = {"contact.cutoff": 0.025, "contact.skip": 0.035, "contact.spacing": 0.0025}
LAST = 0.5
"""s; the corners of the schedule are rounded over so long."""


def case(**settings: Any) -> dict[str, Any]:
    """The case, with some settings changed (dots written as __)."""
    case = load_case("goyal-2003")
    scale = DIAMETER / LARGEST_DIAMETER
    profile, seed = case["rod"]["diameter"], case["loads"]["distributed"][0]["force"][0]
    profile["value"] = [scale * d for d in profile["value"]]
    seed["value"] = [scale**2 * f for f in seed["value"]]
    rate = -2.0 * pi * TURNS / (BY - 0.5 * LAST)
    case["ends"]["start"]["omega3"] = {
        "t": [0.0, LAST, BY, BY + LAST], "value": [0.0, rate, rate, -2.0 * pi * THEN], "interpolation": "smoothstep",
    }  # fmt: skip
    changed = {key.replace("__", "."): value for key, value in settings.items()}
    return apply_settings(case, NUMERICS | CONTACT | changed)


def run() -> tuple[Run, float, float]:
    """The run as far as it got, the largest |Tw + Wr - Lk|, and the speed energy (J) of the last frame."""
    simulation = simulate(build_scene(parse_case(case())))
    worst, moving = 0.0, 0.0
    try:
        for frame in simulation:
            worst, moving = max(worst, abs(frame.Tw + frame.Wr - frame.Lk)), frame.energy_kinetic
    except RunFailed as failure:
        print(f"thick cable: {failure}")
    return simulation, worst, moving


def rows() -> list[Row]:
    """Whether it gets to the end, at what cost, and whether it settles."""
    simulation, worst, moving = run()
    statistics, name = simulation.statistics, "thick cable (D = 10 mm) to 36 s, N = 200"
    return [
        at_most(f"{name}, what is left of 36 s", 36.0 - simulation.t, 1e-9),
        at_most(f"{name}, CPU s", statistics.cpu_time, 10.0),
        at_most(f"{name}, failed steps", statistics.failed_steps, 4),
        at_most(f"{name}, |Tw+Wr-Lk|", worst, 1e-6),
        at_most(f"{name}, kinetic energy in the end, J", moving, 1e-4),
    ]
