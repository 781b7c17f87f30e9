"""The paper's scene: Goyal, Perkins & Lee 2003 as fitted in data/goyal2003.json, where its values and tolerances are.

At N = 400 and dt <= 0.0125 s every value of the reference; at the shipped settings the milestones to 0.1 s and
Wr(32 s) to 0.05; and to 60 s without failure and without a jump of Tw + Wr - Lk.
"""

from __future__ import annotations

import json
from functools import cache
from math import nan
from pathlib import Path
from typing import Any

import numpy as np

from service.cases.build import build_scene
from service.cases.library import apply_settings, load_case, parse_case
from solver import Frame, RunFailed, simulate
from solver.kernels.rotation import rotate
from validation.row import Row, against, at_most, relative

REFERENCE: dict[str, Any] = json.loads((Path(__file__).parent / "data" / "goyal2003.json").read_text())
FINE = {"numerics.intervals": 400, "numerics.dt_max": 0.0125, "t_end": 34.0, "output.interval": 0.05}
LARGEST_DIAMETER = 4.95e-4
"""m; first contact is d - D/2 = 6 mm, and a frame's min_gap is d - D."""


@cache
def run(**settings: float) -> tuple[Frame, ...]:
    """Frames of the shipped case with some settings changed (dots written as __); those it got to, if it failed."""
    changed = {key.replace("__", "."): value for key, value in settings.items()}
    simulation = simulate(build_scene(parse_case(apply_settings(load_case("goyal-2003"), changed))))
    frames = []
    try:
        frames.extend(simulation)
    except RunFailed as failure:
        print(f"goyal-2003 {changed}: {failure}")
    return tuple(frames)


def series(frames: tuple[Frame, ...], name: str) -> np.ndarray:
    """One number of each frame."""
    return np.array([getattr(frame, name) for frame in frames], dtype=float)


def crossing(t: np.ndarray, y: np.ndarray, after: float = 0.0) -> float:
    """When y first turns positive after a time, by a straight line between frames; NaN if it does not."""
    for i in range(1, len(t)):
        if t[i] > after and y[i - 1] <= 0.0 < y[i]:
            return float(t[i - 1] - y[i - 1] * (t[i] - t[i - 1]) / (y[i] - y[i - 1]))
    return nan


def summit(t: np.ndarray, y: np.ndarray) -> float:
    """When y is largest, by a parabola through the largest value and its neighbours."""
    i = int(np.argmax(y[1:-1])) + 1
    a, b, c = y[i - 1 : i + 2]
    return float(t[i] + 0.5 * (t[i + 1] - t[i]) * (a - c) / (a - 2 * b + c))


def milestones(frames: tuple[Frame, ...]) -> dict[str, float]:
    """When the scene's events happen (s), named and defined as in the reference."""
    t = series(frames, "t")
    bending, torsion = series(frames, "energy_bending"), series(frames, "energy_torsion")
    middle = len(frames[0].r) // 2
    tangent = [rotate(f.orientation[middle : middle + 1], np.array([[0.0, 0.0, 1.0]]))[0, 2] for f in frames]
    gap = np.nan_to_num(series(frames, "min_gap"), nan=1.0)
    return {
        "buckling_s": crossing(t, bending - 0.02 * (bending + torsion), after=10.0),
        "torsional_energy_maximum_s": summit(t, torsion),
        "midspan_tangent_perpendicular_s": crossing(t, -np.array(tangent)),
        "writhe_one_s": crossing(t, series(frames, "Wr") - 1.0),
        "first_contact_s": crossing(t, 0.006 - (gap + 0.5 * LARGEST_DIAMETER)),
    }


def at(frames: tuple[Frame, ...], t: float) -> Frame:
    """The frame nearest to a time."""
    return min(frames, key=lambda frame: abs(frame.t - t))


def mismatch(frames: tuple[Frame, ...], until: float) -> float:
    """The largest |Tw + Wr - Lk|."""
    return max(abs(f.Tw + f.Wr - f.Lk) for f in frames if f.t <= until + 1e-9)


def _tolerance(quantity: str, t: int) -> float:
    table = REFERENCE["values"]["tolerances"]
    if quantity in ("Wr", "Tw"):
        return float(table["Wr to 25 s" if t <= 25 else {29: "Wr 29 s", 32: "Wr 32 s"}.get(t, "Wr after")])
    return float(table["z_at_sL_m"])


def _values(frames: tuple[Frame, ...]) -> list[Row]:
    values, table = REFERENCE["values"], []
    for quantity in ("Wr", "Tw", "z_at_sL_m"):
        for t, value in values[quantity].items():
            frame = at(frames, float(t))
            measured = frame.r[-1, 2] if quantity == "z_at_sL_m" else getattr(frame, quantity)
            table.append(against(f"goyal {quantity} at {t} s", float(measured), value, _tolerance(quantity, int(t))))
    for t, aim in (("25", "midspan_position_m at 25 s"), ("32", "at 32 s")):
        frame, tolerance = at(frames, float(t)), values["tolerances"][aim]
        for axis, value in enumerate(values["midspan_position_m"][t]):
            position = float(frame.r[len(frame.r) // 2, axis])
            table.append(against(f"goyal mid-span e{axis + 1} at {t} s", position, value, tolerance))
    for t, value in values["Lk"].items():
        table.append(against(f"goyal Lk at {t} s", at(frames, float(t)).Lk, value, 1e-4))
    for quantity in ("bending", "torsion", "kinetic"):
        key = "energy_kinetic_rod_J" if quantity == "kinetic" else f"energy_{quantity}_J"
        for t, value in values[key].items():
            measured = getattr(at(frames, float(t)), f"energy_{quantity}")
            table.append(relative(f"goyal {quantity} energy at {t} s", measured, value, 3e-3))
    return table


def fine_rows() -> list[Row]:
    """Every value of the reference at N = 400, dt <= 0.0125 s."""
    frames = run(**{key.replace(".", "__"): value for key, value in FINE.items()})
    table, events = [], milestones(frames)
    for name, event in REFERENCE["milestones"].items():
        table.append(against(f"goyal {name}", events[name], event["value"], event["tol"]))
    largest = float(series(frames, "energy_torsion").max())
    table.append(relative("goyal largest torsional energy", largest, 5.7523e-6, 3e-3))
    return [*table, *_values(frames), at_most("goyal |Tw+Wr-Lk| to 32 s", mismatch(frames, 32.0), 3e-4)]


def shipped_rows() -> list[Row]:
    """The shipped settings, run to 60 s: milestones to 0.1 s, Wr(32 s) to 0.05, no failure, no jump."""
    frames = run(t_end=60.0)
    events = milestones(frames)
    table = [
        against(f"goyal shipped settings, {name}", events[name], event["value"], 0.1)
        for name, event in REFERENCE["milestones"].items()
    ]
    Wr = REFERENCE["values"]["Wr"]["32"]
    table.append(against("goyal shipped settings, Wr at 32 s", at(frames, 32.0).Wr, Wr, 0.05))
    table.append(against("goyal shipped settings, last time reached", frames[-1].t, 60.0, 1e-9))
    twist = series(frames, "Tw") + series(frames, "Wr") - series(frames, "Lk")
    jump = float(np.abs(np.diff(twist)).max())
    table.append(at_most("goyal to 60 s, largest change of Tw+Wr-Lk in 0.1 s (a crossing is 2)", jump, 0.5))
    return table


def rows() -> list[Row]:
    """All of it."""
    return fine_rows() + shipped_rows()
